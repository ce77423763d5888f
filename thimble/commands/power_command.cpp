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
#include "common/runtime/command_line.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "study/fit/fit.hpp"
#include "study/power/power.hpp"
#include "thimble/commands/commands.hpp"
#include "thimble/commands/shared.hpp"

namespace thimble {
namespace {

struct PowerArguments {
    std::string session, from, out;
    std::vector<double> delays_s;
    PowerOptions power;  // as the session and the above have it
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

// As typed, else as the session says, else the paper's. Refuses what the session's network cannot have before a trial is run.
void take_delays(PowerArguments& a, const SystemSettings& settings) {
    refuse_twice("--delays-s", a.delays_s);
    if (!a.delays_s.empty()) {
        a.power.delays_s = a.delays_s;
    } else if (settings.plan.names_delays) {
        a.power.delays_s.clear();
        for (const Duration delay : settings.plan.delays) a.power.delays_s.push_back(to_seconds(delay));
    }
    for (const double delay_s : a.power.delays_s) with_force_delay(settings, from_seconds(delay_s));
}

int say_power(PowerArguments a, const std::string& typed) {
    const auto changes = a.from.empty() ? std::vector<SettingChange>{} : read_fit(a.from);
    const SystemSettings settings = load_system_settings(a.session, changes);
    require_virtual_subjects(settings, "power");
    take_delays(a, settings);
    if (!a.out.empty() && !a.overwrite) refuse_other_report(a.out);
    install_stop_signals();
    a.power.stop = &stop_requested();
    const PowerResult result = plan_power(settings, a.power);
    if (!result.complete) {
        spdlog::error("interrupted: nothing was written; start the command again");
        return static_cast<int>(ExitCode::kRunFailed);
    }
    if (a.json) {
        fmt::print("{}\n", json_text(to_json(result, a.power), 2));
    } else {
        for (const ReportTable& table : power_tables(result, a.power)) fmt::print("{}\n", plain_table(table));
    }
    if (a.out.empty()) return static_cast<int>(ExitCode::kOk);
    write_power_report(result, a.power, typed, provenance_of(a, changes), a.out);
    if (!a.json) fmt::print("results: {}\n", (std::filesystem::path(a.out) / "report.html").string());
    return static_cast<int>(ExitCode::kOk);
}

void add_options(CLI::App& power, PowerArguments& a) {
    power
        .add_option("--delays-s,--delay-s", a.delays_s,
                    "one-way delays of the force path, s (default: the session's, else 0.05)")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("S,...")
        ->check(CLI::Range(0.0, 10.0));
    power.add_option("--power", a.power.power, "power to reach: share of studies that find the difference")
        ->capture_default_str()
        ->check(CLI::Range(0.05, 0.99));
    power
        .add_option(
            "--precision-m", a.power.precision_m,
            "plan for precision instead of power: the half width that the 95 % confidence interval of "
            "a difference in penetration may have, m, for all six pairs at once. Completion time is "
            "then planned only with --precision-s")
        ->check(CLI::PositiveNumber);
    power
        .add_option("--precision-s", a.power.precision_s,
                    "plan for precision instead of power: the same for completion time, s")
        ->check(CLI::PositiveNumber);
    power
        .add_option("--trials", a.power.trials,
                    "trials of each subject and modality; the results also show fewer")
        ->capture_default_str()
        ->check(CLI::Range(1, 100));
    power
        .add_option("--from", a.from,
                    "folder of thimble fit: subjects like this person, instead of the population")
        ->type_name("FIT");
    power
        .add_option("--pool", a.power.pool,
                    "number of virtual subjects to simulate; studies are drawn from them")
        ->capture_default_str()
        ->check(CLI::Range(10, 100000));
    as_session_seed(power.add_option("-s,--seed", a.power.seed,
                                     "seed of all random numbers; the same seed gives the same numbers"))
        ->capture_default_str();
    add_jobs_option(power, a.power.jobs);
    power
        .add_option("-o,--out", a.out,
                    "folder for power.json, report.html and figures/; without it the command only prints the "
                    "tables")
        ->type_name("FOLDER");
    power.add_flag("--overwrite", a.overwrite, "replace earlier results in the folder of --out");
    power.add_flag("--json", a.json, "print power.json on stdout, instead of text");
}

}  // namespace

Subcommand add_power(CLI::App& app, const std::string& typed) {
    const auto arguments = std::make_shared<PowerArguments>();
    CLI::App* power = app.add_subcommand("power", "compute how many subjects and trials a study needs");
    add_session_option(*power, arguments->session,
                       "session: a TOML file, or one that comes with the program. Its [operator] describes "
                       "the population, its other tables the devices and the network of the study");
    add_options(*power, *arguments);
    power->footer(
        "Examples:\n  thimble power --delays-s 0.05 --power 0.9 --json\n"
        "  thimble power --delays-s 0,0.02,0.05 --power 0.8 --out out/power\n"
        "  thimble power --precision-m 0.001 --from out/fit\n"
        "Manual: docs/fit.md");
    return {power, [arguments, typed] { return say_power(*arguments, typed); }};
}

}  // namespace thimble
