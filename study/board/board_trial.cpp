#include <algorithm>

#include "common/error.hpp"
#include "session/settings/protocol.hpp"
#include "session/virtual/virtual_session.hpp"
#include "session/virtual/wire_use.hpp"
#include "study/board/board_row.hpp"
#include "study/compensators/hand_record.hpp"

namespace thimble {
namespace {

constexpr std::size_t kNeedleFlow = 0,
                      kForceFlow = 1;  // of WireUse: to the slave, and back to the handle

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

}  // namespace

BoardTrial run_board_trial(const SystemSettings& settings, std::uint64_t seed, std::uint32_t subject,
                           const std::function<void()>& each_sample) {
    const TrialConditions conditions = conditions_of(settings, seed, subject);
    VirtualSession session(with_force_delay(settings, from_seconds(conditions.delay_s)));
    HandRecord hand;
    double energy_out_J = 0;
    session.session().set_sample_hook([&](const TrajectorySample& sample) {
        hand.add(session, sample);
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
    const HandMeasures felt = hand.measured(record, metrics, settings);
    trial.values[kStiffnessFelt] = felt.rendered_stiffness;
    trial.values[kDrift] = felt.drift_needle_m;
    return trial;
}

}  // namespace thimble
