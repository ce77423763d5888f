// thimble run: one trial per modality and delay, or a participant's sitting, by real processes over UDP.
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "experiment/commands/commands.hpp"
#include "experiment/commands/say_results.hpp"
#include "experiment/commands/sitting_command.hpp"
#include "experiment/run.hpp"
#include "experiment/sitting/dataset.hpp"

namespace thimble {
namespace {

struct RunArguments {
    std::string config, out, typed;
    int base_port = 0;
    SittingArguments sitting;
    CLI::Option* out_option = nullptr;
    bool overwrite = false, strict_rt = false, attach = false, json = false;
};

// The nodes' programs lie beside this one.
std::filesystem::path program_folder() {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? std::filesystem::path("/usr/bin") : self.parent_path();
}

NetworkSettings network_of(const RunArguments& arguments, const ConfigFile& file) {
    NetworkSettings network = read_network_settings(file);
    if (arguments.base_port != 0) network.base_port = static_cast<std::uint16_t>(arguments.base_port);
    return network;
}

int run_sitting_for_real(const SystemSettings& settings, const RunArguments& arguments,
                         const ConfigFile& file) {
    if (arguments.overwrite) {
        throw Error(ExitCode::kUsage,
                    "a participant's data are never overwritten: name another folder with --out");
    }
    SittingRun run;
    run.config = arguments.config;
    run.programs = program_folder();
    run.out = arguments.out_option->count() > 0 ? arguments.out : "out/dataset";
    run.network = network_of(arguments, file);
    run.attach = arguments.attach;
    run.strict_rt = arguments.strict_rt;
    run.stop = &stop_requested();
    return sit_and_say(settings, arguments.sitting, run, arguments.json);
}

int run_trials_for_real(const RunArguments& arguments) {
    const SystemSettings settings = load_system_settings(arguments.config);
    install_stop_signals();
    const ConfigFile file =
        arguments.config.empty() ? ConfigFile::empty() : ConfigFile::load(arguments.config);
    if (settings.protocol) return run_sitting_for_real(settings, arguments, file);
    refuse_sitting(arguments.sitting, settings);
    refuse_dataset(arguments.out);
    RunOptions options;
    options.config = arguments.config;
    options.programs = program_folder();
    options.out = arguments.out;
    options.command = arguments.typed;
    options.network = network_of(arguments, file);
    options.runtime = read_runtime_settings(file);
    options.overwrite = arguments.overwrite;
    options.strict_rt = arguments.strict_rt;
    options.attach = arguments.attach;
    options.stop = &stop_requested();
    const RunResult result = run_session(settings, options);
    say_results(arguments.json, options.out, result.rows);
    if (result.code != ExitCode::kOk) spdlog::error(result.problem);
    return static_cast<int>(result.code);
}

}  // namespace

Command add_run(CLI::App& app, const std::string& typed) {
    const auto arguments = std::make_shared<RunArguments>();
    RunArguments& a = *arguments;
    a.typed = typed;
    CLI::App* run = app.add_subcommand(
        "run",
        "one trial per modality and delay, or, with a [protocol], one participant's sitting: "
        "five real processes over UDP");
    run->add_option("session", a.config, "session file (TOML), e.g. deploy/sessions/delay50.toml")
        ->required();
    a.out_option = run->add_option("-o,--out", a.out, "folder for the results; of a sitting: out/dataset")
                       ->default_val("out/run");
    run->add_option("--base-port", a.base_port, "first UDP port, instead of [network].base_port")
        ->check(CLI::Range(1024, 65536 - static_cast<int>(Port::kCount)))
        ->type_name("PORT");
    run->add_flag(
        "--attach", a.attach,
        "steer nodes that run already (on one machine or several, see [network]) instead of starting five; "
        "their own session file sets the delay");
    run->add_flag("--overwrite", a.overwrite, "replace earlier results in that folder");
    run->add_flag("--strict-rt", a.strict_rt, "exit with 4 if a node missed too many deadlines");
    run->add_flag("--json", a.json, "print summary.json on stdout");
    add_sitting_options(*run, a.sitting);
    run->footer(
        "Examples:\n  thimble run deploy/sessions/delay50.toml --out out/run\n"
        "  thimble run deploy/sessions/human.toml --out out/study7 --attach --consent --participant P07 "
        "--age 31");
    return {run, [arguments] { return run_trials_for_real(*arguments); }};
}

}  // namespace thimble
