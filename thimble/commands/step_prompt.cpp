#include "thimble/commands/step_prompt.hpp"

#include <algorithm>
#include <csignal>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "common/duration_text.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/formats/text_lines.hpp"
#include "session/records/condition_summary.hpp"
#include "session/run/session_process.hpp"

namespace thimble {
namespace {

constexpr Duration kLookForLine = std::chrono::milliseconds{10};
constexpr double kLongest_s = 1e6;

// Of a number without a unit: seconds.
std::optional<double> seconds_in(std::string_view text) {
    if (const auto with_unit = parse_duration(text)) return with_unit;
    return parse_number(text);
}

double seconds_of(SessionTime time) { return to_seconds(time.time_since_epoch()); }

std::string due_text(const DueProgram& program, SessionTime first) {
    const std::string when =
        program.next == kNever ? "a datagram" : fmt::format("{:.6f} s", seconds_of(program.next));
    const std::string place = program.pid < 0 ? "elsewhere" : fmt::format("pid {}", program.pid);
    return fmt::format("  {:<9} {:<11} waits for {}{}\n", to_string(program.role), place, when,
                       program.next == first ? ", is next" : "");
}

}  // namespace

StepRequest parse_step(std::string_view line) {
    const std::string_view words = trimmed(line);
    if (words.empty()) return {StepKind::kNext, {}};
    if (words == "c") return {StepKind::kToEnd, {}};
    if (words == "q") return {StepKind::kQuit, {}};
    const auto seconds = seconds_in(words);
    if (!seconds || !(*seconds > 0 && *seconds <= kLongest_s)) return {};
    return {StepKind::kFor, from_seconds(*seconds)};
}

std::string pause_text(SteppedSession& session) {
    const TrialConditions& trial = session.session().record().conditions;
    std::string text = fmt::format("trial {}, {} {}, at {:.6f} s: ", trial.trial, delay_text(trial.delay_s),
                                   to_string(trial.modality), seconds_of(session.now()));
    const ForceFeedback* const newest = session.session().recorder().newest();
    text += newest == nullptr ? "slave_sim has not answered yet\n"
                              : fmt::format("needle {:.3f} mm, force {:.3f} N\n",
                                            1000 * newest->position_needle_m, newest->force_total_N);
    const std::vector<DueProgram> programs = session.due();
    SessionTime first = kNever;
    for (const DueProgram& program : programs) first = std::min(first, program.next);
    for (const DueProgram& program : programs) text += due_text(program, first);
    return text;
}

void StepPrompt::before_instant(SteppedSession& session) {
    if (session.now() < pause_at_ || stop_requested()) return;
    say_(pause_text(session));
    std::optional<StepRequest> request = ask();
    while (request && request->kind == StepKind::kUnknown) request = ask();
    if (request) obey(*request, session.now());
}

// None: Ctrl-C.
std::optional<StepRequest> StepPrompt::ask() {
    for (say_("step> "); !stop_requested(); wall_sleep(kLookForLine)) {
        if (const auto line = lines_->take_line()) {
            const StepRequest request = parse_step(*line);
            if (request.kind == StepKind::kUnknown) say_(fmt::format("{}\n", kStepHelp));
            return request;
        }
        if (lines_->ended()) return StepRequest{StepKind::kToEnd, {}};
    }
    return std::nullopt;
}

void StepPrompt::obey(const StepRequest& request, SessionTime now) {
    if (request.kind == StepKind::kFor) pause_at_ = now + request.duration;
    if (request.kind == StepKind::kToEnd) pause_at_ = kNever;
    if (request.kind == StepKind::kQuit) std::raise(SIGINT);
}

}  // namespace thimble
