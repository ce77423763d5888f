// thimble run: one trial per modality and delay, real processes over UDP.
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
#include "experiment/run.hpp"

namespace thimble {
namespace {

struct RunArguments {
    std::string config, out, typed;
    int base_port = 0;
    bool overwrite = false, strict_rt = false, attach = false, json = false;
};

// The nodes' programs lie beside this one.
std::filesystem::path program_folder() {
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? std::filesystem::path("/usr/bin") : self.parent_path();
}

int run_trials_for_real(const RunArguments& arguments) {
    const SystemSettings settings = load_system_settings(arguments.config);
    install_stop_signals();
    const ConfigFile file =
        arguments.config.empty() ? ConfigFile::empty() : ConfigFile::load(arguments.config);
    RunOptions options;
    options.config = arguments.config;
    options.programs = program_folder();
    options.out = arguments.out;
    options.command = arguments.typed;
    options.network = read_network_settings(file);
    options.runtime = read_runtime_settings(file);
    if (arguments.base_port != 0) options.network.base_port = static_cast<std::uint16_t>(arguments.base_port);
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
    CLI::App* run =
        app.add_subcommand("run", "one trial per modality and delay, five real processes over UDP");
    run->add_option("session", a.config, "session file (TOML), e.g. deploy/sessions/delay50.toml")
        ->required();
    run->add_option("-o,--out", a.out, "folder for the results")->default_val("out/run");
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
    run->footer("Example:\n  thimble run deploy/sessions/delay50.toml --out out/run");
    return {run, [arguments] { return run_trials_for_real(*arguments); }};
}

}  // namespace thimble
