#include "visual_node/views/energy.hpp"

namespace thimble {

PortEnergy judge_energy(double energy_in_J) {
    if (energy_in_J < -kPortEnergyResolution_J) return PortEnergy::kActive;
    if (energy_in_J > kPortEnergyResolution_J) return PortEnergy::kPassive;
    return PortEnergy::kNone;
}

const char* to_string(PortEnergy energy) {
    switch (energy) {
        case PortEnergy::kNone:
            return "none yet";
        case PortEnergy::kPassive:
            return "passive";
        case PortEnergy::kActive:
            return "gives out more than it got";
    }
    return "";
}

}  // namespace thimble
