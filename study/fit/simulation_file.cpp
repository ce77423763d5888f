#include "study/fit/simulation_file.hpp"

#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/csv/csv.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"

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
    make_folder(folder);
    const auto table = folder / kSimulations, plan_file = folder / "plan.txt";
    const bool begun = std::filesystem::exists(table);
    if (begun && if_exists == IfExists::kRefuse)
        throw Error(ExitCode::kUsage,
                    "{}: holds a fit already: go on with --resume, replace it with --overwrite, or name "
                    "another --out",
                    folder.string());
    if (!begun || if_exists == IfExists::kReplace) {
        remove_file(folder / "fit.json");
        write_text_file(plan_file, plan);
        return {};
    }
    std::ifstream file(plan_file, std::ios::binary);
    if (std::string(std::istreambuf_iterator<char>(file), {}) != plan)
        throw Error(ExitCode::kUsage, "{}: holds another fit: name another --out, or say --overwrite",
                    folder.string());
    auto pairs = read_pairs(table);
    keep_lines(table, pairs.size());
    return pairs;
}

}  // namespace

SimulationFile::SimulationFile(const std::filesystem::path& folder, IfExists if_exists,
                               const std::string& plan)
    : earlier_(prepare_fit(folder, if_exists, plan)), file_(folder / kSimulations, if_exists) {
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
