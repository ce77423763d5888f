// How a node's program is started and ended: on this machine or on another (remote_starter.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>
#include <vector>

#include <boost/core/noncopyable.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/messages.hpp"
#include "common/process/child.hpp"
#include "common/runtime/plugin_watch.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "common/time.hpp"
#include "session/launch/node_kinds.hpp"

namespace thimble {

struct NodeOrder {
    Role role{};
    std::string program;                 // "thimble-master"
    std::vector<std::string> arguments;  // but for session file and --report, which depend on the place
    std::filesystem::path log, report;   // here, wherever it runs
    std::filesystem::path messages{};    // its log of messages, here at its end; empty: none
    int input = -1;                      // what it reads at standard input, if it runs here; -1: nothing
    std::string grant_key{};             // in lock-step, if it runs elsewhere (grant_stream.hpp)
};

// Ended, at the latest, when this object goes.
class RunningNode : boost::noncopyable {
  public:
    virtual ~RunningNode() = default;

    // The exit code after its end, 128 + n for signal n. Call it often: this also keeps the connection to a remote
    // node alive.
    virtual std::optional<int> poll() = 0;
    // Whether its program has been started; false while its machine is still being reached.
    virtual bool started() const = 0;
    // Asks the node to end. It does so within a few seconds, even if it hangs; poll() gives the result.
    virtual void stop() = 0;
    // After stop(): true if all its output has arrived, or the time for it is over. Call it again and again; it does
    // not wait.
    virtual bool output_complete() { return true; }
    virtual const std::string& program() const = 0;  // for messages
    virtual pid_t pid() const { return -1; }         // of a program on this machine
    // Text about its end, after it has ended; and the exit code of the whole run.
    virtual std::string exit_message() = 0;
    virtual ExitCode verdict() = 0;
};

// The exit code of a run whose node has ended by itself. A plug-in that hangs is no network error.
inline ExitCode verdict_on(std::optional<int> code) {
    return code == kPluginHung ? ExitCode::kRunFailed : ExitCode::kNetwork;
}

class NodeStarter {
  public:
    virtual ~NodeStarter() = default;
    // Conditions side by side share a starter. Throws Error (run failed) if there is nothing to start.
    virtual std::shared_ptr<RunningNode> start(const NodeOrder& order) const = 0;
    // How long the slowest machine may take to be reached.
    virtual Duration reach() const = 0;
    // The machine of a node; empty: this one.
    virtual std::string machine(Role role) const = 0;
};

inline bool runs_elsewhere(const NodeStarter& starter) {
    return std::any_of(kNodes.begin(), kNodes.end(),
                       [&](const NodeKind& node) { return !starter.machine(node.role).empty(); });
}

// Waits, at most `limit`, for it to end.
inline std::optional<int> wait_for_end(RunningNode& node, Duration limit) {
    const SessionTime deadline = wall_now() + limit;
    while (!node.poll() && wall_now() < deadline) wall_sleep(std::chrono::milliseconds{5});
    return node.poll();
}

class LocalNode final : public RunningNode {
  public:
    LocalNode(std::string program, Child child) : program_(std::move(program)), child_(std::move(child)) {}

    std::optional<int> poll() override { return child_.poll(); }
    bool started() const override { return true; }
    void stop() override { child_.signal(SIGTERM); }
    const std::string& program() const override { return program_; }
    pid_t pid() const override { return child_.pid(); }
    std::string exit_message() override {
        return fmt::format("{} ended with code {}: {}", program_, child_.poll().value_or(-1),
                           child_.last_lines());
    }
    ExitCode verdict() override { return verdict_on(child_.poll()); }

  private:
    std::string program_;
    Child child_;
};

class LocalStarter final : public NodeStarter {
  public:
    // `programs`: folder of the thimble-* programs. `config`: session file for the nodes; empty: defaults. `own`: by
    // Role, absolute, as in LaunchSettings.
    LocalStarter(std::filesystem::path programs, std::filesystem::path config,
                 std::array<std::filesystem::path, kRoleCount> own = {})
        : programs_(std::move(programs)), config_(std::move(config)), own_(std::move(own)) {}

    std::shared_ptr<RunningNode> start(const NodeOrder& order) const override {
        remove_file(order.log);
        remove_file(order.report);
        std::vector<std::string> arguments = order.arguments;
        if (!order.messages.empty()) {
            remove_file(order.messages);
            arguments.insert(arguments.end(), {"--log", order.messages.string()});
        }
        arguments.insert(arguments.end(), {"--report", order.report.string(),
                                           fmt::format("--die-with-parent={}", ::getpid())});
        if (!config_.empty()) arguments.push_back(config_.string());
        const std::filesystem::path& own = own_[static_cast<std::size_t>(order.role)];
        const std::filesystem::path program = own.empty() ? programs_ / order.program : own;
        const ChildPlace place = own.empty() ? ChildPlace{} : ChildPlace{{}, kOwnRemedy};
        return std::make_unique<LocalNode>(program.filename().string(),
                                           Child(program, arguments, order.log, {order.input}, place));
    }

    Duration reach() const override { return Duration::zero(); }
    std::string machine(Role /*role*/) const override { return ""; }

  private:
    static constexpr const char* kOwnRemedy =
        "does its first line name a program that runs it, as '#!/usr/bin/env python3' does?";
    std::filesystem::path programs_, config_;
    std::array<std::filesystem::path, kRoleCount> own_;
};

}  // namespace thimble
