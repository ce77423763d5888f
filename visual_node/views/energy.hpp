// Passivity of the handle's port: what the hand has put in, less what it got back (Hannaford and Ryu 2002, passivity
// observer: a port that has given out more than it got is not passive).
#pragma once

namespace thimble {

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
