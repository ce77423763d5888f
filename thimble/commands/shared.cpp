#include "thimble/commands/shared.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "analysis/claims/headline.hpp"
#include "session/records/condition_summary.hpp"

namespace thimble {
namespace {

std::string number_text(double value) { return std::isnan(value) ? "-" : fmt::format("{:.2f}", value); }

void say_condition(std::uint32_t experiment, const ConditionSummary& c) {
    const Statistic& displacement = c.of(Metric::kPeakDisplacement);
    fmt::print(
        "experiment {} {:>6} {:<4} {:3} trials, {:3} oscillate, maximum penetration {:>6} mm, "
        "completion {:>5} s{}\n",
        experiment, delay_text(c.delay_s), to_string(c.modality), c.trials, c.oscillating,
        number_text(1000 * c.of(Metric::kPenetrationMax).mean),
        number_text(c.of(Metric::kCompletionTime).mean),
        displacement.n > 0 ? fmt::format(", peak displacement {} mm", number_text(1000 * displacement.mean))
                           : "");
}

}  // namespace

CLI::Option* add_analysis_option(CLI::App& command, std::string& name) {
    return command
        .add_option(
            "--analysis", name,
            "paper: its tests, chosen by its normality rule; full: also corrections, effect sizes and "
            "confidence intervals")
        ->default_val("full")
        ->check(CLI::IsMember({"paper", "full"}));
}

void add_base_port_option(CLI::App& command, int& base_port) {
    command.add_option("--base-port", base_port, "first UDP port, instead of [network].base_port")
        ->check(CLI::Range(1024, 65536 - static_cast<int>(Port::kCount)))
        ->type_name("PORT");
}

NetworkSettings network_of(const std::string& session_file, int base_port) {
    NetworkSettings network =
        read_network_settings(session_file.empty() ? ConfigFile::empty() : ConfigFile::load(session_file));
    if (base_port != 0) network.base_port = static_cast<std::uint16_t>(base_port);
    return network;
}

std::filesystem::path output_file(const std::filesystem::path& out, const char* name) {
    const std::string end = out.extension().string();
    const bool device = std::filesystem::exists(out) && !std::filesystem::is_directory(out);
    const bool file = device || end == ".csv" || end == ".json" || end == ".html";
    make_folder(file ? out.parent_path() : out);
    return file ? out : out / name;
}

CLI::Option* takes_session(CLI::Option* option) {
    const auto find = [](std::string& given) {
        given = find_session_file(given).string();
        return std::string();
    };
    return option->transform(CLI::Validator(find, "", ""));
}

void say_results(bool json, const std::filesystem::path& folder, const std::vector<TrialRow>& rows) {
    if (json) {
        std::ifstream summary(folder / "summary.json");
        std::cout << summary.rdbuf();
        return;
    }
    for (const std::uint32_t experiment : {1U, 2U, 3U}) {
        for (const ConditionSummary& c : summarize(of_experiment(rows, experiment))) {
            say_condition(experiment, c);
        }
    }
    const auto delayed = [](const TrialRow& row) { return row.conditions.delay_s > 0; };
    if (std::any_of(rows.begin(), rows.end(), delayed)) {
        fmt::print("{}\n", judge_headline(summarize(without_removals(rows))).sentence());
    }
    fmt::print("report: {}\n", (folder / "report.html").string());
}

}  // namespace thimble
