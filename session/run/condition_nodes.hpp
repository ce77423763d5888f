// The node programs of a condition's run: started, waited for, started anew, ended.
#pragma once

#include <algorithm>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <boost/core/noncopyable.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/standard_streams.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/run/condition_files.hpp"
#include "session/run/condition_plan.hpp"

namespace thimble {

class ConditionNodes : boost::noncopyable {
  public:
    // One turn of the loop that keeps the connection to the nodes. Throws Error to give up.
    using Turn = std::function<void()>;

    // Both outlive the nodes.
    ConditionNodes(const ConditionPlan& plan, ConditionFiles& files) : plan_(plan), files_(files) {}
    ~ConditionNodes() { end_all(); }

    // Throws Error: run failed, if a machine has no such program.
    void launch() {
        for (std::size_t i = 0; i < kNodes.size(); ++i) nodes_.push_back(start(i));
    }
    // In lock-step: each has the conductor at its standard input, or, where that is -1, this key for it.
    void launch(std::span<const int, kNodes.size()> inputs, const std::string& grant_key) {
        lock_step_ = true;
        grant_key_ = grant_key;
        for (std::size_t i = 0; i < kNodes.size(); ++i) nodes_.push_back(start(i, inputs[i]));
    }

    // Starts the ended programs anew. False: none has ended, or the user started the programs.
    bool restart_dead() {
        if (!plan_.starter || !dead()) return false;
        files_.nodes_start_anew();
        lines_passed_on_ = 0;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (nodes_[i]->poll()) nodes_[i] = start(i);
        }
        return true;
    }

    // The index of a node that has ended. Asks each of them, which also keeps their connections alive.
    std::optional<std::size_t> dead() {
        std::optional<std::size_t> dead;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (nodes_[i]->poll() && !dead) dead = i;
        }
        return dead;
    }

    // Throws Error (as its program ended), with its words, if a node has ended.
    void throw_if_dead() {
        if (const auto i = dead()) throw Error(nodes_[*i]->verdict(), nodes_[*i]->exit_message());
    }

    std::string exit_message(std::size_t node) const { return nodes_[node]->exit_message(); }
    ExitCode verdict(std::size_t node) const { return nodes_[node]->verdict(); }
    // As dead(), but first gives a silent node time to report its reason. The session says nothing meanwhile.
    std::optional<std::size_t> dead_soon(Duration limit) {
        const SessionTime end = wall_now() + limit;
        while (!nodes_.empty() && !dead() && wall_now() < end) wall_sleep(std::chrono::milliseconds{5});
        return dead();
    }
    // The last output of a node that is about to end.
    std::string last_output(std::size_t node) const {
        return wait_for_end(*nodes_[node], kFarewell) ? exit_message(node) : std::string();
    }
    // For a node that is silent and has not ended, as far as is known here.
    std::string advice_on_silence() const {
        if (plan_.starter)
            return "it hangs, its machine is too busy, or its data are lost on the way: see its log in " +
                   plan_.out.string();
        return "this run did not start the program (--attach), so look on its machine: has it ended, does it "
               "hang, "
               "is the network down ('thimble link-test')? Start it again, then repeat the run";
    }
    void stop(std::size_t node) { nodes_[node]->stop(); }
    const RunningNode& at(std::size_t node) const { return *nodes_[node]; }
    // Until each program runs. Throws Error (network) with the machine that does not answer.
    void wait_for_machines(const Turn& turn) {
        const auto late = [this] {
            return std::find_if(nodes_.begin(), nodes_.end(),
                                [](const auto& node) { return !node->started(); });
        };
        const SessionTime deadline = wall_now() + (plan_.starter ? plan_.starter->reach() : Duration{});
        while (late() != nodes_.end()) {
            throw_if_dead();
            if (late() == nodes_.end()) return;
            const NodeKind& node = kNodes[static_cast<std::size_t>(late() - nodes_.begin())];
            if (wall_now() > deadline) {
                throw Error(ExitCode::kNetwork,
                            "'{}', where {} should run, does not answer within {} s: see the logs in {}",
                            plan_.starter->machine(node.role), node.program,
                            to_seconds(plan_.starter->reach()), plan_.out.string());
            }
            turn();
        }
    }

    // Repeats what the master's program has said since the last call.
    void pass_on_messages() {
        std::ifstream file(files_.log_path(kNodes.size() - 1));
        std::size_t lines = 0;
        for (std::string line; std::getline(file, line);) {
            if (++lines <= lines_passed_on_ || lines > kMostPassedOn) continue;
            write_stderr(printable(line.substr(0, kLongestPassedOn)) + "\n");
        }
        lines_passed_on_ = std::max(lines_passed_on_, lines);
    }

    // Called after the session has ordered the end: collects reports and exit codes.
    void end(ConditionResult& result) {
        for (const auto& node : nodes_) {
            if (!wait_for_end(*node, kFarewell)) node->stop();
            const auto code = wait_for_end(*node, kPluginLimitAtEnd + kFarewell);
            const bool late = code == static_cast<int>(ExitCode::kRealtime);
            if ((late || code == kPluginHung) && result.code == ExitCode::kOk) {
                result.code = late ? ExitCode::kRealtime : node->verdict();
                result.problem = node->exit_message();
            }
        }
        end_all();
        for (std::size_t i = 0; i < kNodes.size(); ++i) {
            std::ifstream file(files_.report_path(i));
            auto report = nlohmann::ordered_json::parse(file, nullptr, false);
            if (!report.is_discarded()) result.reports.push_back(std::move(report));
        }
    }

  private:
    static constexpr Duration kFarewell = std::chrono::seconds{1};  // to end when told to, and again
    // A person reads these. The log has the rest.
    static constexpr std::size_t kMostPassedOn = 200, kLongestPassedOn = 1000;  // lines, bytes of a line

    // All at once: the log of a machine may be on its way for minutes.
    void end_all() {
        for (const auto& node : nodes_) node->stop();
        const auto missing = [](const auto& node) { return !node->output_complete(); };
        while (std::count_if(nodes_.begin(), nodes_.end(), missing) > 0)  // asks each of them
            wall_sleep(std::chrono::milliseconds{1});
        nodes_.clear();
    }

    std::shared_ptr<RunningNode> start(std::size_t i, int input = -1) {
        const NodeKind& node = kNodes[i];
        NodeOrder order;
        order.role = node.role;
        order.program = node.program;
        order.log = files_.log_path(i);
        order.report = files_.report_path(i);
        order.arguments = {"--base-port", std::to_string(plan_.network.base_port)};
        // On another machine with a folder for logs its log stays there: it may be too long for the way.
        const bool here = plan_.starter->machine(node.role).empty();
        const bool comes = here || plan_.log.folder.empty();
        if (plan_.log.messages != LoggedMessages::kNone && comes)
            order.messages = files_.messages_path(node.program);
        order.input = input;
        if (!here) order.grant_key = grant_key_;
        if (lock_step_) order.arguments.emplace_back("--lock-step");
        if (plan_.strict_rt) order.arguments.emplace_back("--strict-rt");
        if (node.role == Role::kNetem) {
            order.arguments.insert(order.arguments.end(),
                                   {"--force-delay-s", fmt::format("{}s", plan_.delay_s)});
        }
        return plan_.starter->start(order);
    }

    const ConditionPlan& plan_;
    ConditionFiles& files_;
    std::vector<std::shared_ptr<RunningNode>> nodes_;
    std::size_t lines_passed_on_ = 0;
    bool lock_step_ = false;
    std::string grant_key_;
};

}  // namespace thimble
