// How a session runs its trials: how long it waits, for whom, and what ends a trial. Times are durations of the session's clock.
#pragma once

#include <chrono>

#include "common/messages.hpp"
#include "common/time.hpp"

namespace thimble {

struct SessionSettings {
    Duration trial_timeout = std::chrono::seconds{60};
    Duration contact_hold = std::chrono::seconds{5};  // as slave_sim's; tells when the beep was due
    Duration sample_period =
        std::chrono::milliseconds{1};  // as the master's; the record has a sample of each
    Duration network_delay{};          // needle and force path together, jitter included
    Duration force_delay{};            // the part of it that change_delay() replaces: the force path's mean
    Duration least_force_delay{};      // no force is quicker, as configured
    Duration peer_wait = std::chrono::seconds{5};  // for a node to answer a start or an end
    // Added to peer_wait before the first trial: the user makes the handle ready (handle_settings.hpp).
    Duration user_limit{};
    // Of a person, whose handle may not know when a trial is over: it has also ended once the needle, after
    // the beep, was free of the tissue for kWithdrawnFor.
    bool ends_by_withdrawal = false;
    Compensator compensator = Compensator::kNone;  // that acts in HF, for the record
    // The subject's window may ask to go on, while a page waits for that, and nothing else.
    bool subject_goes_on = false;
};

}  // namespace thimble
