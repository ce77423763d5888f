#include "study/fit/simulation_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/csv/csv.hpp"
#include "common/text_file.hpp"
#include "study/planned_table.hpp"

namespace thimble {
namespace {

constexpr std::size_t kPairFeatures = kFeatureNames.size();
constexpr const char* kSimulations = "simulations.csv";

std::vector<std::string> pair_columns() {
    std::vector<std::string> names;
    for (const char* trial : {"first", "second"})
        for (const std::string_view feature : kFeatureNames)
            names.push_back(fmt::format("{}_{}", trial, feature));
    return names;
}

std::vector<std::optional<SimulatedPair>> read_pairs(const std::filesystem::path& path) {
    const std::vector<std::string> names = pair_columns();
    const std::vector<std::string_view> views(names.begin(), names.end());
    CsvReader reader(path, views, ',', 0, LastLine::kMayBeTorn);
    std::vector<std::optional<SimulatedPair>> pairs;
    while (reader.next()) {
        auto& pair = pairs.emplace_back();
        if (reader.field(0).text.empty()) continue;
        pair.emplace();
        for (std::size_t k = 0; k < kPairFeatures; ++k) {
            pair->first[k] = reader.field(k).number();
            pair->second[k] = reader.field(kPairFeatures + k).number();
        }
    }
    return pairs;
}

// Reads the pairs of an earlier fit in this folder. The plan says whether it was the same fit.
std::vector<std::optional<SimulatedPair>> prepare_fit(const std::filesystem::path& folder, IfExists if_exists,
                                                      const std::string& plan) {
    const auto table = folder / kSimulations;
    open_plan(table, folder / "plan.txt", "fit", plan, if_exists, {"fit.json"});
    auto pairs = read_pairs(table);
    keep_lines(table, pairs.size());
    return pairs;
}

}  // namespace

SimulationFile::SimulationFile(const std::filesystem::path& folder, IfExists if_exists,
                               const std::string& plan)
    : earlier_(prepare_fit(folder, if_exists, plan)), file_(folder / kSimulations, IfExists::kContinue) {
    if (file_.is_new()) file_.write(fmt::format("{}\n", fmt::join(pair_columns(), ",")));
}

void SimulationFile::append(const std::optional<SimulatedPair>& pair) {
    std::string line = pair
                           ? fmt::format("{},{}\n", fmt::join(pair->first, ","), fmt::join(pair->second, ","))
                           : std::string(2 * kPairFeatures - 1, ',') + "\n";
    file_.write(line);
    file_.flush();
}

}  // namespace thimble
