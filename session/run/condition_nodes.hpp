// The node programs of a condition's run: started, waited for, started anew, ended.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "session/run/condition_files.hpp"
#include "session/run/condition_plan.hpp"

namespace thimble {

class ConditionNodes : boost::noncopyable {
  public:
    // One turn of the loop that keeps in touch with the nodes. Throws Error to give up.
    using Turn = std::function<void()>;

    // Both outlive the nodes.
    ConditionNodes(const ConditionPlan& plan, ConditionFiles& files) : plan_(plan), files_(files) {}
    ~ConditionNodes();  // ends the nodes, all at once

    // Throws Error: run failed, if a machine has no such program.
    void launch();
    // Starts the ended programs anew. False: none has ended, or the user started the programs.
    bool restart_dead();
    // The index of a node that has ended. Asks every one of them: that is how they learn that we are here.
    std::optional<std::size_t> dead();
    // Throws Error (as its program ended), with its words, if a node has ended.
    void throw_if_dead();
    std::string exit_message(std::size_t node) const { return nodes_[node]->exit_message(); }
    // Until each program runs. Throws Error (network) with the machine that does not answer.
    void wait_for_machines(const Turn& turn);
    // Repeats what the master's program has said since the last call.
    void pass_on_messages();
    // After the session has told them to end: their reports, and an exit code that matters.
    void end(ConditionResult& result);

  private:
    std::shared_ptr<RunningNode> start(std::size_t node);

    const ConditionPlan& plan_;
    ConditionFiles& files_;
    std::vector<std::shared_ptr<RunningNode>> nodes_;
    std::size_t lines_passed_on_ = 0;
};

}  // namespace thimble
