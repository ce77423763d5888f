#include "master/operator/operator_parameters.hpp"

#include <cmath>

#include "common/random.hpp"

namespace thimble {
namespace {

// Reads one key over its default.
class Reader {
  public:
    explicit Reader(const ConfigTable& table) : table_(table) {}
    void operator()(const char* key, double& value, double low, double high) const {
        value = table_.number(key, value, low, high);
    }

  private:
    const ConfigTable& table_;
};

void read_hand(const Reader& read, HandMechanics& hand) {
    read("arm_stiffness_N_per_m", hand.arm_stiffness_N_per_m, 50, 3000);
    read("arm_mass_kg", hand.arm_mass_kg, 0.2, 10);
    read("arm_damping_ratio", hand.arm_damping_ratio, 0, 2);
    read("grip_stiffness_N_per_m", hand.grip_stiffness_N_per_m, 100, 10000);
    read("grip_damping_ratio", hand.grip_damping_ratio, 0, 2);
    read("friction_learned_speed_m_per_s", hand.friction_learned_speed_m_per_s, 1e-5, 0.1);
}

void read_noise(const Reader& read, NoiseParameters& noise) {
    read("sway_m", noise.sway_m, 0, 0.01);
    read("sway_correlation_s", noise.sway_correlation_s, 0.01, 100);
    read("tremor_m", noise.tremor_m, 0, 0.005);
    read("tremor_frequency_Hz", noise.tremor_frequency_Hz, 1, 50);
    read("tremor_damping_ratio", noise.tremor_damping_ratio, 0.01, 0.9);
    read("force_noise_fraction", noise.force_noise_fraction, 0, 1);
    read("force_noise_correlation_s", noise.force_noise_correlation_s, 0.002, 100);
    read("speed_noise_fraction", noise.speed_noise_fraction, 0, 1);
    read("speed_noise_correlation_s", noise.speed_noise_correlation_s, 0.002, 100);
}

void read_perception(const Reader& read, PerceptionParameters& perception) {
    read("criterion_N", perception.criterion_N, 0.1, 12);
    read("criterion_cap_fraction", perception.criterion_cap_fraction, 0.05, 1);
    read("full_scale_handle_N", perception.full_scale_handle_N, 0.1, 100);
    read("full_scale_cutaneous_N", perception.full_scale_cutaneous_N, 0.1, 20);
    read("full_scale_bar_N", perception.full_scale_bar_N, 0.1, 100);
    read("lost_N", perception.lost_N, 0, 5);
    read("lost_after_s", perception.lost_after_s, 0, 1);
    read("weber_handle", perception.weber_handle, 0, 1);
    read("weber_cutaneous", perception.weber_cutaneous, 0, 1);
    read("weber_visual", perception.weber_visual, 0, 1);
    read("weber_correlation_s", perception.weber_correlation_s, 0.002, 100);
}

void read_reaction(const Reader& read, ReactionParameters& reaction) {
    read("reaction_handle_s", reaction.handle_s, 0, 2);
    read("reaction_cutaneous_s", reaction.cutaneous_s, 0, 2);
    read("reaction_tactile_s", reaction.tactile_s, 0, 2);
    read("reaction_crossing_s", reaction.crossing_s, 0, 0.5);
    read("reaction_compatibility_s", reaction.compatibility_s, 0, 0.5);
    read("reaction_visual_s", reaction.visual_s, 0, 2);
    read("reaction_auditory_s", reaction.auditory_s, 0, 2);
    read("reaction_trial_variation", reaction.trial_variation, 0, 1);
}

void read_behaviour(const Reader& read, BehaviourParameters& behaviour) {
    read("position_scale", behaviour.position_scale, 0.01, 100);
    read("speed_free_needle_m_per_s", behaviour.speed_free_needle_m_per_s, 0.001, 1);
    read("speed_insert_needle_m_per_s", behaviour.speed_insert_needle_m_per_s, 0.001, 1);
    read("speed_withdraw_needle_m_per_s", behaviour.speed_withdraw_needle_m_per_s, 0.001, 1);
    read("speed_lag_s", behaviour.speed_lag_s, 0.001, 2);
    read("speed_trial_variation", behaviour.speed_trial_variation, 0, 0.3);
    read("brake_s", behaviour.brake_s, 0.001, 2);
    read("refractory_s", behaviour.refractory_s, 0, 5);
    read("relax_s", behaviour.relax_s, 0.01, 5);
    read("slowing", behaviour.slowing, 0.1, 1);
    read("slowest", behaviour.slowest, 0.01, 1);
    read("push_m", behaviour.push_m, 0, 0.02);
    read("push_growth", behaviour.push_growth, 1, 3);
    read("push_s", behaviour.push_s, 0.01, 5);
    read("cocontraction", behaviour.cocontraction, 0, 2);
    read("cocontraction_limit", behaviour.cocontraction_limit, 0, 5);
}

void read_spread(const Reader& read, SubjectSpread& spread) {
    read("spread_speed", spread.speed, 0, 1);
    read("spread_stiffness", spread.stiffness, 0, 1);
    read("spread_criterion", spread.criterion, 0, 1);
    read("spread_sway", spread.sway, 0, 1);
    read("spread_push", spread.push, 0, 1);
    read("spread_reaction", spread.reaction, 0, 1);
    read("spread_reaction_modality", spread.reaction_modality, 0, 1);
}

}  // namespace

OperatorParameters read_operator_parameters(const ConfigTable& table) {
    OperatorParameters parameters;
    const Reader read(table);
    read_hand(read, parameters.hand);
    read_noise(read, parameters.noise);
    read_perception(read, parameters.perception);
    read_reaction(read, parameters.reaction);
    read_behaviour(read, parameters.behaviour);
    parameters.behaviour.recovery = static_cast<Recovery>(table.choice(
        "recovery", static_cast<std::size_t>(parameters.behaviour.recovery), {"approach", "push"}));
    read_spread(read, parameters.spread);
    return parameters;
}

Subject draw_subject(const OperatorParameters& parameters, std::uint64_t study, std::uint32_t experiment,
                     std::uint32_t subject) {
    RandomStream random({study, cohort_of(experiment), subject, 0, Purpose::kSubject});
    const auto around = [&random](double median, double spread) {
        return median * std::exp(spread * random.normal());
    };
    const SubjectSpread& spread = parameters.spread;
    // The order of these draws is part of every published seed: append only.
    Subject drawn;
    drawn.speed_insert_needle_m_per_s =
        around(parameters.behaviour.speed_insert_needle_m_per_s, spread.speed);
    drawn.arm_stiffness_N_per_m = around(parameters.hand.arm_stiffness_N_per_m, spread.stiffness);
    drawn.grip_stiffness_N_per_m = around(parameters.hand.grip_stiffness_N_per_m, spread.stiffness);
    drawn.criterion_N = around(parameters.perception.criterion_N, spread.criterion);
    drawn.sway_m = around(parameters.noise.sway_m, spread.sway);
    drawn.push_m = around(parameters.behaviour.push_m, spread.push);
    drawn.reaction_factor = around(1, spread.reaction);
    for (double& factor : drawn.reaction_modality_factor) factor = around(1, spread.reaction_modality);
    return drawn;
}

}  // namespace thimble
