// simulations.csv of a fit: a line per pair of simulated trials, kept when a fit is interrupted.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/csv/csv_file.hpp"
#include "study/fit/operator_model.hpp"

namespace thimble {

class SimulationFile {
  public:
    // kContinue reads the pairs of an earlier fit and cuts off a half-written line. Throws Error (usage) where that fit was another one:
    // its plan.txt differs from `plan`.
    SimulationFile(const std::filesystem::path& folder, IfExists if_exists, const std::string& plan);

    // Without their traits.
    const std::vector<std::optional<SimulatedPair>>& earlier() const { return earlier_; }
    void append(const std::optional<SimulatedPair>& pair);
    void close() { file_.sync(); }

  private:
    std::vector<std::optional<SimulatedPair>> earlier_;
    CsvFile file_;
};

}  // namespace thimble
