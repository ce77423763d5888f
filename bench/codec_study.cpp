// Haptic codecs in virtual time: packets saved against what becomes of the task. The tables of docs/codecs.md.
#include <cmath>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "bench/studies.hpp"
#include "common/runtime/command_line.hpp"
#include "session/records/metrics.hpp"
#include "session/settings/protocol.hpp"
#include "session/virtual/wire_use.hpp"

namespace thimble {
namespace {

struct CodecStudy {
    std::string session;
    std::string modality = "HF";
    std::uint32_t subjects = 5, trials = 2;
    bool rates = false;
    std::vector<std::string> set;
    std::vector<double> delays_s{0, 0.01, 0.025, 0.05, 0.1, 0.2};
};

// Means over the trials of one condition.
struct Cell {
    double needle_per_s = 0, force_per_s = 0;  // packets; of the force, those to the master
    double bytes_per_s = 0;                    // of both
    double mean_m = 0, max_m = 0, time_s = 0;
    double oscillating = 0, completed = 0, trials = 0;

    double packets_per_s() const { return needle_per_s + force_per_s; }
};

void add(Cell& cell, const CountedTrial& trial) {
    const TrialMetrics metrics = measure(trial.record);
    cell.needle_per_s += trial.wire[0].packets_per_s;
    cell.force_per_s += trial.wire[1].packets_per_s;
    cell.bytes_per_s += trial.wire[0].bytes_per_s + trial.wire[1].bytes_per_s;
    if (std::isfinite(metrics.penetration_mean_m)) cell.mean_m += metrics.penetration_mean_m;
    if (std::isfinite(metrics.penetration_max_m)) cell.max_m += metrics.penetration_max_m;
    if (metrics.beeped) cell.time_s += metrics.completion_time_s;
    cell.completed += metrics.beeped ? 1 : 0;
    cell.oscillating += metrics.oscillates ? 1 : 0;
    ++cell.trials;
}

Cell run_cell(const SystemSettings& settings, double delay_s, const CodecStudy& options) {
    Cell cell;
    const Modality modality = *find_modality(options.modality);
    for (std::uint32_t subject = 1; subject <= options.subjects; ++subject) {
        const Protocol protocol = experiment_3(settings, subject, 1);
        for (std::uint32_t trial = 1; trial <= options.trials; ++trial) {
            add(cell,
                run_counted_trial(settings, {protocol.seed, protocol.experiment, subject, trial, modality,
                                             delay_s, draw_fixture_position_m(protocol, subject, trial)}));
        }
    }
    for (double* sum : {&cell.needle_per_s, &cell.force_per_s, &cell.bytes_per_s, &cell.mean_m, &cell.max_m})
        *sum /= cell.trials;
    if (cell.completed > 0) cell.time_s /= cell.completed;
    return cell;
}

double change_percent(double value, double before) { return 100 * (value / before - 1); }

void print_row(std::string_view name, const std::vector<Cell>& cells, const std::vector<Cell>& all,
               bool rates) {
    fmt::print("| {} |", name);
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Cell& cell = cells[i];
        if (rates) {
            fmt::print(" {:.0f} + {:.0f}; {:.1f} kB/s |", cell.needle_per_s, cell.force_per_s,
                       cell.bytes_per_s / 1000);
            continue;
        }
        fmt::print(" {:.1f}; {:+.1f} / {:+.1f}; {:g}/{:g} |",
                   -change_percent(cell.packets_per_s(), all[i].packets_per_s()),
                   change_percent(cell.mean_m, all[i].mean_m), change_percent(cell.max_m, all[i].max_m),
                   cell.completed, cell.oscillating);
    }
    fmt::print("\n");
}

std::vector<Cell> run_row(const SystemSettings& settings, const CodecStudy& options) {
    std::vector<Cell> cells;
    cells.reserve(options.delays_s.size());
    for (const double delay_s : options.delays_s) cells.push_back(run_cell(settings, delay_s, options));
    return cells;
}

CodecSettings both(CodecSettings codec, HapticCodec which) {
    codec.command = codec.force = which;
    return codec;
}

// "codec.weber_fraction=0.2"
std::vector<SettingChange> changes_of(const std::vector<std::string>& texts) {
    std::vector<SettingChange> changes;
    changes.reserve(texts.size());
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        double value = 0;
        if (equals == std::string::npos || !CLI::detail::lexical_cast(text.substr(equals + 1), value))
            throw Error(ExitCode::kUsage, "--set {}: use KEY=NUMBER, e.g. codec.weber_fraction=0.2", text);
        changes.push_back({text.substr(0, equals), value});
    }
    return changes;
}

void print_tables(const CodecStudy& options) {
    const SystemSettings settings = load_system_settings(options.session, changes_of(options.set));
    const CodecSettings base = settings.slave.codec;
    const SystemSettings plain = with_codec(settings, both(base, HapticCodec::kNone));
    const std::vector<Cell> all = run_row(plain, options);
    fmt::print(
        "Packets saved, %; change of mean / maximum penetration, %; completed/oscillating of {}\n\n| codec |",
        all.front().trials);
    for (const double delay_s : options.delays_s) fmt::print(" {:g} ms |", 1e3 * delay_s);
    fmt::print("\n|---|");
    for (std::size_t i = 0; i < all.size(); ++i) fmt::print("---|");
    fmt::print("\n| none, mm |");
    for (const Cell& cell : all)
        fmt::print(" {:.2f} / {:.2f}; {:g}/{:g} |", 1e3 * cell.mean_m, 1e3 * cell.max_m, cell.completed,
                   cell.oscillating);
    fmt::print("\n");
    if (base.used()) print_row("the session's", run_row(settings, options), all, options.rates);
    for (std::size_t i = 1; !base.used() && i < kHapticCodecNames.size(); ++i) {
        const auto codec = both(base, static_cast<HapticCodec>(i));
        print_row(kHapticCodecNames.at(i), run_row(with_codec(settings, codec), options), all, options.rates);
    }
}

}  // namespace

int codec_study(int argc, char** argv) {
    CodecStudy options;
    CLI::App app("Haptic codecs: packets saved against penetration. Prints Markdown.",
                 "thimble-bench codecs");
    app.add_option("session", options.session, "Session file. Its codec is the only one, if it has one.");
    app.add_option("--modality", options.modality, "HF, CF, CCF or VF.")
        ->check(CLI::IsMember({"HF", "CF", "CCF", "VF"}));
    app.add_option("--subjects", options.subjects, "Virtual subjects.")->check(CLI::Range(1, 100000));
    app.add_option("--trials", options.trials, "Trials of each.")->check(CLI::Range(1, 100000));
    app.add_option("--set", options.set, "KEY=NUMBER of the session file.");
    app.add_option("--delays-s", options.delays_s, "Of the force path, one way, s.")
        ->delimiter(',')
        ->check(CLI::Range(0.0, 10.0));
    app.add_flag("--rates", options.rates, "Packets per second instead of shares: needle + force.");
    if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
    print_tables(options);
    return 0;
}

}  // namespace thimble
