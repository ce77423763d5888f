// The rules of the last stage before a device that pushes on a person. GuardedHandle and GuardedActuator put them before the
// handle and before the fingertips. The guard knows the wanted force and nothing of messages, networks and sessions. So no
// message can change its rules.
//
// - The allowed force has the sign of the wanted one, is never larger, and lies within the limits.
// - It grows no faster than rate_limit_N_per_s, and falls as fast as it likes. The guard counts at most one sample period of
//   the time since the force before. So neither a silence nor a new trial allows a jump.
// - A wanted force that is no number trips the guard. From then on it allows zero until clear(). A device may trip the guard
//   for reasons of its own.
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
