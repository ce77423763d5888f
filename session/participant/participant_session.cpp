#include "session/participant/participant_session.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "session/participant/tsv.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/trajectory_file.hpp"

namespace thimble {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{20};  // for a line, for a stop
constexpr unsigned kLostInARow = 3;                        // then it is not the trial

// Files of an interrupted trial, which has no record, are kept under another name.
void keep_aside(const std::filesystem::path& file) {
    std::error_code absent;
    if (!std::filesystem::exists(file, absent)) return;
    for (unsigned i = 1;; ++i) {
        const auto aside = file.parent_path() / fmt::format("{}_cut{}.csv", file.stem().string(), i);
        if (std::filesystem::exists(aside, absent)) continue;
        std::filesystem::rename(file, aside);
        return;
    }
}

}  // namespace

ParticipantSession::ParticipantSession(ParticipantSessionOptions options, TrialRunner& runner)
    : options_(std::move(options)), runner_(runner), table_(options_.dataset.records(options_.participant)) {
    agenda_.participant = options_.participant;
    agenda_.order = read_order(options_.dataset.order(options_.participant), options_.participant);
    agenda_.records = read_records(options_.dataset.records(options_.participant));
    agenda_.exclusions = read_exclusions(options_.dataset.exclusions(), LastLine::kMayBeTorn);
    if (options_.pages == nullptr) return;
    const std::uint32_t blocks = agenda_.order.empty() ? 0 : agenda_.order.back().block;
    open_phenotype(options_.dataset, *options_.pages, blocks);
}

ParticipantSessionResult ParticipantSession::run() {
    note_missed_attention();
    const std::optional<Step> first = agenda_.next(options_.protocol);
    if (first || questions_are_due(first)) runner_.prepare();  // before the first question
    for (;;) {
        const std::optional<Step> step = agenda_.next(options_.protocol);
        Answer answer = step ? await_release(step) : Answer::kGo;
        if (answer == Answer::kGo) answer = ask_questions(step);
        if (answer == Answer::kGo) answer = before(step);
        if (answer == Answer::kAskAgain) continue;
        if (answer == Answer::kGo && step && !runner_.stop_text().empty())
            continue;  // pressed while we asked
        if (answer == Answer::kStop || stopped()) {
            Page paused = page(step);
            paused.kind = PageKind::kPaused;
            runner_.show(paused);
            return result(ExitCode::kRunFailed,
                          "interrupted; finished trials are kept: continue with --resume");
        }
        if (!step) return result(ExitCode::kOk, "");
        do_trial(*step);
        if (lost_in_a_row_ == kLostInARow) {
            // A full disk is one, too.
            const bool fault = agenda_.records.back().row.reason != EndReason::kPeerLost;
            return result(
                fault ? ExitCode::kRunFailed : ExitCode::kNetwork,
                fmt::format("{} trials in a row failed: {}; remove the cause and continue with --resume",
                            kLostInARow, runner_.problem()));
        }
    }
}

// After a stop no trial begins until the experimenter releases it. kAskAgain: the stop is released. The experimenter may have
// marked the last trial, so another one may be next.
ParticipantSession::Answer ParticipantSession::await_release(const std::optional<Step>& step) {
    if (runner_.stop_text().empty()) return Answer::kGo;
    const bool stops = thimble::await_release(asker(step), page(step)) == Asked::kStopped;
    return stops ? Answer::kStop : Answer::kAskAgain;
}

// `step` outlives it.
Asker ParticipantSession::asker(const std::optional<Step>& step) {
    return {runner_,
            commands(),
            options_.stop,
            options_.say,
            [this](const std::string& line) { return after_order(obey(line)); },
            [this, &step] { return after_order(await_release(step)); }};
}

bool ParticipantSession::questions_are_due(const std::optional<Step>& step) const {
    std::uint32_t block = 0;
    return options_.pages != nullptr &&
           due_questionnaire(options_.dataset, *options_.pages, agenda_, step, block).has_value();
}

ParticipantSession::Answer ParticipantSession::ask_questions(const std::optional<Step>& step) {
    const Asker asking = asker(step);
    while (questions_are_due(step)) {
        std::uint32_t block = 0;
        const PageSet& pages = *options_.pages;
        const std::size_t form = *due_questionnaire(options_.dataset, pages, agenda_, step, block);
        std::vector<std::optional<double>> answers;
        const Asked asked = ask_questionnaire(asking, pages, form, answers);
        if (asked != Asked::kGoOn) return asked == Asked::kPutOff ? Answer::kAskAgain : Answer::kStop;
        const std::string time =
            options_.realtime_ns ? utc_text(options_.realtime_ns()) : std::string(kNotAvailable);
        write_answers(options_.dataset, pages.questionnaires[form],
                      {options_.participant, block, time, std::move(answers)});
    }
    return Answer::kGo;
}

// Result of an order that came during a question.
Asked ParticipantSession::after_order(Answer answer) const {
    if (answer == Answer::kStop) return Asked::kStopped;
    if (answer == Answer::kGo) return Asked::kGoOn;
    // A mark changes the next step.
    return questions_are_due(agenda_.next(options_.protocol)) ? Asked::kGoOn : Asked::kPutOff;
}

