// A hand that presses on a spring far away: how much delay it bears by theory, and what a passivity controller does about
// more of it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <vector>

#include "common/control/passivity_controller.hpp"
#include "common/error.hpp"
#include "stability/critical_delay.hpp"

namespace {

constexpr thimble::HeldMass kHand{.mass_kg = 0.5, .damping_Ns_per_m = 2, .stiffness_N_per_m = 20};
constexpr double kSpring_N_per_m = 200;
constexpr double kPeriod_s = 1e-3;

// The hand is let go 5 mm from its rest. How far it still swings in the last of five seconds, m; force positive pushes the
// hand out (-z).
double last_swing_m(double delay_s, thimble::PortCompensator* compensator) {
    double position_m = 0.005, velocity_m_per_s = 0, force_N = 0, swing_m = 0;
    std::vector<double> on_the_way(static_cast<std::size_t>(std::lround(delay_s / kPeriod_s)), 0.0);
    for (std::size_t step = 0; step < 5000; ++step) {
        double& late_m = on_the_way[step % on_the_way.size()];
        const double wanted_N = kSpring_N_per_m * late_m;
        late_m = position_m;
        if (compensator != nullptr) compensator->observe(kPeriod_s, position_m, force_N);
        force_N = compensator == nullptr ? wanted_N : compensator->force_N(wanted_N);
        const double own_N = kHand.damping_Ns_per_m * velocity_m_per_s + kHand.stiffness_N_per_m * position_m;
        velocity_m_per_s -= kPeriod_s * (force_N + own_N) / kHand.mass_kg;
        position_m += kPeriod_s * velocity_m_per_s;
        if (step >= 4000) swing_m = std::max(swing_m, std::fabs(position_m));
    }
    return swing_m;
}

}  // namespace

int main() {
    try {
        const double limit_s = thimble::critical_delay_s(kHand, kSpring_N_per_m);
        std::printf("by theory this hand bears %.1f ms of delay\n", limit_s * 1e3);
        for (const double delay_s : {limit_s / 2, limit_s * 2}) {
            // As much damping as is recommended for this mass, m / h.
            thimble::PassivityController controller({.sample_period_s = kPeriod_s},
                                                    kHand.mass_kg / kPeriod_s);
            const double alone_m = last_swing_m(delay_s, nullptr);
            const double with_controller_m = last_swing_m(delay_s, &controller);
            std::printf("%4.1f ms: swings %.3g mm after 5 s, with a passivity controller %.3g mm\n",
                        delay_s * 1e3, alone_m * 1e3, with_controller_m * 1e3);
        }
        return 0;
    } catch (const thimble::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.code());
    }
}
