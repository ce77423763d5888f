#include "slave_sim/fixture.hpp"

namespace thimble {

FixtureContact Fixture::touch(double position_needle_m) const {
    const double penetration_m = position_needle_m - parameters_.position_m;
    if (!present_ || penetration_m <= 0) return {position_needle_m, 0, 0};
    return {parameters_.position_m, penetration_m, -parameters_.stiffness_N_per_m * penetration_m};
}

}  // namespace thimble