bool ParticipantSession::rest_is_due(const std::optional<Step>& step) const {
    return step && last_block_ && *last_block_ != step->entry.block && options_.protocol.break_every > 0;
}

std::string ParticipantSession::name_of(const Step& step) const {
    const TrialConditions& c = step.entry.conditions;
    const std::string conditions =
        options_.protocol.blinded ? ""
                                  : fmt::format("experiment {}, {}", c.experiment, to_string(c.modality));
    const bool attention = is_attention(step.entry) && !options_.protocol.blinded;
    const char* const kind = step.entry.practice ? "practice" : attention ? "attention" : "";
    const std::string both =
        fmt::format("{}{}{}", kind, *kind == 0 || conditions.empty() ? "" : ", ", conditions);
    return fmt::format("trial {} of {}{}{}", step.entry.position, agenda_.order.size(),
                       both.empty() ? "" : fmt::format(" ({})", both),
                       step.repeat_of == 0 ? "" : fmt::format(" again: {}", step.reason));
}

ParticipantSession::Answer ParticipantSession::before(const std::optional<Step>& step) {
    const bool asks = options_.lines != nullptr || (options_.subject_goes_on && step);
    if (rest_is_due(step) && !rest_ && (asks || options_.rests)) {
        const Duration minimum = options_.rests ? options_.protocol.break_minimum : Duration{0};
        rest_.emplace(runner_.now(), minimum, asks);
        options_.say(minimum > Duration{0} ? fmt::format("break of at least {:g} s. {}", to_seconds(minimum),
                                                         options_.protocol.break_text)
                                           : "break. " + options_.protocol.break_text);
    }
    if (!asks) {
        while (rest_ && !rest_->over_by_itself(runner_.now()) && !stopped()) wait(step);
        if (const auto asked = take_requests(step)) return *asked;
        runner_.show(page(step));
        return Answer::kGo;
    }
    if (!step && !last_block_) return Answer::kGo;  // it was complete before
    return ask(step ? "next: " + name_of(*step) : "last trial done", step);
}

// Nothing: go on.
std::optional<ParticipantSession::Answer> ParticipantSession::take_requests(const std::optional<Step>& step) {
    if (options_.requests == nullptr) return std::nullopt;
    do {
        while (const auto line = options_.requests->take_line()) {
            if (line->empty()) continue;  // go on: it does
            // What they mark changes what comes next.
            if (const Answer answer = obey(*line); answer != Answer::kGo) return answer;
        }
        if (step && paused()) wait(step);
    } while (step && paused() && !stopped());
    return std::nullopt;
}

// The participant must know neither modality nor fixture.
Page ParticipantSession::page(const std::optional<Step>& step) const {
    Page page;
    page.trials = static_cast<std::uint32_t>(agenda_.order.size());
    page.kind = PageKind::kDone;
    if (!step) return page;
    page.trial = step->entry.position;
    if (rest_) page.remaining_s = to_seconds(rest_->left(runner_.now()));
    if (paused()) {
        page.kind = PageKind::kPaused;
    } else if (page.remaining_s > 0) {
        page.kind = PageKind::kBreak;
    } else if (agenda_.records.empty()) {
        page.kind = PageKind::kWelcome;
    } else {
        page.kind = step->entry.practice ? PageKind::kPractice : PageKind::kReady;
    }
    return page;
}

void ParticipantSession::wait(const std::optional<Step>& step) {
    runner_.show(page(step));
    runner_.idle(kLook);
}

ParticipantSession::Answer ParticipantSession::ask(const std::string& prompt,
                                                   const std::optional<Step>& step) {
    options_.say(fmt::format("{}. {}", prompt, who_goes_on(step)));
    for (;;) {
        if (stopped()) return Answer::kStop;
        if (const auto line = take_line()) return obey(*line);
        if (options_.lines != nullptr && options_.lines->ended()) {
            if (!step) return Answer::kGo;  // nothing is left to be asked
            options_.say(kInputEnded);
            return Answer::kStop;
        }
        if (options_.subject_goes_on && runner_.take_go_on() && waits_to_go_on(page(step).kind))
            return go_on();
        wait(step);
    }
}

// After the last trial only the experimenter goes on.
std::string ParticipantSession::who_goes_on(const std::optional<Step>& step) const {
    if (!options_.subject_goes_on || !step) return kPromptHelp;
    return options_.lines == nullptr
               ? "The participant continues at the screen"
               : fmt::format("{}. The participant can also continue at the screen", kPromptHelp);
}

std::optional<std::string> ParticipantSession::take_line() {
    return commands() == nullptr ? std::nullopt : commands()->take_line();
}

ParticipantSession::Answer ParticipantSession::obey(const std::string& line) {
    const PromptCommand command = parse_prompt_line(line);
    switch (command.kind) {
        case PromptKind::kGoOn:
            return go_on();
        case PromptKind::kQuit:
            return Answer::kStop;
        case PromptKind::kReject:
            mark_last(ExclusionKind::kRejected, command.reason);
            break;
        case PromptKind::kExclude:
            mark_last(ExclusionKind::kExcluded, command.reason);
            break;
        case PromptKind::kNoReason:
            options_.say("a reason is missing, e.g.: r sneezed");
            break;
        case PromptKind::kUnknown:
            options_.say(fmt::format("'{}' is not a command", line));
            break;
    }
    return Answer::kAskAgain;
}

