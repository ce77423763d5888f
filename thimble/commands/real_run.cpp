#include "thimble/commands/real_run.hpp"

#include <system_error>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "session/observe/plotjuggler.hpp"
#include "session/participant/dataset.hpp"
#include "session/play/order_lines.hpp"
#include "session/play/play_starter.hpp"
#include "session/play/session_observer.hpp"
#include "thimble/commands/build_checks.hpp"
#include "thimble/commands/run.hpp"
#include "thimble/commands/say_results.hpp"

namespace thimble {
namespace {

ConfigFile file_of(const RealRunArguments& arguments) {
    return arguments.config.empty() ? ConfigFile::empty() : ConfigFile::load(arguments.config);
}

// Faults that otherwise only thimble-visual's log would show, after the folder is written.
void check_screen(const SystemSettings& settings, const std::shared_ptr<NodeStarter>& starter) {
    const bool window = settings.visual.window || settings.plan.kind == SubjectKind::kHuman;
    if (starter && window && starter->machine(Role::kVisual).empty()) check_window(program_folder());
    for (const std::string& warning : named_modalities(settings.instructions)) spdlog::warn(warning);
}

int run_participant_for_real(const RealRunArguments& arguments, const SystemSettings& settings,
                             const std::shared_ptr<NodeStarter>& starter) {
    if (arguments.overwrite) {
        throw Error(ExitCode::kUsage,
                    "a participant's data are never overwritten: name another folder with --out");
    }
    ParticipantRun run;
    run.starter = starter;
    run.out = arguments.out_option->count() > 0 ? arguments.out : "out/dataset";
    run.network = network_of(arguments);
    run.strict_rt = arguments.strict_rt;
    run.stop = &stop_requested();
    run.check_screen = [&] { check_screen(settings, starter); };
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
    return run_participant_and_say(settings, arguments.participant, run, arguments.json);
}

}  // namespace

void add_real_run_options(CLI::App& command, const std::string& default_out, RealRunArguments& a) {
    command.add_option("session", a.config, "session file (TOML), e.g. deploy/sessions/delay50.toml")
        ->required();
    a.out_option =
        command
            .add_option("-o,--out", a.out, "folder for the results; of a participant session: out/dataset")
            ->default_val(default_out);
    command.add_option("--base-port", a.base_port, "first UDP port, instead of [network].base_port")
        ->check(CLI::Range(1024, 65536 - static_cast<int>(Port::kCount)))
        ->type_name("PORT");
    command.add_flag("--overwrite", a.overwrite, "replace earlier results in that folder");
    command.add_flag("--strict-rt", a.strict_rt, "exit with 4 if a node missed too many deadlines");
    command.add_flag("--monitor", a.monitor,
                     "feed an experimenter's view and take its orders (ports 23 and 24 of docs/protocol.md)");
    command
        .add_option("--plotjuggler", a.plotjuggler,
                    "send what the session knows, undelayed, to PlotJuggler's UDP server (JSON, 100 Hz; its "
                    "port is 9870)")
        ->type_name("[HOST:]PORT");
    command.add_flag("--json", a.json, "print summary.json on stdout");
    add_participant_options(command, a.participant);
}

std::filesystem::path program_folder() {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? std::filesystem::path("/usr/bin") : self.parent_path();
}

NetworkSettings network_of(const RealRunArguments& arguments) {
    NetworkSettings network = read_network_settings(file_of(arguments));
    if (arguments.base_port != 0) network.base_port = static_cast<std::uint16_t>(arguments.base_port);
    return network;
}

int run_for_real(const RealRunArguments& arguments, const SystemSettings& settings,
                 const std::shared_ptr<NodeStarter>& starter) {
    install_stop_signals(QuitSignal::kStopsEverything);
    if (starter) check_build(settings);
    const NetworkSettings network = network_of(arguments);
    require_protection(network);
    warn_if_unprotected(network);
    if (settings.protocol) return run_participant_for_real(arguments, settings, starter);
    refuse_participant_options(arguments.participant, settings);
    refuse_dataset(arguments.out);
    check_screen(settings, starter);
    RunOptions options;
    options.starter = starter;
    options.out = arguments.out;
    options.command = arguments.typed;
    options.network = network;
    options.runtime = read_runtime_settings(file_of(arguments));
    options.overwrite = arguments.overwrite;
    options.strict_rt = arguments.strict_rt;
    options.stop = &stop_requested();
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
            with_plotjuggler(options.make_observer, plotjuggler_at(arguments.plotjuggler, network));
    const RunResult result = run_session(settings, options);
    say_results(arguments.json, options.out, result.rows);
    if (result.code != ExitCode::kOk) spdlog::error(result.problem);
    return static_cast<int>(result.code);
}

}  // namespace thimble
