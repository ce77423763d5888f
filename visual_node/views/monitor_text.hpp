// Each number of a Monitor as people read it: with its unit, and "not known" where it is not known.
#pragma once

#include <array>

#include "common/messages.hpp"
#include "visual_node/views/text_line.hpp"

namespace thimble {

inline constexpr const char* kNotKnownText = "not known";

// "12.34 mm", "-3.20 N", "12.3 ms": so many digits that the last one is above what encoder and clocks resolve.
TextLine length_text(double length_m);
TextLine force_text(double force_N);
TextLine time_text(double time_s);
TextLine energy_text(double energy_in_J);  // with what it says about the port
// The age of a message, "4 ms", "1.2 s", "3 min" or "2 h 5 min"; "no message yet" for Duration::max().
TextLine age_text(Duration age);

// "24.9 ms ± 0.3 ms"; not known where the clocks were not compared (negative), or where the bound is not smaller than
// the value: then the sign of the delay is all that is known.
TextLine one_way_text(double one_way_s, double one_way_bound_s);
// 0: no answer has come yet.
TextLine round_trip_text(double round_trip_s);
TextLine trial_text(std::uint32_t trial, std::uint32_t trials);
// "running", "between trials, last one: timeout", "paused".
TextLine state_text(const Monitor& monitor);

struct Reading {
    const char* name = "";
    TextLine value;
};
// All that the experimenter reads, in the order of the panel; a positive force pushes the hand out, as in the plots.
inline constexpr std::size_t kReadingCount = 18;
std::array<Reading, kReadingCount> read_monitor(const Monitor& monitor, std::uint32_t trial);

// Passivity of the handle's port: what the hand has put in, less what it got back (Hannaford and Ryu 2002, passivity
// observer: a port that has given out more than it got is not passive).
enum class EnergyBalance {
    kNone,     // nothing to speak of in either direction
    kPassive,  // more went in than came out
    kActive,   // gives out more than it got
};

// Below this, either way, it is rounding of encoder steps and not energy: 0.01 mm at 0.1 N.
inline constexpr double kEnergyResolution_J = 1e-6;

// Of Monitor::energy_in_J. Values that are no number are left out.
EnergyBalance judge_energy(double energy_in_J);
const char* to_string(EnergyBalance energy);

}  // namespace thimble
