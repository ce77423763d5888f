#include "experiment/lane.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "common/runtime/wall_clock.hpp"
#include "experiment/event_file.hpp"
#include "experiment/launch/node_kinds.hpp"
#include "experiment/trial_table.hpp"

namespace thimble {
namespace {

constexpr Duration kPoll = std::chrono::milliseconds{20};    // look after children, stop requests
constexpr Duration kFlush = std::chrono::milliseconds{200};  // trajectory to disk
constexpr Duration kFarewell = std::chrono::seconds{1};      // to end when told to, and again
constexpr Duration kProgress = std::chrono::milliseconds{500};

// The loop hears what is open when it is made.
const std::vector<Listener*>& listening(Sockets& sockets, SessionProcess& session) {
    session.join_stop_line(*sockets.inlet_for_all(Port::kSessionStop), sockets.stop_outlets());
    return sockets.listeners();
}

}  // namespace

Lane::Company::Company(SessionProcess& session, std::unique_ptr<Process> attendant)
    : session_(&session), attendant_(std::move(attendant)) {}

void Lane::Company::tick(SessionTime now) {
    session_->tick(now);
    if (attendant_) attendant_->tick(now);
}

SessionTime Lane::Company::next_wakeup() const {
    const SessionTime next = session_->next_wakeup();
    return attendant_ ? std::min(next, attendant_->next_wakeup()) : next;
}

Lane::Lane(const LanePlan& plan, const LaneEvents& events)
    : plan_(plan),
      events_(events),
      sockets_(plan.network),
      session_(system_entropy(), plan.session, open_channels()),
      company_(session_, plan.attend ? plan.attend(session_, sockets_) : nullptr),
      loop_(listening(sockets_, session_)),
      stops_heard_(emergency_stops()) {
    session_.set_sample_hook([this](const TrajectorySample& sample) {
        last_ = sample;
        if (writer_) writer_->append(sample);
    });
    session_.set_clock_hook([this](Role node, const ClockExchange& exchange) {
        if (clock_writer_) clock_writer_->append(node, exchange);
    });
}

Lane::~Lane() {
    for (const auto& node : nodes_) node->stop();
}

void Lane::open() {
    std::filesystem::create_directories(plan_.out);
    clock_writer_.emplace(clock_path());
    if (plan_.starter) launch();
    wait_for_machines();
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
    nodes_.resize(kNodes.size());
    for (std::size_t i = 0; i < kNodes.size(); ++i) start_node(i);
}

void Lane::start_node(std::size_t i) {
    const NodeKind& node = kNodes[i];
    const std::string again = revivals_ == 0 ? "" : fmt::format("_again{}", revivals_);
    NodeOrder order;
    order.role = node.role;
    order.program = node.program;
    order.log = plan_.out / fmt::format("{}_{:g}ms{}.log", node.program, 1000 * plan_.delay_s, again);
    order.report = report_path(i);
    order.arguments = {"--base-port", std::to_string(plan_.network.base_port)};
    if (plan_.strict_rt) order.arguments.emplace_back("--strict-rt");
    if (node.role == Role::kNetem) {
        order.arguments.insert(order.arguments.end(), {"--force-delay-s", fmt::format("{}", plan_.delay_s)});
    }
    nodes_[i] = plan_.starter->start(order);
}

// What was asked of a trial that is over, by its number, moves nobody: the new instance begins at none.
bool Lane::revive() {
    if (!plan_.starter || !dead_node()) return false;
    ++revivals_;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i]->poll()) start_node(i);
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
    }
    wait_for_nodes();
    return true;
}

std::string Lane::stop_words() const {
    const StopLine& line = session_.stop_line();
    if (!line.stopped()) return {};
    return fmt::format("{} ({}): {}; {}",
                       line.reason() == EndReason::kSafetyStop ? "safety stop" : "emergency stop",
                       to_string(line.raised_by()), line.words(), kHowToRelease);
}

void Lane::emergency_stop(std::string_view words) { session_.emergency_stop(wall_now(), words); }
void Lane::release_stop() { session_.release_stop(wall_now()); }

