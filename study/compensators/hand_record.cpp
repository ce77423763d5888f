#include "study/compensators/hand_record.hpp"

#include <cmath>

#include "study/compensators/compensator_study.hpp"

namespace thimble {

void HandRecord::add(VirtualSession& session, const TrajectorySample& sample) {
    samples_.push_back({sample.time_s, session.handle().position_hand_m(), session.handle().force_hand_N(),
                        sample.position_needle_m});
}

HandMeasures HandRecord::measured(const TrialRecord& record, const TrialMetrics& metrics,
                                  const SystemSettings& s) const {
    const double from_s = metrics.first_contact_time_s + kHoldSettling_s;
    const double surface_hand_m = record.conditions.fixture_position_m / s.master.position_scale;
    double force_N = 0, depth_m = 0, drift_m = 0, count = 0;
    for (const Sample& sample : samples_) {
        if (!(sample.time_s >= from_s) || sample.time_s > record.beep_time_s) continue;
        force_N += sample.force_hand_N;
        depth_m += sample.position_hand_m - surface_hand_m;
        drift_m += std::fabs(s.master.position_scale * sample.position_hand_m - sample.position_needle_m);
        ++count;
    }
    HandMeasures measures;
    if (count == 0) return measures;
    measures.drift_needle_m = drift_m / count;
    if (depth_m > 0) measures.rendered_stiffness = force_N / depth_m / true_stiffness_hand_N_per_m(s);
    return measures;
}

}  // namespace thimble
