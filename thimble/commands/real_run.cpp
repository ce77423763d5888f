#include "thimble/commands/real_run.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/network_settings.hpp"
#include "common/own_program.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "session/observe/plotjuggler.hpp"
#include "session/participant/dataset.hpp"
#include "session/play/order_handlers.hpp"
#include "session/play/play_starter.hpp"
#include "session/virtual/energy_demand.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

// Faults that otherwise only thimble-visual's log would show, after the folder is written.
void check_screen(const SystemSettings& settings, const std::shared_ptr<NodeStarter>& starter) {
    const bool window = settings.visual.window || settings.plan.kind == SubjectKind::kHuman;
    if (starter && window && starter->machine(Role::kVisual).empty()) check_window(program_folder());
    for (const std::string& warning : named_modalities(settings.pages.instructions)) spdlog::warn(warning);
}

void add_participant_options(CLI::App& command, ParticipantRun& run) {
    const auto group = "For a session with a participant (session files with [protocol])";
    PersonDescription& person = run.person;
    command
        .add_option("--participant", run.participant,
                    "P and a number, e.g. P07; it selects the participant's order of trials")
        ->group(group);
    command.add_flag("--resume", run.resume, "continue this participant's interrupted session")->group(group);
    command.add_flag("--consent", person.consent, "states that this person gave informed consent")
        ->group(group);
    command
        .add_flag("--commands", run.commands,
                  "ask before each trial on standard input, even if it is not a terminal")
        ->group(group);
    command.add_option("--age", person.age, "in whole years")->group(group);
    command.add_option("--sex", person.sex, "M, F, O or n/a")
        ->check(CLI::IsMember({"M", "F", "O", "n/a"}))
        ->group(group);
    command.add_option("--handedness", person.handedness, "left, right, ambidextrous or n/a")
        ->check(CLI::IsMember({"left", "right", "ambidextrous", "n/a"}))
        ->group(group);
    command
        .add_option("--haptic-experience", person.haptic_experience,
                    "with force-feedback devices: none, some, expert or n/a")
        ->check(CLI::IsMember({"none", "some", "expert", "n/a"}))
        ->group(group);
}

// The session file has no [protocol]: throws Error (usage) if its subject is a person, or one of the options above was given.
void refuse_participant_options(const ParticipantRun& run, const SystemSettings& settings) {
    if (settings.plan.kind == SubjectKind::kHuman) {
        throw Error(ExitCode::kUsage,
                    "[session] subject is \"human\", but the session file has no table [protocol], which "
                    "lists a person's trials: add one, as in deploy/sessions/human.toml");
    }
    if (run.participant.empty() && !run.resume && !run.commands && run.person == PersonDescription{}) return;
    throw Error(ExitCode::kUsage,
                "--participant, --resume, --consent, --commands, --age, --sex, --handedness and "
                "--haptic-experience need a session file with a table [protocol], and this one has none: add "
                "one, or leave these options out");
}

void say_participant(const ParticipantSessionResult& result, const std::filesystem::path& out, bool json) {
    const std::string id = participant_id(result.participant);
    if (!json && result.declined) {
        const std::string kept = result.kept
                                     ? "no further trial was run; earlier trials are kept in " + out.string()
                                     : "no trial was run, and no data about the person are kept";
        fmt::print("{} did not consent: {}\n", id, kept);
        return;
    }
    if (!json) {
        fmt::print("{}: {} of {} trials begun, {} records of which {} are repeats: {}\n", id,
                   result.trials_begun, result.trials_planned, result.records, result.repeats, out.string());
        return;
    }
    const nlohmann::ordered_json summary{
        {"participant_id", id},
        {"complete", result.code == ExitCode::kOk && result.problem.empty() && !result.declined},
        {"consent_declined", result.declined},
        {"trials_planned", result.trials_planned},
        {"trials_begun", result.trials_begun},
        {"records", result.records},
        {"repeats", result.repeats},
        {"dataset", out.string()}};
    fmt::print("{}\n", json_text(summary, 2));
}

