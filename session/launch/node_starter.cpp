#include "session/launch/node_starter.hpp"

#include <csignal>
#include <unistd.h>

#include <fmt/format.h>

#include "common/process/child.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {

std::optional<int> wait_for_end(RunningNode& node, Duration limit) {
    const SessionTime deadline = wall_now() + limit;
    while (!node.poll() && wall_now() < deadline) wall_sleep(std::chrono::milliseconds{5});
    return node.poll();
}

namespace {

class LocalNode final : public RunningNode {
  public:
    LocalNode(std::string program, Child child) : program_(std::move(program)), child_(std::move(child)) {}

    std::optional<int> poll() override { return child_.poll(); }
    bool started() const override { return true; }
    void stop() override { child_.signal(SIGTERM); }
    std::string exit_message() override {
        return fmt::format("{} ended with code {}: {}", program_, child_.poll().value_or(-1),
                           child_.last_lines());
    }
    ExitCode verdict() const override { return ExitCode::kNetwork; }

  private:
    std::string program_;
    Child child_;
};

}  // namespace

std::shared_ptr<RunningNode> LocalStarter::start(const NodeOrder& order) const {
    std::filesystem::remove(order.log);
    std::filesystem::remove(order.report);
    std::vector<std::string> arguments = order.arguments;
    if (!order.messages.empty()) {
        std::filesystem::remove(order.messages);
        arguments.insert(arguments.end(), {"--log", order.messages.string()});
    }
    arguments.insert(arguments.end(),
                     {"--report", order.report.string(), fmt::format("--die-with-parent={}", ::getpid())});
    if (!config_.empty()) arguments.push_back(config_.string());
    return std::make_unique<LocalNode>(order.program, Child(programs_ / order.program, arguments, order.log));
}

}  // namespace thimble
