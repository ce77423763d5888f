#include "common/control/built_in_controllers.hpp"

namespace thimble {

const thimble_controller* controller_of(const ControlSettings& settings) {
    switch (settings.compensator) {
        case Compensator::kNone:
            return nullptr;
        case Compensator::kScaled:
            return &scaled_controller();
        case Compensator::kPassivity:
            return &passivity_controller();
        case Compensator::kMemorylessBound:
            return &memoryless_bound_controller();
        case Compensator::kLeastConservative:
            return &least_conservative_controller();
        case Compensator::kTwoLayer:
            return &two_layer_controller();
        case Compensator::kLocalFixture:
            return &local_fixture_controller();
        case Compensator::kWave:
            return &wave_controller();
        case Compensator::kTwoPort:
            return &two_port_controller();
        case Compensator::kAdaptiveFixture:
            return &adaptive_fixture_controller();
        case Compensator::kPredictedShare:
            return &predicted_share_controller();
        case Compensator::kFourChannel:
            return &four_channel_controller();
        case Compensator::kPlugin:
            return settings.plugin.table;
    }
    return nullptr;
}

bool has_two_ends(const ControlSettings& settings) {
    const thimble_controller* table = controller_of(settings);
    return table != nullptr && (table->capabilities & THIMBLE_BOTH_ENDS) != 0;
}

std::vector<double> values_of(const ControlSettings& s) {
    switch (s.compensator) {
        case Compensator::kScaled:
            return {s.share};
        case Compensator::kPassivity:
        case Compensator::kTwoPort:
            return {s.most_damping_Ns_per_m};
        case Compensator::kMemorylessBound:
        case Compensator::kLeastConservative:
            return {s.device_damping_Ns_per_m};
        case Compensator::kTwoLayer:
            return {s.device_damping_Ns_per_m, s.tank.level_J, s.tank.damping_Ns_per_m};
        case Compensator::kLocalFixture:
        case Compensator::kAdaptiveFixture:
            return {s.local.stiffness_N_per_m, s.local.stiffest_N_per_m, s.local.memory,
                    s.local.shift_m_per_s};
        case Compensator::kPredictedShare:
            return {s.predicted_damping_Ns_per_m, s.predicted_stiffness_N_per_m, s.predicted_margin};
        case Compensator::kFourChannel:
            return {s.local.stiffness_N_per_m, s.local.stiffest_N_per_m, s.local.memory,
                    s.local.shift_m_per_s, s.coupling_N_per_m};
        case Compensator::kWave:
            return {s.wave_impedance_Ns_per_m, s.wave_slave_damping_Ns_per_m,
                    static_cast<double>(s.channel.reconstruction), static_cast<double>(s.channel.repeats),
                    to_seconds(s.jitter)};
        default:
            return s.plugin.values;
    }
}

}  // namespace thimble
