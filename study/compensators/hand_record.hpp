// Measures of the hand in a virtual trial, which no record has: rendered stiffness, and distance between needle and
// hand.
#pragma once

#include <vector>

#include "session/records/metrics.hpp"
#include "session/records/trial_record.hpp"
#include "session/virtual/virtual_session.hpp"

namespace thimble {

struct HandMeasures {
    // Mean force of the handle over mean depth of the hand beyond the fixture, over the true stiffness.
    double rendered_stiffness = TrialMetrics::kNone;
    double drift_needle_m = TrialMetrics::kNone;  // mean of |scale x hand - needle|
};

class HandRecord {
  public:
    // One sample of the session that runs.
    void add(VirtualSession& session, const TrajectorySample& sample);
    // In the hold: from the end of arriving to the beep, or to the end of a trial without one.
    HandMeasures measured(const TrialRecord& record, const TrialMetrics& metrics,
                          const SystemSettings& settings) const;

  private:
    struct Sample {
        double time_s, position_hand_m, force_hand_N, position_needle_m;
    };
    std::vector<Sample> samples_;
};

}  // namespace thimble
