#include "common/force_guard.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace thimble {

ForceGuard::ForceGuard(const ForceLimits& limits, std::string_view device)
    : limits_(limits), not_a_number_(fmt::format("a force was asked of {} that is no number", device)) {
    text_.reserve(kLongestText);
}

void ForceGuard::clear(SessionTime now) {
    text_.clear();
    given_at_ = now;
    given_N_ = 0;
}

void ForceGuard::trip(std::string_view text) {
    if (!tripped()) text_.assign(text);
}

double ForceGuard::pass(SessionTime now, double wanted_N) {
    if (!std::isfinite(wanted_N)) trip(not_a_number_);
    if (tripped()) {
        given_N_ = 0;
        given_at_ = now;
        return 0;
    }
    double force_N = std::clamp(wanted_N, limits_.lowest_N, limits_.highest_N);
    if (limits_.rate_limit_N_per_s > 0) force_N = limited_rate(now, force_N);
    if (force_N != wanted_N) ++cut_;
    given_N_ = force_N;
    given_at_ = std::max(given_at_, now);
    return force_N;
}

// From one sign to the other it starts at zero.
double ForceGuard::limited_rate(SessionTime now, double force_N) const {
    const double before_N = given_N_ * force_N > 0 ? std::abs(given_N_) : 0;
    const double elapsed_s = to_seconds(std::clamp(now - given_at_, Duration{}, limits_.sample_period));
    const double most_N = before_N + limits_.rate_limit_N_per_s * elapsed_s;
    return std::copysign(std::min(std::abs(force_N), most_N), force_N);
}

}  // namespace thimble
