// thimble power: how many subjects and trials a study needs.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/fit/fit.hpp"
#include "study/power/power_report.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct PowerArguments {
    std::string session, from, out;
    PowerOptions power;
    bool json = false, overwrite = false;
};

Provenance provenance_of(const PowerArguments& a, const std::vector<SettingChange>& changes) {
    return made_with({a.session},
                     {a.from,
                      changes,
                      {{"session.seed", std::to_string(a.power.seed)},
                       {"session.delays_s", fmt::format("[{}]", fmt::join(a.power.delays_s, ", "))},
                       {"protocol.experiments", "[3]"},
                       {"protocol.subjects", std::to_string(a.power.pool)},
                       {"protocol.trials_per_modality", std::to_string(a.power.trials)}}});
}

int say_power(PowerArguments a, const std::string& typed) {
    const auto changes = a.from.empty() ? std::vector<SettingChange>{} : read_fit(a.from);
    const SystemSettings settings = load_system_settings(a.session, changes);
    require_virtual_subjects(settings, "power");
    if (!a.out.empty() && !a.overwrite) refuse_other_report(a.out);
    install_stop_signals();
    a.power.stop = &stop_requested();
    const PowerResult result = plan_power(settings, a.power);
    if (!result.complete) {
        spdlog::error("interrupted before the last delay; nothing was written");
        return static_cast<int>(ExitCode::kRunFailed);
    }
    if (a.json) {
        fmt::print("{}\n", json_text(to_json(result, a.power), 2));
    } else {
        for (const ReportTable& table : power_tables(result, a.power)) fmt::print("{}\n", plain_table(table));
    }
    if (a.out.empty()) return static_cast<int>(ExitCode::kOk);
    write_power_report(result, a.power, typed, provenance_of(a, changes), a.out);
    if (!a.json) fmt::print("report: {}\n", (std::filesystem::path(a.out) / "report.html").string());
    return static_cast<int>(ExitCode::kOk);
}

void add_options(CLI::App& power, PowerArguments& a) {
    power.add_option("--delay-s,--delays-s", a.power.delays_s, "delays of the force path, one way")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("S,...")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 10.0));
    power.add_option("--power", a.power.power, "share of studies in which a comparison comes out")
        ->capture_default_str()
        ->check(CLI::Range(0.05, 0.99));
    power
        .add_option("--precision-m", a.power.precision_m,
                    "instead of power: half the interval of a difference in penetration, at most; 95 % for "
                    "all six pairs at once. Time is then judged with --precision-s alone")
        ->check(CLI::PositiveNumber);
    power
        .add_option("--precision-s", a.power.precision_s,
                    "instead of power: the same of a difference in time")
        ->check(CLI::PositiveNumber);
    power.add_option("--trials", a.power.trials, "of each subject and modality; fewer are shown beside")
        ->capture_default_str()
        ->check(CLI::Range(1, 100));
    power.add_option("--from", a.from, "people like the one of this fit, instead of the population")
        ->type_name("FIT");
    power.add_option("--pool", a.power.pool, "virtual subjects that studies are drawn from")
        ->capture_default_str()
        ->check(CLI::Range(10, 100000));
    power.add_option("-s,--seed", a.power.seed, "the same seed gives the same numbers")
        ->capture_default_str();
    power.add_option("-j,--jobs", a.power.jobs, "threads, 0: one per core; the results do not depend on it")
        ->check(CLI::Range(0, 1024));
    power.add_option("-o,--out", a.out, "folder for power.json, report.html and figures/");
    power.add_flag("--overwrite", a.overwrite, "replace an earlier report in that folder");
    power.add_flag("--json", a.json, "print power.json on stdout");
}

}  // namespace

Subcommand add_power(CLI::App& app, const std::string& typed) {
    const auto arguments = std::make_shared<PowerArguments>();
    CLI::App* power = app.add_subcommand("power", "how many subjects and trials a study needs");
    add_session_option(*power, arguments->session,
                       "session file (TOML) or name: its [operator] is the population, its rig and network "
                       "those of the study");
    add_options(*power, *arguments);
    power->footer(
        "Examples:\n  thimble power --delay-s 0.05 --power 0.9 --json\n"
        "  thimble power --delays-s 0,0.02,0.05 --power 0.8 --out out/power\n"
        "  thimble power --precision-m 0.001 --from out/fit\n"
        "docs/fit.md is the manual.");
    return {power, [arguments, typed] { return say_power(*arguments, typed); }};
}

}  // namespace thimble
