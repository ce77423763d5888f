// Starts the nodes for a person: thimble-visual gets a window, whatever [visual] display says.
#pragma once

#include <memory>
#include <utility>

#include "session/launch/node_starter.hpp"

namespace thimble {

class PersonStarter final : public NodeStarter {
  public:
    explicit PersonStarter(std::shared_ptr<NodeStarter> starter) : starter_(std::move(starter)) {}

    std::unique_ptr<RunningNode> start(const NodeOrder& order) const override {
        NodeOrder mine = order;
        if (order.role == Role::kVisual) mine.arguments.emplace_back("--window");
        return starter_->start(mine);
    }
    Duration reach() const override { return starter_->reach(); }
    std::string machine(Role role) const override { return starter_->machine(role); }

  private:
    std::shared_ptr<NodeStarter> starter_;
};

}  // namespace thimble
