#include "experiment/lane.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>

#include <fmt/format.h>

#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr Duration kPoll = std::chrono::milliseconds{20};    // look after children, stop requests
constexpr Duration kFlush = std::chrono::milliseconds{200};  // trajectory to disk
constexpr Duration kProgress = std::chrono::milliseconds{500};

struct NodeKind {
    Role role;
    const char* program;
    Port session_end, node_end;
};

// In the order of kNodeRoles.
constexpr std::array kNodes{
    NodeKind{Role::kNetem, "thimble-netem", Port::kSessionNetem, Port::kNetemControl},
    NodeKind{Role::kSlaveSim, "thimble-slave-sim", Port::kSessionSlave, Port::kSlaveControl},
    NodeKind{Role::kCutaneous, "thimble-cutaneous", Port::kSessionCutaneous, Port::kCutaneousControl},
    NodeKind{Role::kVisual, "thimble-visual", Port::kSessionVisual, Port::kVisualControl},
    NodeKind{Role::kMaster, "thimble-master", Port::kSessionMaster, Port::kMasterControl}};

}  // namespace

Lane::Lane(const LanePlan& plan, const LaneEvents& events)
    : plan_(plan),
      events_(events),
      sockets_(plan.network),
      session_(system_entropy(), plan.session, open_channels()),
      loop_(sockets_.descriptors()) {
    session_.set_sample_hook([this](const TrajectorySample& sample) {
        last_ = sample;
        if (writer_) writer_->append(sample);
    });
    session_.set_clock_hook([this](Role node, const ClockExchange& exchange) {
        if (clock_writer_) clock_writer_->append(node, exchange);
    });
}

void Lane::open() {
    std::filesystem::create_directories(plan_.out);
    clock_writer_.emplace(clock_path());
    if (!plan_.attach) launch();
    wait_for_nodes();
}

SessionProcess::Channels Lane::open_channels() {
    SessionProcess::Channels channels{};
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
        channels.control[i] = sockets_.between(kNodes[i].session_end, kNodes[i].node_end);
    }
    channels.record = sockets_.inlet(Port::kSessionRecord, Role::kSlaveSim);
    return channels;
}

std::filesystem::path Lane::report_path(std::size_t node) const {
    return plan_.out / fmt::format("{}_{:g}ms.json", kNodes[node].program, 1000 * plan_.delay_s);
}

std::filesystem::path Lane::clock_path() const {
    return plan_.out / fmt::format("clocks_{:g}ms.csv", 1000 * plan_.delay_s);
}

// The file is the record; the summary is made from it.
void Lane::close_clocks() {
    if (!clock_writer_) return;
    clock_writer_->flush();
    clock_writer_.reset();
    result_.clocks = clocks_of(plan_.delay_s, read_clock_file(clock_path()));
}

void Lane::launch() {
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
        const NodeKind& node = kNodes[i];
        const auto log = plan_.out / fmt::format("{}_{:g}ms.log", node.program, 1000 * plan_.delay_s);
        std::filesystem::remove(log);
        std::filesystem::remove(report_path(i));
        std::vector<std::string> arguments{"--base-port", std::to_string(plan_.network.base_port), "--report",
                                           report_path(i).string(), "--die-with-parent"};
        if (!plan_.config.empty()) arguments.insert(arguments.end(), {"--config", plan_.config.string()});
        if (plan_.strict_rt) arguments.emplace_back("--strict-rt");
        if (node.role == Role::kNetem) {
            arguments.insert(arguments.end(), {"--force-delay-s", fmt::format("{}", plan_.delay_s)});
        }
        children_.emplace_back(plan_.programs / node.program, arguments, log);
    }
}

// The index of a child that has ended.
std::optional<std::size_t> Lane::dead_child() {
    for (std::size_t i = 0; i < children_.size(); ++i) {
        if (children_[i].poll()) return i;
    }
    return std::nullopt;
}

std::string Lane::obituary(std::size_t i) {
    return fmt::format("{} ended with code {}: {}", kNodes[i].program, children_[i].poll().value_or(-1),
                       children_[i].last_words());
}

