// Experiment 3 by virtual subjects, a slice at a time, so that a page goes on drawing. The table is that of `thimble study`.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "session/records/trial_table.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble {

class PageStudy {
  public:
    PageStudy(std::uint64_t seed, std::uint32_t subjects);

    // Advances by `instants` instants. False once all trials are done.
    bool go_on(unsigned instants);

    std::size_t planned() const { return planned_.size(); }
    // In order, of the trials that are done.
    const std::vector<TrialRow>& rows() const { return rows_; }
    // Their trials.csv, in the place of a file that is there.
    void write_table(const std::filesystem::path& path) const;
    double simulated_s() const { return simulated_s_; }

  private:
    SystemSettings settings_;
    std::vector<TrialConditions> planned_;
    std::unique_ptr<VirtualSession> session_;  // of the running trial
    std::vector<TrialRow> rows_;
    double simulated_s_ = 0;
};

}  // namespace thimble