int run_participant_for_real(RealRunArguments& arguments, const SystemSettings& settings) {
    if (arguments.run.overwrite) {
        throw Error(ExitCode::kUsage,
                    "a participant's data are never overwritten: name another folder with --out");
    }
    if (settings.protocol->blinded && (arguments.monitor || !arguments.plotjuggler.empty())) {
        throw Error(ExitCode::kUsage,
                    "[protocol] blinded hides modality and delay from the experimenter, but --monitor and "
                    "--plotjuggler show them: leave these options out, or set blinded = false");
    }
    ParticipantRun& run = arguments.participant;
    run.starter = arguments.run.starter;
    run.out = arguments.out_option->count() > 0 ? arguments.run.out : "out/dataset";
    run.network = arguments.run.network;
    run.person.age = age_text(run.person.age);
    if (settings.plan.kind == SubjectKind::kVirtual && run.person != PersonDescription{}) {
        throw Error(
            ExitCode::kUsage,
            "--consent, --age, --sex, --handedness and --haptic-experience describe a person, but "
            "[session] subject names a virtual one: leave these options out, or set subject = \"human\"");
    }
    run.strict_rt = arguments.run.strict_rt;
    run.stop = arguments.run.stop;
    run.check_screen = [&] { check_screen(settings, run.starter); };
    OrderLines orders;
    if (arguments.monitor) {
        run.view = ParticipantView{
            &orders, [&orders] { return orders.context().paused; },
            [&orders](std::size_t trials) { orders.context().trials = static_cast<std::uint32_t>(trials); },
            [&orders](SessionProcess& session, Sockets& sockets, const std::string&) {
                orders.serve(session);
                return make_observer(session, sockets, orders, orders.context());
            }};
    }
    if (!arguments.plotjuggler.empty())
        run.make_observer = with_plotjuggler(run.view ? run.view->make_observer : nullptr,
                                             plotjuggler_at(arguments.plotjuggler, run.network));
    const ParticipantSessionResult result = run_participant(settings, run);
    say_participant(result, run.out, arguments.json);
    if (result.code != ExitCode::kOk) spdlog::error(result.problem);
    return static_cast<int>(result.code);
}

}  // namespace

void add_real_run_options(CLI::App& command, RealRunArguments& a) {
    add_session_option(command, a.config, "session file (TOML), or the name of a built-in one, e.g. delay50")
        ->required();
    a.out_option = command
                       .add_option("-o,--out", a.run.out,
                                   "folder for the results; a participant's go to out/dataset by default")
                       ->type_name("FOLDER")
                       ->default_val("out/run");
    add_base_port_option(command, a.base_port);
    command.add_flag("--overwrite", a.run.overwrite, "replace earlier results in that folder");
    command.add_flag("--strict-rt", a.run.strict_rt, "exit with 4 if a program missed too many deadlines");
    command.add_flag("--monitor", a.monitor,
                     "accept an experimenter's view: show it the session and obey its requests (ports 23 and "
                     "24, docs/protocol.md)");
    command
        .add_option(
            "--plotjuggler", a.plotjuggler,
            "send live values without delay to PlotJuggler's UDP server (JSON, 100 Hz, usually port 9870)")
        ->type_name("[HOST:]PORT");
    command.add_flag("--json", a.json, "print summary.json on stdout, instead of text");
    add_participant_options(command, a.participant);
}

int run_for_real(const RealRunArguments& given, const SystemSettings& settings,
                 const std::shared_ptr<NodeStarter>& starter) {
    install_stop_signals(QuitSignal::kStopsEverything);
    if (starter) check_build(settings);
    RealRunArguments arguments = given;
    RunOptions& options = arguments.run;
    options.starter = starter;
    options.network = network_of(arguments.config, arguments.base_port);
    options.stop = &stop_requested();
    options.made_with = made_with({arguments.config});
    require_protection(options.network);
    if (is_real(settings.handle.kind) || settings.slave.device != SlaveDevice::kSimulated)
        require_protection_of_handle(options.network);
    // It names delays and modalities; `thimble check` and `thimble doctor` say it, too.
    const bool blinded = settings.protocol && settings.protocol->blinded;
    const std::string warning = blinded ? "" : energy_warning(settings);
    if (!warning.empty()) spdlog::warn(warning);
    if (options.clock != RunClock::kVirtual) warn_if_unprotected(options.network);
    // A bad key leaves no folder behind.
    if (options.clock != RunClock::kVirtual)
        make_security(options.clock == RunClock::kWall ? options.network : without_user_key(options.network));
    if (settings.protocol) return run_participant_for_real(arguments, settings);
    refuse_participant_options(arguments.participant, settings);
    refuse_dataset(options.out);
    if (options.clock == RunClock::kWall) check_screen(settings, starter);
    options.runtime = read_runtime_settings(ConfigFile::load(arguments.config));
    QuitHandler handler;
    const MonitorContext context{static_cast<std::uint32_t>(settings.plan.modalities.size())};
    if (arguments.monitor) {
        options.quit = [&handler] { return handler.quit(); };
        options.make_observer = [&handler, &context](SessionProcess& session, Sockets& sockets,
                                                     const std::string&) {
            return make_observer(session, sockets, handler, context);
        };
    }
    if (!arguments.plotjuggler.empty())
        options.make_observer =
            with_plotjuggler(options.make_observer, plotjuggler_at(arguments.plotjuggler, options.network));
    const RunResult result = run_session(settings, options);
    say_results(arguments.json, options.out, result.rows);
    if (result.code != ExitCode::kOk) spdlog::error(result.problem);
    return static_cast<int>(result.code);
}

}  // namespace thimble
