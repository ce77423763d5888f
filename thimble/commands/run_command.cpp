// thimble run: one trial per modality and delay, or a participant's session, by real processes over UDP. Each node runs on the machine
// that [launch] names, else on this one.
#include <algorithm>
#include <memory>
#include <string>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/runtime/standard_streams.hpp"
#include "session/launch/node_starter.hpp"
#include "session/launch/remote_starter.hpp"
#include "session/launch/unit_files.hpp"
#include "session/play/play_starter.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/machines.hpp"
#include "thimble/commands/real_run.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct RunArguments : RealRunArguments {
    bool attach = false, check = false, step = false;
    std::string exec, programs, print, clock;
    double answer_limit_s = 60;
    CLI::Option* answer_limit_option = nullptr;
};

LaunchSettings launch_of(const RunArguments& arguments, const SystemSettings& settings) {
    LaunchSettings launch = settings.launch;
    if (!arguments.exec.empty()) launch.exec = arguments.exec;
    if (!arguments.programs.empty()) launch.programs = arguments.programs;
    if (exec_words(launch, "x").empty())
        throw Error(ExitCode::kUsage, "--exec is empty: give a command, or leave it out to use ssh");
    take_ros2_programs(settings, launch, arguments.print == "systemd");
    return launch;
}

std::shared_ptr<NodeStarter> starter_for(const LaunchSettings& launch, const std::string& session) {
    auto here = std::make_unique<LocalStarter>(program_folder(), session, launch.own_programs);
    if (!launch.anywhere_else()) return here;
    return std::make_shared<RemoteStarter>(launch, session, std::move(here));
}

RunClock clock_of(const RunArguments& arguments) {
    const auto* const named = std::find(kRunClockNames.begin(), kRunClockNames.end(), arguments.clock);
    return static_cast<RunClock>(named - kRunClockNames.begin());
}

// Throws Error (usage): this clock, and something that keeps to the wall clock.
void check_clock(const RunArguments& a, const SystemSettings& settings) {
    const char* const only_lock_step = a.step                               ? "--step"
                                       : a.answer_limit_option->count() > 0 ? "--answer-limit-s"
                                                                            : nullptr;
    if (only_lock_step != nullptr && a.run.clock != RunClock::kLockStep)
        throw Error(ExitCode::kUsage, "{} needs --clock lock-step: add that option, or leave {} out",
                    only_lock_step, only_lock_step);
    if (a.run.clock == RunClock::kWall) return;
    const auto refuse = [&a](const std::string& what, const char* remedy) {
        throw Error(ExitCode::kUsage, "{} does not work with --clock {}: {}, or leave out --clock", what,
                    a.clock, remedy);
    };
    const std::string command = fmt::format("run --clock {}", a.clock);
    require_simulated_devices(settings, command);
    if (a.run.clock == RunClock::kVirtual) require_virtual_subjects(settings, command);
    if (settings.protocol) refuse("a participant's session ([protocol])", "leave that table out");
    if (settings.cutaneous.device != FingertipDevice::kSimulated)
        refuse("the fingertip device of [cutaneous]", "set device = \"simulated\"");
    if (settings.visual.window && a.run.clock == RunClock::kLockStep)
        refuse("a window ([visual])", "set display = \"recording\"");
    if (a.attach) refuse("--attach, which uses running programs,", "leave it out");
    if (launch_of(a, settings).anywhere_else() && a.run.clock == RunClock::kVirtual)
        refuse("a program on another machine ([launch])", "remove that key machine_...");
    const bool watched = a.monitor || !a.plotjuggler.empty();
    if (watched && a.run.clock == RunClock::kVirtual)
        refuse("an observer", "leave out --monitor and --plotjuggler, or use --clock lock-step");
    if (settings.log.messages == LoggedMessages::kAll && a.run.clock == RunClock::kVirtual)
        refuse("the log of all messages ([log])", "remove its key messages");
    if (a.run.strict_rt) refuse("--strict-rt", "leave it out");
}

// A node may stand at a breakpoint for as long as its user looks.
void pause_in(RunArguments& a) {
    if (a.answer_limit_option->count() == 0) a.run.answer_limit = std::chrono::hours{24};
    a.run.step = std::make_shared<StepPrompt>(std::make_unique<DescriptorLines>(STDIN_FILENO), write_stderr);
}

