#include "session/run/condition_files.hpp"

#include <exception>
#include <system_error>

#include <fmt/format.h>

#include "common/csv/csv_file.hpp"
#include "common/json_text.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/text_file.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/records/trajectory_file.hpp"

namespace thimble {
namespace {

constexpr Duration kClockNotes = std::chrono::seconds{1};  // offsets to the log, of each node
constexpr std::size_t kMostSamples = 512;                  // kept in memory, unless the disk is slow

}  // namespace

ConditionFiles::ConditionFiles(const ConditionPlan& plan, bool log)
    : plan_(plan),
      log_(log && plan.log.messages != LoggedMessages::kNone ? std::make_unique<MessageLog>() : nullptr) {}

ConditionFiles::~ConditionFiles() {
    settle();
    if (!thread_.joinable()) return;
    writing_ = Writing::kEnds;
    writing_.notify_one();
    thread_.join();
}

template <class Write>
void ConditionFiles::attempt(Write&& write) {
    try {
        write();
    } catch (const std::exception& error) {
        if (attempt_.empty()) attempt_ = error.what();
    }
}

// Starts the thread, and takes the memory that a trial needs, because the loop of a trial allocates nothing.
void ConditionFiles::start() {
    for (Lines* lines : {&fresh_, &handed_over_}) {
        lines->samples.reserve(2 * kMostSamples);
        lines->clocks.reserve(kMostSamples);
    }
    try {
        if (!thread_.joinable()) thread_ = std::thread([this] { write_until_ended(); });
    } catch (const std::system_error& error) {
        throw Error(ExitCode::kRunFailed, "cannot start the thread that writes the files: {}", error.what());
    }
}

void ConditionFiles::write(Lines& lines) {
    attempt([&] {
        if (writer_) writer_->append(lines.samples);
        if (writer_) writer_->flush();
    });
    attempt([&] {
        for (const ClockRecord& record : lines.clocks) clock_writer_->append(record.node, record.exchange);
        if (clock_writer_) clock_writer_->flush();
    });
    lines.samples.clear();
    lines.clocks.clear();
}

void ConditionFiles::write_until_ended() {
    for (;;) {
        writing_.wait(Writing::kNothing);
        if (writing_ == Writing::kEnds) return;
        write(handed_over_);
        writing_ = Writing::kNothing;
        writing_.notify_one();
    }
}

// Until the disk has all that was added.
void ConditionFiles::settle() {
    writing_.wait(Writing::kHandedOver);
    write(fresh_);
    fault_ = attempt_;
}

void ConditionFiles::open() {
    make_folder(plan_.out);
    clock_writer_.emplace(clock_path());
    start();
    if (!log_) return;
    const auto path = messages_path("session");
    remove_file(path);
    log_->start(path, {"session", plan_.session_file, {}}, plan_.log);
}

std::string ConditionFiles::again() const { return restarts_ == 0 ? "" : fmt::format("_again{}", restarts_); }

std::filesystem::path ConditionFiles::report_path(std::size_t node) const {
    return plan_.out / fmt::format("{}_{}.json", kNodes[node].program, delay_in_names(plan_.delay_s));
}

std::filesystem::path ConditionFiles::log_path(std::size_t node) const {
    return plan_.out /
           fmt::format("{}_{}{}.log", kNodes[node].program, delay_in_names(plan_.delay_s), again());
}

std::filesystem::path ConditionFiles::clock_path() const {
    return plan_.out / fmt::format("clocks_{}.csv", delay_in_names(plan_.delay_s));
}

std::filesystem::path ConditionFiles::messages_path(const std::string& program) const {
    return plan_.out / fmt::format("{}_{}{}.mcap", program, delay_in_names(plan_.delay_s), again());
}

void ConditionFiles::begin_trial(const TrialConditions& trial, std::uint32_t number,
                                 const std::filesystem::path& trajectory) {
    settle();
    start();
    trajectory_ = trajectory;
    if (!trajectory.empty()) {
        make_folder(trajectory.parent_path());
        writer_.emplace(trajectory, plan_.if_exists);
        if (plan_.if_exists == IfExists::kReplace) remove_file(event_path(trajectory));  // an earlier trial's
    }
    if (log_) log_->note("trial", trial_note(trial, number, wall_now()));
}

void ConditionFiles::add(const TrajectorySample& sample) {
    if (writer_) fresh_.samples.push_back(sample);
    if (fresh_.samples.size() >= kMostSamples) flush();
}

void ConditionFiles::add(Role node, const ClockExchange& exchange, const ClockFilter& clock) {
    if (clock_writer_) fresh_.clocks.push_back({node, exchange});
    note(node, exchange, clock);
}

// As measured until now, once a second and node.
void ConditionFiles::note(Role node, const ClockExchange& exchange, const ClockFilter& clock) {
    SessionTime& next = next_clock_note_.at(static_cast<std::size_t>(node));
    if (!log_ || exchange.answered < next) return;
    next = exchange.answered + kClockNotes;
    const auto offset = clock.at(exchange.answered);
    if (!offset) return;
    log_->note("clock_offset", {{"node", to_string(node)},
                                {"offset_s", fmt::format("{:.9f}", offset->offset_s())},
                                {"bound_s", fmt::format("{:.9f}", offset->bound_s())},
                                {"at_ns", std::to_string(to_nanoseconds(exchange.answered))}});
}

McapMap trial_note(const TrialConditions& trial, std::uint32_t number, SessionTime at) {
    return {{"seed", std::to_string(trial.study_seed)},
            {"experiment", std::to_string(trial.experiment)},
            {"subject", std::to_string(trial.subject)},
            {"trial", std::to_string(trial.trial)},
            {"number_on_the_wire", std::to_string(number)},
            {"modality", to_string(trial.modality)},
            {"delay_s", fmt::format("{}", trial.delay_s)},
            {"fixture_position_m", fmt::format("{}", trial.fixture_position_m)},
            {"at_ns", std::to_string(to_nanoseconds(at))}};
}

void ConditionFiles::flush() {
    if (writing_ != Writing::kNothing) return;  // a slow disk
    fault_ = attempt_;
    if (fresh_.samples.empty() && fresh_.clocks.empty()) return;
    std::swap(fresh_, handed_over_);
    writing_ = Writing::kHandedOver;
    writing_.notify_one();
}

void ConditionFiles::end_trial(const TrialRecord& record) {
    settle();
    if (!writer_) return;
    attempt([&] { writer_->end(record.reason, record.lost_peer); });
    writer_.reset();
    if (!record.network_events.empty())
        attempt([&] { write_events(event_path(trajectory_), record.network_events); });
    fault_ = attempt_;
}

// The file is the record; the summary is made from it. After a fault its last line may be half a one.
std::vector<NodeClock> ConditionFiles::close_clocks() {
    if (!clock_writer_) return {};
    settle();
    clock_writer_.reset();
    if (!fault_.empty()) return {};
    return clocks_of(plan_.delay_s, read_clock_file(clock_path()));
}

void ConditionFiles::write_session_report(const nlohmann::ordered_json& report) {
    attempt([&] {
        CsvFile file(plan_.out / fmt::format("session_{}.json", delay_in_names(plan_.delay_s)),
                     IfExists::kReplace);
        file.write(json_text(report, 2) + "\n");
        file.flush();
    });
    fault_ = attempt_;
}

}  // namespace thimble
