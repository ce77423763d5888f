#include "master/operator/operator_parameters.hpp"

#include "common/math/portable.hpp"
#include "common/random.hpp"

namespace thimble {
namespace {

void read_hand(const ConfigTable& table, HandMechanics& hand) {
    table.read("arm_stiffness_N_per_m", hand.arm_stiffness_N_per_m, 50, 3000,
               "Stiffness of forearm and wrist.");
    table.read("arm_mass_kg", hand.arm_mass_kg, 0.2, 10, "Mass of hand and forearm.");
    table.read("arm_damping_ratio", hand.arm_damping_ratio, 0, 2, "Damping ratio of the arm.");
    table.read("grip_stiffness_N_per_m", hand.grip_stiffness_N_per_m, 100, 10000,
               "Stiffness of the pinch grip.");
    table.read("grip_damping_ratio", hand.grip_damping_ratio, 0, 2, "Damping ratio of the grip.");
    table.read("friction_learned_speed_m_per_s", hand.friction_learned_speed_m_per_s, 1e-5, 0.1,
               "Speed scale on which the learned compensation of friction changes sign.");
    table.read("load_stiffness_per_N", hand.load_stiffness_per_N, 0, 2,
               "Relative increase of arm and grip stiffness per newton of arm force; 0: off.");
    table.read("load_damping_per_N", hand.load_damping_per_N, 0, 2,
               "Relative increase of arm and grip damping per newton of arm force; 0: off.");
    table.read("load_lag_s", hand.load_lag_s, 0.001, 1, "Time constant of both increases.");
}

void read_reflex(const ConfigTable& table, ReflexParameters& reflex) {
    table.read("reflex_gain", reflex.gain, 0, 2,
               "Part of an arm stretch that the long-latency reflex cancels; 0: off.");
    table.read("reflex_latency_s", reflex.latency_s, 0.01, 0.2, "Time from the stretch to the reflex.");
    table.read("reflex_window_s", reflex.window_s, 0.01, 0.2, "Stretches older than this cause no reflex.");
}

void read_noise(const ConfigTable& table, NoiseParameters& noise) {
    table.read("sway_m", noise.sway_m, 0, 0.01, "Slow drift of the hand, rms.");
    table.read("sway_correlation_s", noise.sway_correlation_s, 0.01, 100, "Correlation time of the drift.");
    table.read("tremor_m", noise.tremor_m, 0, 0.005, "Tremor of the hand, rms.");
    table.read("tremor_frequency_Hz", noise.tremor_frequency_Hz, 1, 50, "Frequency of the tremor.");
    table.read("tremor_damping_ratio", noise.tremor_damping_ratio, 0.01, 0.9,
               "Damping ratio of the tremor: smaller is a narrower band.");
    table.read("force_noise_fraction", noise.force_noise_fraction, 0, 1,
               "Noise of the arm force, as a fraction of it.");
    table.read("force_noise_correlation_s", noise.force_noise_correlation_s, 0.002, 100,
               "Correlation time of the force noise.");
    table.read("speed_noise_fraction", noise.speed_noise_fraction, 0, 1,
               "Noise of the insertion speed within a trial, as a fraction of it.");
    table.read("speed_noise_correlation_s", noise.speed_noise_correlation_s, 0.002, 100,
               "Correlation time of the speed noise.");
}

void read_perception(const ConfigTable& table, PerceptionParameters& perception) {
    table.read("criterion_N", perception.criterion_N, 0.1, 12,
               "Force above which the subject decides that the fixture is reached.");
    table.read("criterion_cap_fraction", perception.criterion_cap_fraction, 0.05, 1,
               "Upper limit of that force, as a fraction of the display's full scale.");
    table.read("full_scale_handle_N", perception.full_scale_handle_N, 0.1, 100,
               "Full scale of the handle that the operator assumes.");
    table.read("full_scale_cutaneous_N", perception.full_scale_cutaneous_N, 0.1, 20,
               "Full scale of the fingertip device; equal to [cutaneous] force_limit_N.");
    table.read("full_scale_bar_N", perception.full_scale_bar_N, 0.1, 100,
               "Full scale of the bar; equal to [visual] bar_full_scale_N.");
    table.read("lost_N", perception.lost_N, 0, 5, "Smaller forces are not felt or seen.");
    table.read("lost_after_s", perception.lost_after_s, 0, 1,
               "Contact counts as lost after this time below lost_N.");
    table.read("weber_handle", perception.weber_handle, 0, 1, "Relative noise of the perceived force, HF.");
    table.read("weber_cutaneous", perception.weber_cutaneous, 0, 1,
               "Relative noise of the perceived force, CF and CCF.");
    table.read("weber_visual", perception.weber_visual, 0, 1,
               "Relative noise of the perceived bar length, VF.");
    table.read("weber_correlation_s", perception.weber_correlation_s, 0.002, 100,
               "Correlation time of these noises.");
}

void read_reaction(const ConfigTable& table, ReactionParameters& reaction) {
    table.read("reaction_handle_s", reaction.handle_s, 0, 2, "Reaction time in HF.");
    table.read("reaction_cutaneous_s", reaction.cutaneous_s, 0, 2, "Reaction time in CF.");
    table.read("reaction_tactile_s", reaction.tactile_s, 0, 2,
               "Reaction time of touch; CCF is the sum of this and the next two.");
    table.read("reaction_crossing_s", reaction.crossing_s, 0, 0.5, "Extra time from one hand to the other.");
    table.read("reaction_compatibility_s", reaction.compatibility_s, 0, 0.5,
               "Extra time if the hand that acts is not the hand that feels.");
    table.read("reaction_visual_s", reaction.visual_s, 0, 2,
               "Reaction time in VF; also to the sight of the needle at the tissue.");
    table.read("reaction_auditory_s", reaction.auditory_s, 0, 2, "Reaction time to the beep.");
    table.read("reaction_trial_variation", reaction.trial_variation, 0, 1,
               "Coefficient of variation between reactions.");
    table.read("switch_modality_s", reaction.switch_modality_s, 0, 0.5,
               "Extra time of the first reaction to the fixture if the previous trial used another sense.");
    table.read("switch_hand_s", reaction.switch_hand_s, 0, 0.5,
               "Extra time of that reaction if another hand feels than before (CCF).");
}

void read_behaviour(const ConfigTable& table, BehaviourParameters& behaviour) {
    table.read("position_scale", behaviour.position_scale, 0.01, 100,
               "Needle movement divided by hand movement; equal to [master] position_scale. The next three "
               "speeds are of the needle.");
    table.read("speed_free_needle_m_per_s", behaviour.speed_free_needle_m_per_s, 0.001, 1,
               "Speed outside the tissue.");
    table.read("speed_insert_needle_m_per_s", behaviour.speed_insert_needle_m_per_s, 0.001, 1,
               "Speed of the insertion in the tissue.");
    table.read("speed_withdraw_needle_m_per_s", behaviour.speed_withdraw_needle_m_per_s, 0.001, 1,
               "Speed of the withdrawal.");
    table.read("speed_lag_s", behaviour.speed_lag_s, 0.001, 2,
               "Time constant with which the speed follows the intention.");
    table.read("speed_trial_variation", behaviour.speed_trial_variation, 0, 0.3,
               "Variation of the insertion speed between trials.");
    table.read("brake_s", behaviour.brake_s, 0.001, 2, "Time until the hand stands still.");
    table.read("refractory_s", behaviour.refractory_s, 0, 5, "Shortest time between two actions.");
    table.read("recovery", behaviour.recovery, {"approach", "push"},
               "Behaviour after a lost contact. approach: relax, then insert again, slower; push: push "
               "harder (docs/model.md).");
    table.read("relax_s", behaviour.relax_s, 0.01, 5, "approach: time until the arm has relaxed.");
    table.read("slowing", behaviour.slowing, 0.1, 1, "approach: factor of the speed after each loss.");
    table.read("slowest", behaviour.slowest, 0.01, 1,
               "approach: lowest speed, as a fraction of the normal one.");
    table.read("push_m", behaviour.push_m, 0, 0.02, "push: first advance, at the hand.");
    table.read("push_growth", behaviour.push_growth, 1, 3, "push: factor from one advance to the next.");
    table.read("push_s", behaviour.push_s, 0.01, 5, "push: duration of an advance.");
    table.read("cocontraction", behaviour.cocontraction, 0, 2,
               "HF: relative increase of the stiffness after each loss.");
    table.read("cocontraction_limit", behaviour.cocontraction_limit, 0, 5, "Upper limit of that increase.");
    table.read("learning_exponent", behaviour.learning_exponent, 0, 1,
               "After a loss in trial n, slowing and stiffening are multiplied by n to this power; 0: off.");
    table.read("press_N", behaviour.press_N, 0, 10,
               "HF: extra force on the fixture, beyond the force at which it was felt.");
}

void read_spread(const ConfigTable& table, SubjectSpread& spread) {
    table.read("spread_speed", spread.speed, 0, 1,
               "SD of the logarithm between subjects of the insertion speed. The next ones are the same for "
               "other parameters.");
    table.read("spread_stiffness", spread.stiffness, 0, 1, "SD of arm stiffness and of grip stiffness.");
    table.read("spread_criterion", spread.criterion, 0, 1, "SD of the criterion.");
    table.read("spread_sway", spread.sway, 0, 1, "SD of the slow drift.");
    table.read("spread_push", spread.push, 0, 1, "SD of the push.");
    table.read("spread_reaction", spread.reaction, 0, 1, "SD of all reaction times together.");
    table.read("spread_reaction_modality", spread.reaction_modality, 0, 1,
               "SD of a subject's reaction time in one modality.");
    table.read("spread_press", spread.press, 0, 1, "SD of the extra force press_N.");
    table.read("spread_experience", spread.experience, 0, 2,
               "Every second subject is experienced: difference to the others in the logarithms of "
               "criterion, press and reaction times.");
}

}  // namespace

OperatorParameters read_operator_parameters(const ConfigTable& table) {
    OperatorParameters parameters;
    read_hand(table, parameters.hand);
    read_reflex(table, parameters.reflex);
    read_noise(table, parameters.noise);
    read_perception(table, parameters.perception);
    read_reaction(table, parameters.reaction);
    read_behaviour(table, parameters.behaviour);
    read_spread(table, parameters.spread);
    return parameters;
}

Subject draw_subject(const OperatorParameters& parameters, std::uint64_t study, std::uint32_t experiment,
                     std::uint32_t subject) {
    RandomStream random({study, cohort_of(experiment), subject, 0, Purpose::kSubject});
    const auto around = [&random](double median, double spread) {
        return median * portable::exp(spread * random.normal());
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
    drawn.press_N = around(parameters.behaviour.press_N, spread.press);
    // Half of every cohort, as in the paper.
    const double skill = portable::exp((subject % 2 == 1 ? -0.5 : 0.5) * spread.experience);
    for (double* trait : {&drawn.criterion_N, &drawn.press_N, &drawn.reaction_factor}) *trait *= skill;
    return drawn;
}

}  // namespace thimble
