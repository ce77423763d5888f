#include "visual_node/views/energy.hpp"

namespace thimble {

EnergyBalance judge_energy(double energy_in_J) {
    if (energy_in_J < -kEnergyResolution_J) return EnergyBalance::kActive;
    if (energy_in_J > kEnergyResolution_J) return EnergyBalance::kPassive;
    return EnergyBalance::kNone;
}

const char* to_string(EnergyBalance energy) {
    switch (energy) {
        case EnergyBalance::kNone:
            return "none yet";
        case EnergyBalance::kPassive:
            return "passive";
        case EnergyBalance::kActive:
            return "gives out more than it got";
    }
    return "";
}

}  // namespace thimble
