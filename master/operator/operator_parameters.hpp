// Every constant of the virtual operator, with its source, and one subject drawn from them.
//
// Source tags: [P] the paper; [V] value or fact seen in the cited text; [V2] the same in a secondary source;
// [M] recalled from the literature, not verified again; [A] assumption. No constant differs between the
// modalities except where skin, joints and eyes do: reaction time, just noticeable difference, range of the
// display.
#pragma once

#include <array>
#include <cstdint>

#include "common/config.hpp"
#include "common/messages.hpp"
#include "common/shared_values.hpp"

namespace thimble {

inline constexpr std::size_t kModalityCount = 4;

// Forearm and pinch grip, at nominal (not co-contracted) stiffness. See limb.hpp for the equations.
struct HandMechanics {
    double arm_stiffness_N_per_m = 350;    // [M] Speich 2005, Hogan 1989, Gomi and Kawato
    double arm_mass_kg = 1.2;              // [M] the same
    double arm_damping_ratio = 0.4;        // [M] the same; 18 Ns/m, teleoperation literature has about 20
    double grip_stiffness_N_per_m = 1000;  // [M] Hajian and Howe 1997; Hasser and Cutkosky 2002
    double grip_damping_ratio = 0.6;       // [M] the same; pulp dissipates 81 % of a tap, Jindrich 2003 [V]
    double friction_learned_speed_m_per_s =
        5e-4;  // [A] where the learned feed-forward of friction changes sign
    // Arm and grip are stiffer under load, by these fractions per newton; 0: off. Stiffness grows linearly with grip force [V]
    // (Hoeppner, McIntyre and van der Smagt 2013, abstract), and with the arm's load [M] (Lacquaniti 1982). The slopes are [A].
    double load_stiffness_per_N = 0;
    double load_damping_per_N = 0;
    double load_lag_s = 0.05;  // [A] until a muscle has built up its force
};

// Long-latency stretch reflex: the muscles answer a stretch before the will does (reflex.hpp).
struct ReflexParameters {
    double gain = 0;           // 0: off; [A] of the stretch that is countered
    double latency_s = 0.075;  // [V] 50-100 ms, Pruszynski and Scott 2012; Kurtzer 2015 (abstracts)
    double window_s = 0.05;    // [A] a stretch that is older is no news
};

// Deviations from what was intended.
struct NoiseParameters {
    double sway_m = 2.5e-4;           // [V] 166-254 um braced without vision (PMC3032442); rms, at the hand
    double sway_correlation_s = 1.0;  // [A]
    double tremor_m = 5e-5;           // [V] Riviere 1997: 49 um rms in surgeons
    double tremor_frequency_Hz = 9;   // [V] the same
    double tremor_damping_ratio = 0.15;      // [A]
    double force_noise_fraction = 0.04;      // [V] Baweja 2009: 4.1-4.5 % of the force
    double force_noise_correlation_s = 0.1;  // [A]
    double speed_noise_fraction = 0.10;      // [A]
    double speed_noise_correlation_s = 0.5;  // [A]
};

struct PerceptionParameters {
    double criterion_N = 2.0;  // [A] geometric middle of 1-4 N; force at which a subject says "fixture"
    double criterion_cap_fraction =
        0.9;  // [A] of the full scale of the display, else it might never be reached
    double full_scale_handle_N = kHandleFullScale_N;     // [V]
    double full_scale_cutaneous_N = kFingerFullScale_N;  // [V]
    double full_scale_bar_N = kBarFullScale_N;           // [A]
    double lost_N = 0.1;                                 // [A] below this nothing is felt or seen
    double lost_after_s = 0.02;                          // [M] tactile gap detection
    double weber_handle = 0.08;                          // [V] Pang 1991: about 7 %
    double weber_cutaneous = 0.16;                       // [V] Wheat 2004 (tangential)
    double weber_visual = 0.05;                          // [M] of a length
    double weber_correlation_s = 0.1;                    // [A]
};

// From the stimulus to the onset of the movement it triggers, medians.
struct ReactionParameters {
    double handle_s = 0.115;  // [V] Crago 1976: instructed (triggered) reactions 70-320 ms
    double cutaneous_s =
        0.130;  // [V] 67 ms EMG, Hernandez-Castillo 2020, + 40 ms electromechanical delay [M]; to 155
    double tactile_s = 0.155;    // [V2] Robinson 1934: voluntary, CCF
    double crossing_s = 0.0026;  // [V] Tame and Longo 2015: crossed-uncrossed difference, CCF
    double compatibility_s =
        0.020;                      // existence [V] Salzer 2014, Bao 2019; size [M]: the other hand acts, CCF
    double visual_s = 0.240;        // [V2] Welford 1980: 189 ms; middle of 189-290
    double auditory_s = 0.147;      // [V2] Welford 1980
    double trial_variation = 0.18;  // [M] coefficient of variation between decisions
    // Costs of a switch since the trial before, in the first reaction to the fixture; 0: off. Another sense takes longer, and the trial
    // before primes the same one [V] (Spence, Nicholls and Driver 2001, abstract). The other hand is [M] (Miles 2011). Sizes are [A].
    double switch_modality_s = 0, switch_hand_s = 0;
};

// The operator's reaction to a lost contact with the fixture (behaviour.hpp).
enum class Recovery : std::uint8_t { kApproach, kPush };

struct BehaviourParameters {
    double position_scale = kPositionScale;        // [P] needle per hand; the three speeds are the needle's
    double speed_free_needle_m_per_s = 0.060;      // [A] must exceed F_p / B_t = 20 mm/s
    double speed_insert_needle_m_per_s = 0.015;    // [A] from 19.9 s per trial [P]
    double speed_withdraw_needle_m_per_s = 0.100;  // [A]
    double speed_lag_s = 0.1;                      // [A]
    double speed_trial_variation = 0.10;           // [M] vigour literature
    double brake_s = 0.150;                        // [A]
    double refractory_s = 0.250;                   // [V] van de Kamp 2013
    Recovery recovery = Recovery::kApproach;       // [M] move and wait: Ferrell 1965, 1966
    double relax_s = 0.25;                         // [A] kApproach: to push no longer
    double slowing = 0.6;  // [A] kApproach: of the speed, per loss; slower after a mistake: Rabbitt 1966 [M]
    double slowest = 0.1;  // [A] kApproach: of the speed, at the least
    double push_m = 1.0e-3;            // [A] kPush: first advance, at the hand
    double push_growth = 1.6;          // [A] kPush: each further one
    double push_s = 0.25;              // [A] kPush
    double cocontraction = 0.25;       // [A] Tee and Burdet 2004 [V]: stiffness rises with instability
    double cocontraction_limit = 1.0;  // [A]
    // After a loss the operator of trial n slows by n^-x and stiffens by n^x of what trial 1 does; 0: off. Stiffness adapts across
    // trials [V] (Selen, Franklin and Wolpert 2009, abstract). The power law is [M] (Newell and Rosenbloom 1981), and x is [A].
    double learning_exponent = 0;
    double press_N = 0;  // [A] HF: leans on the fixture by so much more than it took to feel it; 0: off
};

// Standard deviations of the logarithms between subjects.
struct SubjectSpread {
    double speed = 0.15;              // [M] vigour literature
    double stiffness = 0.20;          // [A] arm and grip, each
    double criterion = 0.30;          // [A]
    double sway = 0.20;               // [A]
    double push = 0.30;               // [A]
    double reaction = 0.10;           // [M]
    double reaction_modality = 0.05;  // [M] subject x modality
    double press = 0.3;               // [A]
    // Of criterion, press and reaction, between subjects with and without experience of haptic devices; 0: off. Half of the paper's
    // subjects have it [P] (8 of 16, 5 of 10). Here every second one has it [A].
    double experience = 0;
};

struct OperatorParameters {
    HandMechanics hand;
    ReflexParameters reflex;
    NoiseParameters noise;
    PerceptionParameters perception;
    ReactionParameters reaction;
    BehaviourParameters behaviour;
    SubjectSpread spread;
};

// The traits of one subject, the same in every trial of an experiment.
struct Subject {
    double speed_insert_needle_m_per_s = 0;
    double arm_stiffness_N_per_m = 0;
    double grip_stiffness_N_per_m = 0;
    double criterion_N = 0;
    double sway_m = 0;
    double push_m = 0;
    double press_N = 0;
    double reaction_factor = 1;
    std::array<double, kModalityCount> reaction_modality_factor{1, 1, 1, 1};  // by Modality
};

// Table [operator]; the keys are the names above, prefixed where two structs would clash. Throws Error
// (usage).
OperatorParameters read_operator_parameters(const ConfigTable& table);

// The cohort of an experiment: the paper's experiment 2 has the subjects of experiment 1.
inline std::uint32_t cohort_of(std::uint32_t experiment) { return experiment == 2 ? 1 : experiment; }

// Lognormal about the parameters; a pure function of its arguments, so no subject depends on another.
Subject draw_subject(const OperatorParameters& parameters, std::uint64_t study, std::uint32_t experiment,
                     std::uint32_t subject);

}  // namespace thimble