ParticipantSession::Answer ParticipantSession::go_on() {
    if (!rest_ || rest_->over_by_enter(runner_.now())) return Answer::kGo;
    options_.say(
        fmt::format("the break continues for {:.0f} s", std::ceil(to_seconds(rest_->left(runner_.now())))));
    return Answer::kAskAgain;
}

void ParticipantSession::mark_last(ExclusionKind kind, const std::string& reason) {
    if (agenda_.records.empty()) return options_.say("there is no trial yet");
    const DatasetRecord& last = agenda_.records.back();
    const Exclusion mark{options_.participant, last.position, last.record, kind, reason};
    const Exclusion* there = find_exclusion(agenda_.exclusions, options_.participant, last.record);
    if (there != nullptr && (there->kind == kind || there->kind == ExclusionKind::kExcluded)) {
        return options_.say(
            fmt::format("trial {} is {} already: {}", last.position, to_string(there->kind), there->reason));
    }
    const TurnLock lock(options_.dataset.description());
    add_exclusion(options_.dataset.exclusions(), mark);
    agenda_.exclusions.push_back(mark);
    options_.say(fmt::format("trial {} is {}: {}", last.position, to_string(kind), reason));
}

void ParticipantSession::do_trial(const Step& step) {
    rest_.reset();
    runner_.prepare();
    const TrialConditions& c = step.entry.conditions;
    DatasetRecord record;
    record.record = static_cast<std::uint32_t>(agenda_.records.size() + 1);
    record.position = step.entry.position;
    record.block = step.entry.block;
    record.practice = step.entry.practice;
    record.repeat_of = step.repeat_of;
    record.repeat_reason = step.reason;
    // The same for a trial that was begun before, unless nodes that went on running have seen it.
    record.number = std::max({record.record, runner_.last_number() + 1, last_number_ + 1});
    const auto trajectory =
        options_.dataset.source(options_.participant) / "trajectories" /
        fmt::format("record{:03}_experiment{}_{}", record.record, c.experiment, trajectory_name(c));
    keep_aside(trajectory);
    const TrialRecord& trial = runner_.run(c, record.number, trajectory);
    if (commands() != nullptr) commands()->forget_enter();
    record.row = make_row(trial);
    table_.append(record);
    agenda_.records.push_back(record);
    last_number_ = record.number;
    last_block_ = step.entry.block;
    const bool lost = record.row.reason == EndReason::kPeerLost ||
                      record.row.reason == EndReason::kDeviceFault ||
                      record.row.reason == EndReason::kSafetyStop;
    lost_in_a_row_ = lost ? lost_in_a_row_ + 1 : 0;
    // The runner knows more than the session's own clock: how a program ended, which file could not be written.
    const bool explained =
        record.row.reason == EndReason::kPeerLost || record.row.reason == EndReason::kDeviceFault;
    const std::string words = explained ? runner_.problem() : trial.fault;
    if (!words.empty()) options_.say(printable(words));
    options_.say(fmt::format("{}: {}", name_of(step), course_of(record)));
    if (is_attention(step.entry)) note_attention(record);
}

std::string ParticipantSession::course_of(const DatasetRecord& record) const {
    return options_.protocol.blinded ? outcome_text(record.row.reason, record.row.lost_peer)
                                     : course_text(record.row);
}

void ParticipantSession::note_attention(const DatasetRecord& record) {
    if (!ran_to_its_end(record.row)) return;  // it is run again
    const AttentionResult result =
        judge_attention(options_.participant, record, options_.protocol.attention_limit);
    const TurnLock lock(options_.dataset.description());
    add_attention(options_.dataset.attention(), result);
    if (options_.protocol.blinded) return;
    options_.say(fmt::format("attention trial {}: {}", record.position, result.passed ? "passed" : "failed"));
}

// A crash may come between a trial's line and its line in attention.tsv.
void ParticipantSession::note_missed_attention() {
    const auto noted = read_attention(options_.dataset.attention(), LastLine::kMayBeTorn);
    for (const DatasetRecord& record : agenda_.records) {
        if (record.row.conditions.trial < kFirstAttentionTrial) continue;
        const bool there = std::any_of(noted.begin(), noted.end(), [&](const AttentionResult& result) {
            return result.participant == options_.participant && result.position == record.position &&
                   result.record >= record.record;
        });
        if (!there) note_attention(record);
    }
}

ParticipantSessionResult ParticipantSession::result(ExitCode code, std::string problem) const {
    const auto repeats = std::count_if(agenda_.records.begin(), agenda_.records.end(),
                                       [](const DatasetRecord& record) { return record.repeat_of != 0; });
    return {code,
            std::move(problem),
            options_.participant,
            agenda_.begun(),
            agenda_.order.size(),
            agenda_.records.size(),
            static_cast<std::size_t>(repeats)};
}

}  // namespace thimble
