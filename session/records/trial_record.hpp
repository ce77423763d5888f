// The record of one trial: subject, conditions, the needle's course, the end.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/control/control_settings.hpp"
#include "common/messages.hpp"

namespace thimble {

struct TrialConditions {
    std::uint64_t study_seed = 0;
    std::uint32_t experiment = 3;
    std::uint32_t subject = 1;  // from 1
    std::uint32_t trial = 1;    // from 1 within the subject
    Modality modality = Modality::kHF;
    double delay_s = 0;             // one-way, virtual environment to handle, fingertips and bar
    double fixture_position_m = 0;  // drawn anew for every trial
    bool removes_fixture = false;   // it vanishes with the beep (experiment 2)
    Compensator compensator =
        Compensator::kNone;  // against delay, in HF ([control]); the session says which one acted
};

inline SessionControl start_order(const TrialConditions& conditions) {
    SessionControl order;
    order.kind = ControlKind::kTrialStart;
    order.study_seed = conditions.study_seed;
    order.experiment = conditions.experiment;
    order.subject = conditions.subject;
    order.modality = conditions.modality;
    order.fixture_position_m = conditions.fixture_position_m;
    return order;
}

// One answer of slave_sim. Forces act on the operator (negative resists insertion); z positive into the
// tissue.
struct TrajectorySample {
    double time_s = 0;  // since the start of the trial, on the master's clock
    double position_needle_m = 0;
    double position_surface_m = 0;
    double force_tissue_N = 0;
    double force_fixture_N = 0;
    double force_total_N = 0;
    double contact_time_s = 0;  // unbroken contact with the fixture
    TissuePhase phase = TissuePhase::kFree;
    bool fixture_present = true;
};

// Copies the state of needle and tissue, which ForceFeedback, TrajectorySample and Monitor share.
template <class From, class To>
void copy_state(const From& from, To& to) {
    to.position_needle_m = from.position_needle_m;
    to.position_surface_m = from.position_surface_m;
    to.force_tissue_N = from.force_tissue_N;
    to.force_fixture_N = from.force_fixture_N;
    to.force_total_N = from.force_total_N;
    to.contact_time_s = from.contact_time_s;
    to.phase = from.phase;
    to.fixture_present = from.fixture_present;
}

// One way of the network under a profile, in short.
struct WayInShort {
    double delay_s = 0;          // mean
    double jitter_spread_s = 0;  // of its shape, as in a session file
    double loss = 0;             // share of packets, in the long run
};

// The network became another one: while the trial ran, or before it, where a profile was chosen then (time 0).
struct NetworkEvent {
    double time_s = 0;             // of the newest sample when it was ordered
    double delay_s = 0;            // force path, one way
    std::string profile{};         // whose name was chosen; empty: the delay alone changed
    WayInShort needle{}, force{};  // of a profile
};

struct TrialRecord {
    TrialConditions conditions;
    std::vector<TrajectorySample> samples;
    double beep_time_s = std::numeric_limits<double>::quiet_NaN();       // NaN: no beep
    double round_trip_s = std::numeric_limits<double>::quiet_NaN();      // median, handle to handle, by echo
    double achieved_delay_s = std::numeric_limits<double>::quiet_NaN();  // by the network, both ways, median
    std::vector<NetworkEvent> network_events{};  // in order; delay_s of the conditions held before
    EndReason reason = EndReason::kNone;
    Role lost_peer = Role::kSession;  // meaningful with EndReason::kPeerLost, kDeviceFault and stops
    std::string fault{};              // words of the failed device, the silent node or the stop
};

}  // namespace thimble