int run_nodes(RunArguments& arguments) {
    const SystemSettings settings = load_system_settings(arguments.config);
    arguments.run.clock = clock_of(arguments);
    arguments.run.answer_limit = from_seconds(arguments.answer_limit_s);
    check_clock(arguments, settings);
    if (arguments.step) pause_in(arguments);
    if (arguments.attach) settings.launch.require_no_own_program("--attach");
    if (arguments.attach) return run_for_real(arguments, settings, nullptr);
    const LaunchSettings launch = launch_of(arguments, settings);
    const NetworkSettings network = network_of(arguments.config, arguments.base_port);
    check_hosts(launch, network);
    if (arguments.print == "systemd") {
        const bool to_files = arguments.out_option->count() > 0;
        print_units(arguments.config, launch, network, to_files ? arguments.run.out : "");
        return 0;
    }
    if (arguments.print == "ports") {
        fmt::print("{}", firewall_table(network, launch));
        return 0;
    }
    if (arguments.check) {
        const ScratchFolder logs;  // their words are printed
        return static_cast<int>(check_machines(launch, logs.path(), arguments.json));
    }
    return run_for_real(arguments, settings, starter_for(launch, arguments.config));
}

void add_clock_options(CLI::App& run, RunArguments& a) {
    run.add_option("--clock", a.clock,
                   "wall: real time; lock-step: the same programs in a shared virtual time, same bits in "
                   "every run; virtual: the same trials in one program, fastest (docs/clocks.md)")
        ->check(CLI::IsMember(std::vector<std::string>(kRunClockNames.begin(), kRunClockNames.end())))
        ->default_val("wall");
    a.answer_limit_option =
        run.add_option(
               "--answer-limit-s", a.answer_limit_s,
               "with lock-step: longest wait for a program (default 60) and for a datagram (at most 60), s")
            ->check(CLI::Range(0.1, 1e6));
    run.add_flag("--step", a.step,
                 "with lock-step: pause before each event, show which program is next, and ask how far to go "
                 "(docs/howto/step-through.md)");
}

void add_machine_options(CLI::App& run, RunArguments& a) {
    const auto group = "For other machines (session files with [launch])";
    CLI::Option* const attach =
        run.add_flag("--attach", a.attach,
                     "use programs that run already, on one machine or several, instead of starting them; "
                     "the session file of thimble-netem sets the delay");
    attach->group(group);
    run.add_option("--exec", a.exec,
                   "command that runs a command on {host}, instead of [launch] exec (default ssh)")
        ->type_name("COMMAND")
        ->group(group);
    run.add_option("--programs", a.programs,
                   "folder of Thimble's programs on the other machines, instead of [launch] programs")
        ->type_name("FOLDER")
        ->group(group);
    CLI::Option* const check =
        run.add_flag("--check", a.check,
                     "start nothing: check that each machine answers and has this version of the programs");
    check->group(group)->excludes(attach);
    run.add_option(
           "--print", a.print,
           "start nothing: print systemd units (to files with --out), or the UDP ports between machines")
        ->check(CLI::IsMember({"systemd", "ports"}))
        ->group(group)
        ->excludes(attach)
        ->excludes(check);
}

}  // namespace

Subcommand add_run(CLI::App& app, const std::string& typed) {
    const auto arguments = std::make_shared<RunArguments>();
    arguments->run.command = typed;
    CLI::App* run = app.add_subcommand(
        "run", "run the trials of a session in real time, on one machine or several, and save the results");
    add_real_run_options(*run, *arguments);
    add_clock_options(*run, *arguments);
    add_machine_options(*run, *arguments);
    run->footer(
        "Examples:\n  thimble run delay50 --out out/run\n"
        "  thimble run delay50 --clock virtual --out out/quick\n"
        "  thimble run delay50 --clock lock-step --step --out out/step\n"
        "  thimble run mouse-study --out out/study7 --consent --participant P07\n"
        "  thimble run human --out out/study8 --attach --consent --participant P07 "
        "--age 31\n"
        "  thimble run deploy/sessions/three_machines.toml --check\n"
        "  thimble run session.toml --exec \"ip netns exec {host}\" --programs /opt/thimble/bin\n"
        "  thimble run session.toml --print systemd --out units\n\n"
        "Manual for several machines: docs/machines.md.");
    return {run, [arguments] { return run_nodes(*arguments); }};
}

}  // namespace thimble
