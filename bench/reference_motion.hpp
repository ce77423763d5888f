// x''' + a x'' + w2 x' = 0 for the reference: the matrix exponential by its Taylor series and repeated
// squaring. Shares no formula with slave_sim/second_order.cpp.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace thimble {

// The Taylor series is summed where the motion's rate times the time is below this; above, by squaring.
inline constexpr double kTaylorRate = 1.0 / 16;

// 100 digits, of which a massless surface costs some 25 (its fast mode is 1e10 times shorter than a step)
// and halving down to an event 50 more where it touches; 40 are wanted.
using ReferenceNumber =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

// The constants of x'' = drive - a x' - w2 x.
struct ReferenceLaw {
    ReferenceNumber damping_per_s;     // a
    ReferenceNumber stiffness_per_s2;  // w2
    ReferenceNumber natural_per_s;     // sqrt(w2)
};

struct ReferenceMotion {
    ReferenceNumber position_m;
    ReferenceNumber velocity_m_per_s;
    ReferenceNumber acceleration_m_per_s2;
};

// The motion over T, T/2, T/4, ... : what an event is isolated with.
class ReferenceHalving {
  public:
    ReferenceHalving(const ReferenceLaw& law, const ReferenceNumber& duration_s)
        : law_(law), duration_s_(duration_s) {
        const ReferenceNumber rate = (law.damping_per_s + law.natural_per_s) * duration_s;
        std::size_t squarings = 0;
        for (ReferenceNumber z = rate; z > kTaylorRate; z /= 2) ++squarings;
        levels_.resize(squarings + 1);
        levels_[squarings] = taylor(this->duration_s(squarings));
        for (std::size_t i = squarings; i > 0; --i) {
            const Exponential& half = levels_[i];
            levels_[i - 1] = {product(half.value, half.value),
                              sum(half.integral_s, product(half.value, half.integral_s))};
        }
    }

    const ReferenceNumber& duration_s() const { return duration_s_; }
    ReferenceNumber duration_s(std::size_t halvings) const { return ldexp(duration_s_, -int(halvings)); }
    ReferenceMotion advance(const ReferenceMotion& from, std::size_t halvings) {
        const Exponential& e = level(halvings);
        const ReferenceNumber& v = from.velocity_m_per_s;
        const ReferenceNumber& a = from.acceleration_m_per_s2;
        return {from.position_m + e.integral_s.m00 * v + e.integral_s.m01 * a,
                e.value.m00 * v + e.value.m01 * a, e.value.m10 * v + e.value.m11 * a};
    }

  private:
    struct Matrix {
        ReferenceNumber m00, m01, m10, m11;
    };
    // exp(A t) for (x', x'') and its integral from 0 to t, whose first row moves x.
    struct Exponential {
        Matrix value;
        Matrix integral_s;
    };
    static Matrix product(const Matrix& a, const Matrix& b) {
        return {a.m00 * b.m00 + a.m01 * b.m10, a.m00 * b.m01 + a.m01 * b.m11, a.m10 * b.m00 + a.m11 * b.m10,
                a.m10 * b.m01 + a.m11 * b.m11};
    }

    static Matrix sum(const Matrix& a, const Matrix& b) {
        return {a.m00 + b.m00, a.m01 + b.m01, a.m10 + b.m10, a.m11 + b.m11};
    }

    static Matrix scaled(const Matrix& a, const ReferenceNumber& factor) {
        return {a.m00 * factor, a.m01 * factor, a.m10 * factor, a.m11 * factor};
    }

    // sum A^k t^k / k!  and  sum A^k t^(k+1) / (k+1)!
    Exponential taylor(const ReferenceNumber& t_s) const {
        const Matrix a{0, 1, -law_.stiffness_per_s2, -law_.damping_per_s};
        // |A^k t^k| / k! in units of the motion's own speed.
        ReferenceNumber size = 1;
        const ReferenceNumber rate = 2 * (law_.damping_per_s + law_.natural_per_s) * t_s;
        const ReferenceNumber negligible = std::numeric_limits<ReferenceNumber>::epsilon() / 1000;
        Matrix term{1, 0, 0, 1};
        Exponential e{term, scaled(term, t_s)};
        for (int k = 1; size > negligible; ++k) {
            size *= rate / k;
            term = scaled(product(a, term), t_s / k);
            e.value = sum(e.value, term);
            e.integral_s = sum(e.integral_s, scaled(term, t_s / (k + 1)));
        }
        return e;
    }

    const Exponential& level(std::size_t halvings) {
        while (levels_.size() <= halvings) levels_.push_back(taylor(duration_s(levels_.size())));
        return levels_[halvings];
    }

    ReferenceLaw law_;
    ReferenceNumber duration_s_;
    std::vector<Exponential> levels_;
};

// Event isolation for the reference: halving with rigorous bounds on the derivatives of the gap.

// side * (needle - surface): +1 asks for a needle that enters, -1 for one that leaves.
struct ReferenceGap {
    int side;
    ReferenceNumber needle_m;  // at the start of the leg
    ReferenceNumber velocity_needle_m_per_s;
    ReferenceLaw law;
};

struct ReferenceCrossing {
    ReferenceNumber after_s;
    ReferenceMotion motion;
};

// The first rise of the gap above zero within (0, T], or at 0 if it stands at zero and rises at once. Not a crossing:
// a gap at zero that falls or rests, or one that reaches zero at the very end of the leg.
std::optional<ReferenceCrossing> first_crossing(const ReferenceGap& gap, const ReferenceMotion& start,
                                                ReferenceHalving& halving);

}  // namespace thimble
