// x''' + a x'' + w2 x' = 0 for the reference: the matrix exponential by its Taylor series and repeated
// squaring. Shares no formula with slave_sim/second_order.cpp.
#pragma once

#include <cstddef>
#include <vector>

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace thimble {

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
    ReferenceHalving(const ReferenceLaw& law, const ReferenceNumber& duration_s);

    const ReferenceNumber& duration_s() const { return duration_s_; }
    ReferenceNumber duration_s(std::size_t halvings) const { return ldexp(duration_s_, -int(halvings)); }
    ReferenceMotion advance(const ReferenceMotion& from, std::size_t halvings);

  private:
    struct Matrix {
        ReferenceNumber m00, m01, m10, m11;
    };
    // exp(A t) for (x', x'') and its integral from 0 to t, whose first row moves x.
    struct Exponential {
        Matrix value;
        Matrix integral_s;
    };
    static Matrix product(const Matrix& a, const Matrix& b);
    static Matrix sum(const Matrix& a, const Matrix& b);
    static Matrix scaled(const Matrix& a, const ReferenceNumber& factor);
    Exponential taylor(const ReferenceNumber& t_s) const;
    const Exponential& level(std::size_t halvings);

    ReferenceLaw law_;
    ReferenceNumber duration_s_;
    std::vector<Exponential> levels_;
};

}  // namespace thimble
