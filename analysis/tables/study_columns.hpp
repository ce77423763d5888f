// The data of one experiment's tests: per measure a table of subjects x modalities. Each subject's trials are
// averaged first, as in the paper. Where the rows have HF with several delay compensators, each is a column of its
// own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/statistics/sample_table.hpp"
#include "session/records/condition_summary.hpp"
#include "session/records/trial_table.hpp"

namespace thimble {

class StudyColumns {
  public:
    struct Condition {
        Modality modality;
        Compensator compensator;
        std::string name;
    };

    // Of the rows those of this experiment that ran to their end, at this delay. Without one: with the experiment's own,
    // which is any in experiment 3 and none in the others (the control trials of experiment 3 are not its own).
    StudyColumns(const std::vector<TrialRow>& rows, std::uint32_t experiment,
                 std::optional<double> delay_s = std::nullopt);

    bool empty() const { return rows_.empty(); }
    const std::vector<TrialRow>& rows() const { return rows_; }
    std::uint32_t experiment() const { return experiment_; }
    const std::vector<std::uint32_t>& subjects() const { return subjects_; }  // ascending
    // In the order of the columns, also those without trials.
    const std::vector<Condition>& conditions() const { return conditions_; }
    std::vector<TrialRow> rows_of(const Condition& condition) const;

    // Each subject's mean per modality, columns in the order of kModalities (HF's compensators in the order of kCompensatorNames, "HF" and
    // "HF+wave"), subjects as above; NaN: no trial of that modality came to that measure.
    std::vector<NamedValues> subject_means(Metric metric) const;
    // Columns as above, SI. A subject without a value in a modality (no trial of it came to
    // that measure) is left out of all: see `dropped`. Throws Error (data) if no subject has all.
    CompleteRows table(Metric metric) const;
    // One modality (HF: the first of its columns), a value per subject in ascending order, NaN where there is none.
    NamedValues column(Metric metric, Modality modality) const;
    // Each trial a value of its own, in groups by modality: experiment 2, where no subject meets all of them.
    std::vector<NamedValues> groups(Metric metric) const;

  private:
    bool is_of(const TrialRow& row, const Condition& condition) const;
    NamedValues column(Metric metric, const Condition& condition) const;

    std::uint32_t experiment_;
    std::vector<Condition> conditions_;
    std::vector<TrialRow> rows_;
    std::vector<std::uint32_t> subjects_;  // ascending
};

// The measures that the paper reports of an experiment: penetration and time; of experiment 2 peak displacement.
std::vector<Metric> measures_of(std::uint32_t experiment);

}  // namespace thimble
