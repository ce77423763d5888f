// Nodes as children of this program.
#pragma once

#include "session/launch/node_starter.hpp"

namespace thimble {

class LocalStarter final : public NodeStarter {
  public:
    // `programs`: folder of the thimble-* programs. `config`: session file for the nodes; empty: defaults.
    LocalStarter(std::filesystem::path programs, std::filesystem::path config)
        : programs_(std::move(programs)), config_(std::move(config)) {}

    std::unique_ptr<RunningNode> start(const NodeOrder& order) const override;
    Duration reach() const override { return Duration::zero(); }
    std::string machine(Role /*role*/) const override { return ""; }

  private:
    std::filesystem::path programs_, config_;
};

}  // namespace thimble
