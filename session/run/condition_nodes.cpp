// The programs of a condition: started, waited for, started anew, ended.
#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "common/runtime/standard_streams.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/run/condition_run.hpp"

namespace thimble {
namespace {

constexpr Duration kFarewell = std::chrono::seconds{1};           // to end when told to, and again
constexpr Duration kWordsAfter = std::chrono::milliseconds{500};  // of a node that waits for its user

}  // namespace

void ConditionRun::launch() {
    for (std::size_t i = 0; i < kNodes.size(); ++i) nodes_.push_back(start_node(i));
}

std::unique_ptr<RunningNode> ConditionRun::start_node(std::size_t i) {
    const NodeKind& node = kNodes[i];
    NodeOrder order;
    order.role = node.role;
    order.program = node.program;
    order.log = log_path(i);
    order.report = report_path(i);
    order.arguments = {"--base-port", std::to_string(plan_.network.base_port)};
    // On another machine with a folder for logs its log stays there: it may be too long for the way.
    if (log_ && (plan_.log.folder.empty() || plan_.starter->machine(node.role).empty()))
        order.messages = messages_path(node.program);
    if (plan_.strict_rt) order.arguments.emplace_back("--strict-rt");
    if (node.role == Role::kNetem) {
        order.arguments.insert(order.arguments.end(), {"--force-delay-s", fmt::format("{}", plan_.delay_s)});
    }
    return plan_.starter->start(order);
}

// What was asked of a trial that is over, by its number, moves nobody: the new instance begins at none.
bool ConditionRun::revive() {
    if (!plan_.starter || !dead_node()) return false;
    ++revivals_;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i]->poll()) nodes_[i] = start_node(i);
    }
    result_ = {};
    halted_ = false;
    wait_for_machines();
    // The dead ones were heard a moment ago, and their places count as occupied until they have been silent for a second: only
    // then are the new ones heard, and all have answered who are not missing.
    const SessionTime forgotten = wall_now() + 2 * kPeerTimeout;
    for (SessionTime now = wall_now(); now < forgotten && session_.missing_peers(now, kPeerTimeout).empty();
         now = wall_now()) {
        loop_.step(company_, now + kPoll);
        hear_stop_key();
        keep_stop();
    }
    wait_for_nodes();
    return true;
}

// The index of a node that has ended. Asks every one of them: that is how they learn that we are here.
std::optional<std::size_t> ConditionRun::dead_node() {
    std::optional<std::size_t> dead;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i]->poll() && !dead) dead = i;
    }
    return dead;
}

void ConditionRun::throw_if_dead() {
    const auto dead = dead_node();
    if (dead) throw Error(nodes_[*dead]->verdict(), nodes_[*dead]->exit_message());
}

void ConditionRun::wait_for_machines() {
    const auto late = [this] {
        return std::find_if(nodes_.begin(), nodes_.end(), [](const auto& node) { return !node->started(); });
    };
    const SessionTime deadline = wall_now() + (plan_.starter ? plan_.starter->reach() : Duration{});
    while (late() != nodes_.end()) {
        throw_if_dead();
        if (late() == nodes_.end()) return;
        if (events_.stop && events_.stop())
            throw Error(ExitCode::kRunFailed, "interrupted before the first trial");
        const NodeKind& node = kNodes[static_cast<std::size_t>(late() - nodes_.begin())];
        if (wall_now() > deadline) {
            throw Error(
                ExitCode::kNetwork,
                fmt::format("'{}' does not answer, where {} is to run, within {} s: see the logs in {}",
                            plan_.starter->machine(node.role), node.program,
                            to_seconds(plan_.starter->reach()), plan_.out.string()));
        }
        loop_.step(company_, wall_now() + kPoll);
        hear_stop_key();
        keep_stop();
    }
}

// Somebody has to do something to the handle first: its node says what, in a log that nobody looks at now.
void ConditionRun::pass_on_words(std::size_t& passed) const {
    std::ifstream file(log_path(kNodes.size() - 1));
    std::size_t lines = 0;
    for (std::string line; std::getline(file, line);)
        if (++lines > passed) say_words(line + "\n");
    passed = std::max(passed, lines);
}

void ConditionRun::wait_for_nodes() {
    const SessionTime begin = wall_now();
    const Duration limit = plan_.session.peer_wait + plan_.session.user_limit;
    SessionTime next_words = begin + kWordsAfter;
    std::size_t passed = 0;
    for (SessionTime now = begin; !session_.missing_peers(now, kPeerTimeout).empty(); now = wall_now()) {
        loop_.step(company_, now + kPoll);
        hear_stop_key();
        keep_stop();
        throw_if_dead();
        if (events_.stop && events_.stop())
            throw Error(ExitCode::kRunFailed, "interrupted before the first trial");
        if (plan_.session.user_limit > Duration::zero() && now > next_words) {
            next_words = now + kWordsAfter;
            pass_on_words(passed);
        }
        if (now < begin + limit) continue;
        throw Error(ExitCode::kNetwork,
                    fmt::format("no answer from {} within {} s on ports from {}{}: see the logs in {}",
                                session_.missing_peers(now, kPeerTimeout), to_seconds(limit),
                                plan_.network.base_port, why_silent(), plan_.out.string()));
    }
}

// Whoever is heard with another lab key is not silent.
std::string ConditionRun::why_silent() const {
    const std::string complaint = sockets_.security() == nullptr ? "" : sockets_.security()->complaint();
    return complaint.empty() ? complaint : " (" + complaint + ")";
}

void ConditionRun::end_nodes() {
    session_.shut_down(wall_now());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (!wait_for_end(*nodes_[i], kFarewell)) nodes_[i]->stop();
        const auto code = wait_for_end(*nodes_[i], kFarewell);
        if (code == static_cast<int>(ExitCode::kRealtime) && result_.code == ExitCode::kOk) {
            result_.code = ExitCode::kRealtime;
            result_.problem = nodes_[i]->exit_message();
        }
    }
    nodes_.clear();
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
        std::ifstream file(report_path(i));
        auto report = nlohmann::ordered_json::parse(file, nullptr, false);
        if (!report.is_discarded()) result_.reports.push_back(std::move(report));
    }
}

}  // namespace thimble
