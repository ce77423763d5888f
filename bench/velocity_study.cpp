// thimble-bench velocity: the velocity estimators against known needles, and what each does to the system.
#include <filesystem>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/studies.hpp"
#include "bench/velocity/velocity_report.hpp"
#include "common/csv/csv_file.hpp"
#include "common/error.hpp"
#include "common/process/progress.hpp"
#include "common/runtime/command_line.hpp"

namespace thimble {
namespace {

struct Candidate {
    std::string setting;
    VelocitySettings settings;
};

std::vector<Candidate> candidates(const NeedleEncoder& encoder) {
    VelocitySettings base;
    base.quantum_m = encoder.quantum_m;
    base.sample_period = encoder.period;
    std::vector<Candidate> list;
    const auto add = [&](VelocityMethod method, const std::string& setting, auto change) {
        Candidate candidate{setting, base};
        candidate.settings.method = method;
        change(candidate.settings);
        list.push_back(candidate);
    };
    add(VelocityMethod::kRaw, "", [](VelocitySettings&) {});
    for (const int ms : {2, 5, 10, 20}) {
        add(VelocityMethod::kLowPass, fmt::format("{} ms", ms),
            [&](VelocitySettings& s) { s.time_constant = std::chrono::milliseconds{ms}; });
    }
    for (const int ms : {5, 10, 20, 40}) {
        add(VelocityMethod::kWindowed, fmt::format("{} ms", ms),
            [&](VelocitySettings& s) { s.window = std::chrono::milliseconds{ms}; });
    }
    for (const FoawFit fit : {FoawFit::kBest, FoawFit::kEnd}) {
        for (const int ms : {10, 15, 20, 40}) {
            add(VelocityMethod::kFoaw, fmt::format("{} {} ms", fit == FoawFit::kBest ? "best" : "end", ms),
                [&](VelocitySettings& s) {
                    s.fit = fit;
                    s.window = std::chrono::milliseconds{ms};
                });
        }
    }
    for (const double noise : {1e-2, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6}) {
        add(VelocityMethod::kKalman, fmt::format("{:.0e}", noise),
            [&](VelocitySettings& s) { s.acceleration_noise_m2_per_s3 = noise; });
    }
    return list;
}

bool is_default(const VelocitySettings& s) {
    const VelocitySettings d;
    if (s.method != d.method) return false;
    switch (s.method) {
        case VelocityMethod::kLowPass:
            return s.time_constant == d.time_constant;
        case VelocityMethod::kWindowed:
            return s.window == d.window;
        case VelocityMethod::kFoaw:
            return s.window == d.window && s.fit == d.fit;
        case VelocityMethod::kKalman:
            return s.acceleration_noise_m2_per_s3 == d.acceleration_noise_m2_per_s3;
        case VelocityMethod::kRaw:
            break;
    }
    return true;
}

VelocityRow measure(const Candidate& candidate, const VelocityStudy& study) {
    VelocityRow row;
    row.method = kVelocityMethodNames[static_cast<std::size_t>(candidate.settings.method)];
    row.setting = candidate.setting;
    row.is_default = is_default(candidate.settings);
    row.quality = measure_quality(candidate.settings, study);
    row.tremor = measure_tremor(candidate.settings, study);
    row.press = measure_presses(candidate.settings, study);
    row.entry = measure_entry(candidate.settings, study);
    row.fixture = fixture_effect(row.tremor);
    row.cost_s = measure_cost_s(candidate.settings, study);
    return row;
}

// Raw differences of a position without quantum: what the sampling alone does.
VelocityRow measure_ideal(VelocityStudy study) {
    study.encoder.quantum_m = 1e-12;
    VelocitySettings settings;
    settings.method = VelocityMethod::kRaw;
    VelocityRow row = measure({"", settings}, study);
    row.method = "ideal";
    row.is_default = false;
    return row;
}

struct VelocityOptions {
    std::filesystem::path out = "out/velocity";
    double jitter_s = 0;
    bool quick = false;
    VelocityStudy study;
};

void run_study(const VelocityOptions& options) {
    std::error_code failure;
    std::filesystem::create_directories(options.out, failure);  // what went wrong shows when writing
    CsvFile csv(options.out / "velocity.csv", IfExists::kReplace);
    Progress progress;
    std::vector<VelocityRow> rows{measure_ideal(options.study)};
    const std::vector<Candidate> list = candidates(options.study.encoder);
    for (const Candidate& candidate : list) {
        rows.push_back(measure(candidate, options.study));
        progress.show(fmt::format("{} of {}: {} {}", rows.size() - 1, list.size(), rows.back().method,
                                  rows.back().setting),
                      rows.size() % 5 == 0);
    }
    csv.write(velocity_csv(rows));
    csv.flush();
    draw_velocity_figure(rows, options.out);
    progress.say(fmt::format("{}: velocity.csv, velocity.svg", options.out.string()));
    fmt::print("{}", velocity_table(rows));
}

}  // namespace

int velocity_study(int argc, char** argv) {
    VelocityOptions options;
    CLI::App app("Velocity estimators: noise against lag, and what each does to puncture and fixture force.",
                 "thimble-bench velocity");
    app.add_option("-o,--out", options.out, "folder for velocity.csv and velocity.svg, replaced")
        ->capture_default_str();
    app.add_option("-s,--seed", options.study.seed, "the same seed gives the same velocity.csv")
        ->capture_default_str();
    app.add_option("--jitter", options.jitter_s, "sampling jitter in s, uniform, either way")
        ->check(CLI::Range(0.0, 0.0004))
        ->capture_default_str();
    app.add_flag("--quick", options.quick, "1 repeat instead of 32: for a look, not for a table");
    app.footer("Example:\n  thimble-bench velocity --seed 1 --out out/velocity");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    options.study.encoder.jitter = from_seconds(options.jitter_s);
    if (options.quick) options.study.repeats = 1;
    run_study(options);
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace thimble