void Lane::wait_for_nodes() {
    const SessionTime deadline = wall_now() + plan_.session.peer_wait;
    for (SessionTime now = wall_now(); !session_.missing_peers(now, kPeerTimeout).empty(); now = wall_now()) {
        loop_.step(session_, now + kPoll);
        if (const auto dead = dead_child()) throw Error(ExitCode::kNetwork, obituary(*dead));
        if (now < deadline) continue;
        throw Error(
            ExitCode::kNetwork,
            fmt::format("no answer from {} within {} s on ports from {}: see the logs in {}",
                        session_.missing_peers(now, kPeerTimeout), to_seconds(plan_.session.peer_wait),
                        plan_.network.base_port, plan_.out.string()));
    }
}

const TrialRecord& Lane::run_trial(const TrialConditions& trial, std::uint32_t number,
                                   const std::filesystem::path& trajectory) {
    std::filesystem::create_directories(trajectory.parent_path());
    writer_.emplace(trajectory, plan_.if_exists);
    session_.start(trial, number);
    SessionTime next_poll{}, next_flush{}, next_progress{};
    while (!session_.finished()) {
        const SessionTime now = wall_now();
        loop_.step(session_, now + kPoll);
        if (now >= next_poll) look_around(now + kPoll, next_poll);
        if (now >= next_flush) {
            writer_->flush();
            if (clock_writer_) clock_writer_->flush();
            next_flush = now + kFlush;
        }
        if (now >= next_progress && events_.progress) {
            events_.progress(trial, last_);
            next_progress = now + kProgress;
        }
    }
    close_trial();
    return session_.record();
}

void Lane::look_around(SessionTime next, SessionTime& next_poll) {
    next_poll = next;
    if (events_.stop && events_.stop()) session_.abort(EndReason::kInterrupted);
    if (const auto dead = dead_child()) session_.abort(EndReason::kPeerLost, kNodes[*dead].role);
}

void Lane::close_trial() {
    const TrialRecord& record = session_.record();
    writer_->end(record.reason, record.lost_peer);
    writer_.reset();
    if (record.reason == EndReason::kInterrupted) {
        result_.code = ExitCode::kRunFailed;
        result_.problem = "interrupted; what was recorded is kept";
    } else if (record.reason == EndReason::kPeerLost) {
        result_.code = ExitCode::kNetwork;
        const auto dead = dead_child();
        result_.problem =
            dead ? obituary(*dead) : fmt::format("lost contact with {}", to_string(record.lost_peer));
    }
    if (events_.trial_done) events_.trial_done(record);
}

void Lane::idle(Duration limit) {
    const SessionTime end = wall_now() + limit;
    for (SessionTime now = wall_now(); now < end; now = wall_now())
        loop_.step(session_, std::min(end, now + kPoll));
}

LaneResult Lane::close() {
    close_clocks();
    if (plan_.attach) return std::move(result_);
    session_.shut_down(wall_now());
    for (std::size_t i = 0; i < children_.size(); ++i) {
        if (!children_[i].wait(std::chrono::seconds{1})) children_[i].signal(SIGTERM);
        const auto code = children_[i].wait(std::chrono::seconds{1});
        if (code == static_cast<int>(ExitCode::kRealtime) && result_.code == ExitCode::kOk) {
            result_.code = ExitCode::kRealtime;
            result_.problem = obituary(i);
        }
        std::ifstream file(report_path(i));
        auto report = nlohmann::ordered_json::parse(file, nullptr, false);
        if (!report.is_discarded()) result_.reports.push_back(std::move(report));
    }
    return std::move(result_);
}

LaneResult run_lane(const LanePlan& plan, const LaneEvents& events) {
    Lane lane(plan, events);
    lane.open();
    for (const TrialConditions& trial : plan.trials) {
        const auto name = fmt::format("trial{:02}_{}_{:g}ms.csv", trial.trial, to_string(trial.modality),
                                      1000 * trial.delay_s);
        lane.run_trial(trial, trial.trial, plan.out.parent_path() / "trajectories" / name);
        if (lane.result().code != ExitCode::kOk) break;
    }
    return lane.close();
}

}  // namespace thimble
