// The rules of the last stage before a device that pushes on a person. GuardedHandle and GuardedActuator put them before the
// handle and before the fingertips. The guard knows the wanted force and nothing of messages, networks and sessions. So no
// message can change its rules.
//
// - The allowed force has the sign of the wanted one, is never larger, and lies within the limits.
// - It grows no faster than rate_limit_N_per_s, and falls as fast as it likes. The guard counts at most one sample period of
//   the time since the force before. So neither a silence nor a new trial allows a jump. If a device reports a smaller
//   force than was allowed, the next one grows from that. All forces of one instant grow from the force before it.
// - A wanted force that is no number trips the guard. From then on it allows zero until clear(). A device may trip the guard
//   for reasons of its own.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

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
    ForceGuard(const ForceLimits& limits, std::string_view device)
        : limits_(limits), not_a_number_(fmt::format("the force for {} is not a finite number", device)) {
        text_.reserve(kLongestText);
    }

    // A trial begins: no force yet, not tripped.
    void clear(SessionTime now) {
        text_.clear();
        given_at_ = passed_at_ = now;
        given_N_ = before_N_ = 0;
        elapsed_ = {};
    }

    // The allowed force for `wanted_N`.
    double pass(SessionTime now, double wanted_N) {
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

    // The device gives this force now, which may be less than the guard allowed.
    void device_gives(double force_N) {
        for (double* of_guard : {&given_N_, &before_N_})
            *of_guard = std::copysign(std::min(std::abs(force_N), std::abs(*of_guard)), *of_guard);
    }

    // The first reason stays.
    void trip(std::string_view text) {
        if (!tripped()) text_.assign(text);
    }

    bool tripped() const { return !text_.empty(); }
    // Why, with the numbers; empty while it has not tripped.
    std::string_view text() const { return text_; }
    // Since start: forces that were cut at a limit or by the rate.
    std::uint64_t cut() const { return cut_; }

  private:
    void begin_instant(SessionTime now) {
        passed_at_ = now;
        before_N_ = given_N_;
        elapsed_ = std::clamp(now - given_at_, Duration{}, limits_.sample_period);
    }

    // From one sign to the other it starts at zero.
    double limited_rate(SessionTime now, double force_N) {
        if (now != passed_at_) begin_instant(now);
        const double before_N = before_N_ * force_N > 0 ? std::abs(before_N_) : 0;
        const double most_N = before_N + limits_.rate_limit_N_per_s * to_seconds(elapsed_);
        return std::copysign(std::min(std::abs(force_N), most_N), force_N);
    }

    ForceLimits limits_;
    std::string not_a_number_;
    std::string text_;         // with room from the start: nothing is allocated when it trips
    SessionTime given_at_{};   // the latest time, which may be later than passed_at_
    SessionTime passed_at_{};  // of the newest force
    double given_N_ = 0;
    double before_N_ = 0;  // given before the instant of the newest force
    Duration elapsed_{};   // that counts for it
    std::uint64_t cut_ = 0;
};

}  // namespace thimble
