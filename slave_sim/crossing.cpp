#include "slave_sim/crossing.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

#include <boost/math/tools/toms748_solve.hpp>

#include "common/math/portable.hpp"

namespace thimble {

namespace {

constexpr double kNever_s = std::numeric_limits<double>::infinity();

struct Point {
    double t_s;
    GapMotion::Sample sample;
};

// The later end of the last bracket: there the function has certainly changed sign. Needs a sign change.
template <class Function>
double root_between(const Function& function, double low_s, double high_s, double low, double high) {
    const boost::math::tools::eps_tolerance<double> tolerance(52);
    std::uintmax_t evaluations = 100;
    return boost::math::tools::toms748_solve(function, low_s, high_s, low, high, tolerance, evaluations)
        .second;
}

double rise_on_monotone(const GapMotion& gap, const Point& from, const Point& to) {
    if (to.sample.value_m <= 0 || to.sample.value_m <= from.sample.value_m) return kNoCrossing;
    if (from.sample.value_m >= 0) return from.t_s;
    const auto value = [&gap](double t_s) { return gap.at(t_s).value_m; };
    return root_between(value, from.t_s, to.t_s, from.sample.value_m, to.sample.value_m);
}

// The rate is monotone here: at most one turning point.
double rise_between_bends(const GapMotion& gap, const Point& from, const Point& to) {
    const double before = from.sample.rate_m_per_s;
    const double after = to.sample.rate_m_per_s;
    if (!((before < 0 && after > 0) || (before > 0 && after < 0))) return rise_on_monotone(gap, from, to);
    const auto rate = [&gap](double t_s) { return gap.at(t_s).rate_m_per_s; };
    const double turn_s = root_between(rate, from.t_s, to.t_s, before, after);
    const Point turn{turn_s, gap.at(turn_s)};
    const double rise_s = rise_on_monotone(gap, from, turn);
    return rise_s != kNoCrossing ? rise_s : rise_on_monotone(gap, turn, to);
}

// The first time from t on at which the swinging surface can reach the needle; infinite if it never can.
double reach_s(const GapMotion& gap, const Swing& swing, double t_s) {
    const double speed_m_per_s = gap.side * gap.velocity_needle_m_per_s;
    const double line_m = gap.side * (gap.gap_m - swing.center_m);
    // A little more than the envelope, for its rounding.
    const double reach_m = swing.amplitude_m * (1 + 1e-9) * portable::exp(-swing.fade_per_s * t_s);
    if (!(line_m + speed_m_per_s * t_s + reach_m < 0)) return t_s;
    return speed_m_per_s > 0 ? -(line_m + reach_m) / speed_m_per_s : kNever_s;
}

// The bends of a motion, one after the other. A step can hold 1e12 swings: those that cannot reach the needle
// are passed over.
class Bends {
  public:
    explicit Bends(const GapMotion& gap)
        : gap_(gap),
          bends_(gap.law->inflections(gap.velocity_surface_m_per_s, gap.acceleration_surface_m_per_s2)),
          swings_(bends_.spacing_s < kNever_s),
          next_s_(bends_.first_s) {
        if (swings_) {
            swing_ = gap.law->swing(gap.velocity_surface_m_per_s, gap.acceleration_surface_m_per_s2);
        }
    }

    double next_s() const { return next_s_; }

    // Swings only fade. One that did not reach a needle that rests, or withdraws, is followed by none that does.
    bool has_seen_all(double until_s) const {
        const bool withdraws = gap_.side * gap_.velocity_needle_m_per_s <= 0;
        return swings_ && withdraws && until_s >= 2 * bends_.spacing_s;
    }

    // From `point`, which becomes the last bend before the needle comes within reach.
    void pass(Point& point) {
        if (swings_) {
            const double reached_s = reach_s(gap_, swing_, point.t_s);
            const double skipped = std::floor((reached_s - point.t_s) / bends_.spacing_s) - 1;
            if (skipped >= 1) {
                passed_ += skipped;
                point.t_s = at_s(passed_);
                if (point.t_s < kNever_s) point.sample = gap_.at(point.t_s);
            }
        }
        next_s_ = at_s(++passed_);
    }

  private:
    double at_s(double bend) const { return bends_.first_s + bend * bends_.spacing_s; }

    const GapMotion& gap_;
    Inflections bends_;
    bool swings_;
    Swing swing_{};
    double next_s_;
    double passed_ = 0;
};

}  // namespace

double first_rise(const GapMotion& gap, double duration_s) {
    Bends bends(gap);
    const Point last{duration_s, gap.at(duration_s)};
    Point from{0, gap.at(0.0)};
    while (from.t_s < duration_s) {
        // Ends a long step of a surface whose oscillation has died away.
        if (cannot_rise(from.sample, last.sample, duration_s - from.t_s)) break;
        if (bends.has_seen_all(from.t_s)) break;
        if (gap.propagators >= gap.most_propagators) return kUnsearched;
        // After 2^52 swings there is no time between two of them, and no phase left to be right about.
        const bool resolved = bends.next_s() > from.t_s && bends.next_s() < duration_s;
        const Point to = resolved ? Point{bends.next_s(), gap.at(bends.next_s())} : last;
        const double rise_s = rise_between_bends(gap, from, to);
        if (rise_s != kNoCrossing) return rise_s;
        from = to;
        bends.pass(from);
    }
    return kNoCrossing;
}

}  // namespace thimble
