#include "thimble/commands/participant_options.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"

namespace thimble {

void add_participant_options(CLI::App& run, ParticipantArguments& a) {
    const auto group = "A participant's session (session files with [protocol])";
    run.add_option("--participant", a.participant, "P and a number, e.g. P07: which row of the order")
        ->group(group);
    run.add_flag("--resume", a.resume, "go on where this participant's session was interrupted")
        ->group(group);
    run.add_flag("--consent", a.person.consent, "the person gave informed consent")->group(group);
    run.add_flag("--commands", a.commands,
                 "ask before each trial and read the answers from standard input, also if it is no terminal")
        ->group(group);
    run.add_option("--age", a.person.age, "whole years")->group(group);
    run.add_option("--sex", a.person.sex, "M, F or O")
        ->check(CLI::IsMember({"M", "F", "O", "n/a"}))
        ->group(group);
    run.add_option("--handedness", a.person.handedness, "left, right or ambidextrous")
        ->check(CLI::IsMember({"left", "right", "ambidextrous", "n/a"}))
        ->group(group);
    run.add_option("--haptic-experience", a.person.haptic_experience, "none, some or expert")
        ->check(CLI::IsMember({"none", "some", "expert", "n/a"}))
        ->group(group);
}

void refuse_participant_options(const ParticipantArguments& a, const SystemSettings& settings) {
    if (settings.plan.kind == SubjectKind::kHuman) {
        throw Error(
            ExitCode::kUsage,
            "[session] subject is \"human\", but there is no table [protocol] to say what a person is to "
            "do: add one, e.g. as in deploy/sessions/human.toml");
    }
    if (a.participant.empty() && !a.resume && !a.person.consent && !a.commands) return;
    throw Error(ExitCode::kUsage,
                "--participant, --resume, --consent and --commands are of a participant's session, and this "
                "session file has no table [protocol]: add one, or leave them out");
}

int run_participant_and_say(const SystemSettings& settings, const ParticipantArguments& arguments,
                            ParticipantRun run, bool json) {
    run.participant = arguments.participant;
    run.person = arguments.person;
    run.person.age = age_text(run.person.age);
    run.resume = arguments.resume;
    run.commands = arguments.commands;
    const ParticipantSessionResult result = run_participant(settings, run);
    if (json) {
        const nlohmann::ordered_json summary{
            {"participant_id", participant_id(result.participant)},
            {"complete", result.code == ExitCode::kOk && result.problem.empty()},
            {"trials_planned", result.trials_planned},
            {"trials_begun", result.trials_begun},
            {"records", result.records},
            {"repeats", result.repeats},
            {"dataset", run.out.string()}};
        fmt::print("{}\n", json_text(summary, 2));
    } else {
        fmt::print("{}: {} of {} trials, {} records of which {} repeat another: {}\n",
                   participant_id(result.participant), result.trials_begun, result.trials_planned,
                   result.records, result.repeats, run.out.string());
    }
    if (result.code != ExitCode::kOk) spdlog::error(result.problem);
    return static_cast<int>(result.code);
}

}  // namespace thimble
