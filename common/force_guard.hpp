// The rules of the last stage before a device that pushes on a person. GuardedHandle and GuardedActuator put them before the
// handle and before the fingertips. The guard knows the force that somebody wants and nothing of messages, networks and
// sessions, so that no input from outside can talk it round.
//
// An allowed force is never larger than the wanted one, never of the other sign, never beyond the limits, and never grows faster
// than rate_limit_N_per_s, where the time since the force before counts as one sample period at most. So neither a silence nor
// a new trial allows a jump. A force falls as fast as it likes. A wanted force that is no number trips the guard: it allows
// zero from then on until clear(). A device may trip it for reasons of its own.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/time.hpp"

namespace thimble {

struct ForceLimits {
    double lowest_N = 0, highest_N = 0;  // lowest_N <= 0 <= highest_N
    double rate_limit_N_per_s = 0;       // 0: none
    Duration sample_period{};
};

class ForceGuard {
  public:
    static constexpr std::size_t kLongestText = 200;

    // `device`: its name in the text of a trip.
    ForceGuard(const ForceLimits& limits, std::string_view device);

    // A trial begins: no force yet, not tripped.
    void clear(SessionTime now);
    // The allowed force for `wanted_N`.
    double pass(SessionTime now, double wanted_N);
    // The first reason stays.
    void trip(std::string_view text);

    bool tripped() const { return !text_.empty(); }
    // Why, with the numbers; empty while it has not tripped.
    std::string_view text() const { return text_; }
    // Since start: forces that were cut at a limit or by the rate.
    std::uint64_t cut() const { return cut_; }

  private:
    double limited_rate(SessionTime now, double force_N) const;

    ForceLimits limits_;
    std::string not_a_number_;
    std::string text_;  // with room from the start: nothing is allocated when it trips
    SessionTime given_at_{};
    double given_N_ = 0;
    std::uint64_t cut_ = 0;
};

}  // namespace thimble
