// How many subjects a study needs: a pool of virtual subjects does its trials once, and studies are drawn from the pool. Each is
// judged as a finding is (comparisons.hpp): signed ranks of the subjects' own differences, all pairs of a measure at once.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "analysis/report/report.hpp"
#include "analysis/statistics/named_values.hpp"
#include "analysis/text/html.hpp"
#include "common/csv/csv_file.hpp"
#include "session/records/condition_summary.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {

inline constexpr std::size_t kMostPowerSubjects = 100;

struct PowerOptions {
    std::vector<double> delays_s{0.05};
    double power = 0.9;  // share of studies in which the comparison comes out
    // Half the interval (of all pairs of a measure at once, 95 %), instead of power: then only these measures are judged.
    std::optional<double> precision_m, precision_s;
    std::optional<double> precision_of(Metric metric) const {
        return metric == Metric::kCompletionTime ? precision_s : precision_m;
    }
    bool judges(Metric metric) const { return !(precision_m || precision_s) || precision_of(metric); }
    std::uint32_t pool = 60;      // virtual subjects
    std::uint32_t trials = 6;     // of each subject and modality, at most
    std::uint32_t studies = 200;  // drawn for each number of subjects
    std::uint64_t seed = 1;
    unsigned jobs = 0;
    const std::atomic<bool>* stop = nullptr;
};

struct PowerComparison {
    Metric metric = Metric::kPenetrationMean;
    std::string first, second;
    double delay_s = 0;
    std::optional<double>
        difference;                // in the pool, SI: first minus second; nothing if no subject has a value
    std::size_t with_a_value = 0;  // of the pool: subjects whose trials, all of them, give a difference
    // By trials per modality: subjects needed; nothing if kMostPowerSubjects are not enough.
    std::map<std::uint32_t, std::optional<std::size_t>> subjects;
    std::vector<std::pair<std::size_t, double>> curve;  // subjects and power, with all trials
};

struct PowerResult {
    std::vector<PowerComparison> comparisons;
    bool complete = true;  // false: stopped
};

// One pair: the difference of each subject of the pool, NaN where one has none, and how drawn studies are judged.
struct PowerPair {
    NamedValues differences;
    std::size_t family = 1;
    std::optional<double> precision{};  // half the interval, SI
};

// Share of the drawn studies of `subjects` people in which the pair comes out; with a precision, in which the interval is as narrow.
// A study judges the subjects with a difference. One with too few of them does not come out.
double share_of_studies(const PowerPair& pair, std::size_t subjects, const PowerOptions& options);

PowerResult plan_power(const SystemSettings& settings, const PowerOptions& options);

// "HF - CF, maximum penetration, 50 ms"
std::string name_of(const PowerComparison& comparison);

// The output of thimble power: tables, JSON, and a page with curves.

// A table per delay: subjects needed for each comparison, by trials per modality.
std::vector<ReportTable> power_tables(const PowerResult& result, const PowerOptions& options);
// An object with what was asked, and `comparisons`; null where kMostPowerSubjects are not enough, or no
// subject has a difference.
nlohmann::ordered_json to_json(const PowerResult& result, const PowerOptions& options);
// Throws Error (usage) if `out` holds a report or an earlier power.json.
void refuse_other_report(const std::filesystem::path& out);
// The same unless this table is there, which says that the report is the command's own, or the report may be replaced.
void refuse_other_report(const std::filesystem::path& table, IfExists if_exists);
// Writes power.json, report.html and figures/, in place of earlier ones. Throws Error where a file cannot be written.
void write_power_report(const PowerResult& result, const PowerOptions& options, const std::string& command,
                        const Provenance& made_with, const std::filesystem::path& out);

}  // namespace thimble
