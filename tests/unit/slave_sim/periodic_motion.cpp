#include "tests/unit/slave_sim/periodic_motion.hpp"

#include <functional>

#include "bench/reference_motion.hpp"

namespace thimble {

namespace {

using Number = ReferenceNumber;

struct Point {
    Number position_m;
    Number velocity_m_per_s;
};

// x'' = drive - a x' - w2 x
struct Law {
    Number drive, a, w2;
};
using Rule = std::function<Point(const Law&, const Point&)>;

Number acceleration(const Law& law, const Point& p) {
    return law.drive - law.a * p.velocity_m_per_s - law.w2 * p.position_m;
}

Rule exact(const Law& law, const Number& h) {
    ReferenceHalving halving({law.a, law.w2, sqrt(law.w2)}, h);
    return [halving](const Law& now, const Point& p) mutable {
        const ReferenceMotion to =
            halving.advance({p.position_m, p.velocity_m_per_s, acceleration(now, p)}, 0);
        return Point{to.position_m, to.velocity_m_per_s};
    };
}

Rule semi_implicit_euler(const Number& h) {
    return [h](const Law& law, const Point& p) {
        const Number v = p.velocity_m_per_s + h * acceleration(law, p);
        return Point{p.position_m + h * v, v};
    };
}

// For a linear equation Runge-Kutta of order 4 is the Taylor series to the fourth power.
Rule rk4(const Number& h) {
    return [h](const Law& law, const Point& p) {
        Point term{p.velocity_m_per_s, acceleration(law, p)};
        Point sum = p;
        Number factor = h;
        for (int k = 2; k <= 5; ++k) {
            sum.position_m += factor * term.position_m;
            sum.velocity_m_per_s += factor * term.velocity_m_per_s;
            term = {term.velocity_m_per_s, -law.a * term.velocity_m_per_s - law.w2 * term.position_m};
            factor *= h / k;
        }
        return sum;
    };
}

// With the mean velocity as the unknown: x' = x + h m, v' = 2 m - v.
Rule implicit_midpoint(const Number& h) {
    return [h](const Law& law, const Point& p) {
        const Number pull = h / 2 * (law.drive - law.w2 * p.position_m);
        const Number mean = (p.velocity_m_per_s + pull) / (1 + h / 2 * (law.a + h / 2 * law.w2));
        return Point{p.position_m + h * mean, 2 * mean - p.velocity_m_per_s};
    };
}

Rule rule_of(std::string_view solver, const Law& law, const Number& h) {
    if (solver == "semi_implicit_euler") return semi_implicit_euler(h);
    if (solver == "rk4") return rk4(h);
    if (solver == "implicit_midpoint") return implicit_midpoint(h);
    return exact(law, h);
}

// The points after each step of one period that starts at `from`.
std::vector<Point> period(const Rule& rule, const Law& still, const Number& drag_per_s,
                          const Polygon& polygon, const Point& from) {
    std::vector<Point> points;
    Point at = from;
    Number before_m = polygon.needle_m.back();
    for (const double needle_m : polygon.needle_m) {
        Law law = still;
        law.drive = drag_per_s * (needle_m - before_m) / polygon.step_s;
        before_m = needle_m;
        at = rule(law, at);
        points.push_back(at);
    }
    return points;
}

}  // namespace

std::vector<SurfaceSample> periodic_motion(std::string_view solver, const TissueParameters& p,
                                           const Polygon& polygon) {
    const Number drag_per_s = Number(p.drag_Ns_per_m) / p.mass_kg;
    const Law still{0, Number(p.damping_Ns_per_m) / p.mass_kg + drag_per_s,
                    Number(p.stiffness_N_per_m) / p.mass_kg};
    const Rule rule = rule_of(solver, still, polygon.step_s);
    const auto end_of = [&](const Point& from) {
        return period(rule, still, drag_per_s, polygon, from).back();
    };
    const Point b = end_of({0, 0});
    const Point first = end_of({1, 0});
    const Point second = end_of({0, 1});
    // (1 - A) x = b by Cramer's rule.
    const Number m00 = 1 - (first.position_m - b.position_m);
    const Number m10 = -(first.velocity_m_per_s - b.velocity_m_per_s);
    const Number m01 = -(second.position_m - b.position_m);
    const Number m11 = 1 - (second.velocity_m_per_s - b.velocity_m_per_s);
    const Number determinant = m00 * m11 - m01 * m10;
    const Point fixed{(b.position_m * m11 - m01 * b.velocity_m_per_s) / determinant,
                      (m00 * b.velocity_m_per_s - b.position_m * m10) / determinant};
    std::vector<SurfaceSample> samples;
    for (const Point& at : period(rule, still, drag_per_s, polygon, fixed)) {
        samples.push_back({at.position_m.convert_to<double>(), at.velocity_m_per_s.convert_to<double>()});
    }
    return samples;
}

}  // namespace thimble
