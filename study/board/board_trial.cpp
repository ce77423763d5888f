#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "session/settings/protocol.hpp"
#include "session/virtual/virtual_session.hpp"
#include "session/virtual/wire_use.hpp"
#include "study/board/board_row.hpp"
#include "study/compensators/compensator_study.hpp"

namespace thimble {
namespace {

constexpr std::size_t kNeedleFlow = 0,
                      kForceFlow = 1;  // of kHapticFlows: to the slave, and back to the handle

// The hand itself, which no record holds.
struct HandSample {
    double time_s, position_hand_m, force_hand_N, position_needle_m;
};

TrialConditions conditions_of(const SystemSettings& settings, std::uint64_t seed, std::uint32_t subject) {
    const Protocol protocol = experiment_3(settings, subject, seed);
    return {seed,
            protocol.experiment,
            subject,
            1,
            settings.plan.modalities.front(),
            to_seconds(settings.plan.delays.front()),
            draw_fixture_position_m(protocol, subject, 1),
            false,
            settings.master.control.compensator};
}

// From the end of arriving to the beep, or to the end of a trial without one.
void measure_hand(const std::vector<HandSample>& samples, const TrialRecord& record, double from_s,
                  const SystemSettings& s, BoardTrial& trial) {
    const double surface_hand_m = record.conditions.fixture_position_m / s.master.position_scale;
    double force_N = 0, depth_m = 0, drift_m = 0, count = 0;
    for (const HandSample& sample : samples) {
        if (!(sample.time_s >= from_s) || sample.time_s > record.beep_time_s) continue;
        force_N += sample.force_hand_N;
        depth_m += sample.position_hand_m - surface_hand_m;
        drift_m += std::fabs(s.master.position_scale * sample.position_hand_m - sample.position_needle_m);
        ++count;
    }
    trial.values[kDrift] = count > 0 ? drift_m / count : TrialMetrics::kNone;
    trial.values[kStiffnessFelt] =
        depth_m > 0 ? force_N / depth_m / true_stiffness_hand_N_per_m(s) : TrialMetrics::kNone;
}

}  // namespace

BoardTrial run_board_trial(const SystemSettings& settings, std::uint64_t seed, std::uint32_t subject,
                           const std::function<void()>& each_sample) {
    const TrialConditions conditions = conditions_of(settings, seed, subject);
    VirtualSession session(with_force_delay(settings, from_seconds(conditions.delay_s)));
    std::vector<HandSample> samples;
    double energy_out_J = 0;
    session.session().set_sample_hook([&](const TrajectorySample& sample) {
        samples.push_back({sample.time_s, session.handle().position_hand_m(), session.handle().force_hand_N(),
                           sample.position_needle_m});
        energy_out_J = std::max(energy_out_J, -session.master().energy().energy_in_J());
        if (each_sample) each_sample();
    });
    const TrialRecord& record = session.run(conditions);
    if (const std::string text = plugin_text(session); !text.empty())
        throw Error(ExitCode::kRunFailed, "subject {}: {}", subject, text);
    const TrialMetrics metrics = measure(record);
    BoardTrial trial;
    trial.completed = record.reason == EndReason::kCompleted && metrics.beeped;
    trial.values[kOscillating] = metrics.oscillates ? 1 : 0;
    trial.values[kNotCompleted] = trial.completed ? 0 : 1;
    trial.values[kPenetrationMean] = metrics.penetration_mean_m;
    trial.values[kPenetrationMax] = metrics.penetration_max_m;
    trial.values[kCompletionTime] = trial.completed ? metrics.completion_time_s : TrialMetrics::kNone;
    trial.values[kEnergyOut] = energy_out_J;
    const WireUse wire = wire_use(settings.master.control, session.netem(), record);
    trial.values[kPackets] = wire[kNeedleFlow].packets_per_s + wire[kForceFlow].packets_per_s;
    trial.values[kBytes] = wire[kNeedleFlow].bytes_per_s + wire[kForceFlow].bytes_per_s;
    measure_hand(samples, record, metrics.first_contact_time_s + kHoldSettling_s, settings, trial);
    return trial;
}

}  // namespace thimble