void Lane::hear_stop_key() {
    const unsigned asked = emergency_stops();
    if (asked == stops_heard_) return;
    stops_heard_ = asked;
    emergency_stop("Ctrl-\\ at thimble's terminal");
}

// The index of a node that has ended. Asks every one of them: that is how they learn that we are here.
std::optional<std::size_t> Lane::dead_node() {
    std::optional<std::size_t> dead;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (nodes_[i]->poll() && !dead) dead = i;
    }
    return dead;
}

void Lane::throw_if_dead() {
    const auto dead = dead_node();
    if (dead) throw Error(nodes_[*dead]->verdict(), nodes_[*dead]->obituary());
}

void Lane::wait_for_machines() {
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
        wall_sleep(kPoll);
    }
}

void Lane::wait_for_nodes() {
    const SessionTime deadline = wall_now() + plan_.session.peer_wait;
    for (SessionTime now = wall_now(); !session_.missing_peers(now, kPeerTimeout).empty(); now = wall_now()) {
        loop_.step(company_, now + kPoll);
        throw_if_dead();
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
    trajectory_ = trajectory;
    if (!trajectory.empty()) {
        std::filesystem::create_directories(trajectory.parent_path());
        writer_.emplace(trajectory, plan_.if_exists);
    }
    if (halted_) result_ = {};
    halted_ = false;
    session_.start(trial, number);
    SessionTime next_poll{}, next_flush{}, next_progress{};
    while (!session_.finished()) {
        const SessionTime now = wall_now();
        loop_.step(company_, now + kPoll);
        if (now >= next_poll) look_around(now + kPoll, next_poll);
        if (now >= next_flush) {
            if (writer_) writer_->flush();
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
    hear_stop_key();
    if (events_.stop && events_.stop()) return session_.abort(EndReason::kInterrupted);
    if (const auto dead = dead_node()) session_.abort(EndReason::kPeerLost, kNodes[*dead].role);
}

void Lane::close_trial() {
    const TrialRecord& record = session_.record();
    if (writer_) {
        writer_->end(record.reason, record.lost_peer);
        writer_.reset();
        if (!record.network_events.empty()) write_events(event_path(trajectory_), record.network_events);
    }
    // Not if whoever watches has ended the trial: then the lane goes on.
    if (record.reason == EndReason::kInterrupted && events_.stop && events_.stop()) {
        result_.code = ExitCode::kRunFailed;
        result_.problem = "interrupted; what was recorded is kept";
    } else if (is_stop(record.reason)) {
        halted_ = true;
        result_.code = ExitCode::kRunFailed;
        result_.problem = fmt::format("{}: {}", outcome_text(record.reason, record.lost_peer), record.fault);
        // Nodes that go on running without us hold it.
        if (!plan_.starter) result_.problem += fmt::format("; {}", kHowToRelease);
    } else if (record.reason == EndReason::kDeviceFault) {
        result_.code = ExitCode::kRunFailed;
        result_.problem =
            fmt::format("the device of {} failed: {}", to_string(record.lost_peer), record.fault);
    } else if (record.reason == EndReason::kPeerLost) {
        result_.code = ExitCode::kNetwork;
        const auto dead = dead_node();
        result_.problem = dead ? nodes_[*dead]->obituary()
                               : fmt::format("lost contact with {}", to_string(record.lost_peer));
    }
    if (events_.trial_done) events_.trial_done(record);
}

void Lane::idle(Duration limit) {
    const SessionTime end = wall_now() + limit;
    for (SessionTime now = wall_now(); now < end; now = wall_now()) {
        loop_.step(company_, std::min(end, now + kPoll));
        hear_stop_key();
        dead_node();
    }
}

LaneResult Lane::close() {
    close_clocks();
    if (!plan_.starter) return std::move(result_);
    session_.shut_down(wall_now());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        if (!wait_for_end(*nodes_[i], kFarewell)) nodes_[i]->stop();
        const auto code = wait_for_end(*nodes_[i], kFarewell);
        if (code == static_cast<int>(ExitCode::kRealtime) && result_.code == ExitCode::kOk) {
            result_.code = ExitCode::kRealtime;
            result_.problem = nodes_[i]->obituary();
        }
    }
    nodes_.clear();
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
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
