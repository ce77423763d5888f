// Trials that several scenarios share.
#pragma once

#include "session/settings/protocol.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble::test {

inline constexpr Duration kPaperDelay = std::chrono::milliseconds{50};

inline const SystemSettings& paper() {
    static const SystemSettings settings = load_system_settings({});
    return settings;
}

// The paper's settings with other delays of needle and force.
inline SystemSettings paper_with_delays(Duration needle, Duration force) {
    SystemSettings settings = paper();
    settings.netem.needle.delay = needle;
    settings.netem.force.delay = force;
    return settings;
}

// Of seed 1; the fixture is where experiment 3 draws it.
inline TrialConditions trial_of(Modality modality, Duration delay = {}, std::uint32_t subject = 1,
                                std::uint32_t trial = 1) {
    const Protocol protocol = experiment_3(paper(), subject, 1);
    return {protocol.seed,
            protocol.experiment,
            subject,
            trial,
            modality,
            to_seconds(delay),
            draw_fixture_position_m(protocol, subject, trial)};
}

}  // namespace thimble::test
