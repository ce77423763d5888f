#include "bench/reference_motion.hpp"

namespace thimble {

namespace {

// T / 2^k below 1e-48 T.
constexpr std::size_t kDeepest = 160;

struct Point {
    ReferenceNumber t_s;
    ReferenceMotion motion;
};

ReferenceNumber gap_at(const ReferenceGap& gap, const Point& p) {
    return gap.side * (gap.needle_m + gap.velocity_needle_m_per_s * p.t_s - p.motion.position_m);
}

// The gap's slope and further derivatives at one instant. The velocity y of the surface obeys the homogeneous
// equation, as do its derivatives, and the energy y'^2 + w2 y^2 of such a motion only falls: |y'| <= |y'(0)| +
// w |y(0)| from there on.
class Shape {
  public:
    Shape(const ReferenceGap& gap, const ReferenceMotion& m) {
        const ReferenceLaw& law = gap.law;
        const ReferenceNumber jerk =
            -law.damping_per_s * m.acceleration_m_per_s2 - law.stiffness_per_s2 * m.velocity_m_per_s;
        const ReferenceNumber snap =
            -law.damping_per_s * jerk - law.stiffness_per_s2 * m.acceleration_m_per_s2;
        slope_ = gap.side * (gap.velocity_needle_m_per_s - m.velocity_m_per_s);
        second_ = -gap.side * m.acceleration_m_per_s2;
        third_ = -gap.side * jerk;
        second_bound_ = abs(m.acceleration_m_per_s2) + law.natural_per_s * abs(m.velocity_m_per_s);
        third_bound_ = abs(jerk) + law.natural_per_s * abs(m.acceleration_m_per_s2);
        fourth_bound_ = abs(snap) + law.natural_per_s * abs(jerk);
    }

    // Certainly never rising within t. A released surface starts at the needle with its velocity, so that only
    // the second or third derivative parts them.
    bool falls(const ReferenceNumber& t) const {
        if (slope_ + second_bound_ * t <= 0) return true;
        if (slope_ > 0) return false;
        if (second_ + third_bound_ * t <= 0) return true;
        return second_ <= 0 && third_ + fourth_bound_ * t <= 0;
    }
    bool rises(const ReferenceNumber& t) const { return slope_ - second_bound_ * t > 0; }
    // How far the gap can leave its chord.
    ReferenceNumber bulge_m(const ReferenceNumber& t) const { return second_bound_ * t * t / 8; }

  private:
    ReferenceNumber slope_, second_, third_;
    ReferenceNumber second_bound_, third_bound_, fourth_bound_;
};

class Search {
  public:
    Search(const ReferenceGap& gap, ReferenceHalving& halving) : gap_(gap), halving_(halving) {}

    // In [from, from + T / 2^level]; `to` is its end.
    std::optional<ReferenceCrossing> within(const Point& from, const Point& to, std::size_t level) {
        const ReferenceNumber length_s = halving_.duration_s(level);
        const ReferenceNumber first_m = gap_at(gap_, from);
        const ReferenceNumber last_m = gap_at(gap_, to);
        const Shape shape(gap_, from.motion);
        if ((first_m > last_m ? first_m : last_m) + shape.bulge_m(length_s) < 0) return std::nullopt;
        if (first_m <= 0 && shape.falls(length_s)) return std::nullopt;
        if (shape.rises(length_s)) {
            if (last_m <= 0) return std::nullopt;
            if (first_m >= 0) return ReferenceCrossing{from.t_s, from.motion};
        }
        if (level == kDeepest) {
            if (last_m <= 0) return std::nullopt;
            return ReferenceCrossing{to.t_s, to.motion};
        }
        const Point middle = after(from, level + 1);
        if (auto crossing = within(from, middle, level + 1)) return crossing;
        return within(middle, to, level + 1);
    }

    Point after(const Point& from, std::size_t level) {
        return {from.t_s + halving_.duration_s(level), halving_.advance(from.motion, level)};
    }

  private:
    const ReferenceGap& gap_;
    ReferenceHalving& halving_;
};

}  // namespace

std::optional<ReferenceCrossing> first_crossing(const ReferenceGap& gap, const ReferenceMotion& start,
                                                ReferenceHalving& halving) {
    Search search(gap, halving);
    const Point from{0, start};
    return search.within(from, search.after(from, 0), 0);
}

}  // namespace thimble
