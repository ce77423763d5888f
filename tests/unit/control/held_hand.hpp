// The hand of tests/golden/compensators.json: m x" + b x' + k (x - x_d) = -F, exact for a held F and a straight x_d, read by an
// encoder; it approaches a wall at 0 and pushes with F_0 there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace thimble::test {

struct HandCase {
    double mass_kg = 1, damping_Ns_per_m = 20, stiffness_N_per_m = 500;
    double push_N = 5, start_m = -0.02, speed_m_per_s = 0.05;
    double wall_N_per_m = 9000, limit_N = 12, step_m = 1e-5;
};

inline constexpr double kTick_s = 1e-3;

class HeldHand {
  public:
    explicit HeldHand(const HandCase& hand) : hand_(hand), position_m_(hand.start_m) {
        const Matrix rates{
            {{0, 1, 0, 0},
             {-hand.stiffness_N_per_m / hand.mass_kg, -hand.damping_Ns_per_m / hand.mass_kg, 1, 0},
             {0, 0, 0, 1},
             {0, 0, 0, 0}}};
        Matrix term{};
        for (std::size_t i = 0; i < 4; ++i) term[i][i] = map_[i][i] = 1;
        for (int n = 1; n < 30; ++n) {
            term = product(term, rates, kTick_s / n);
            for (std::size_t i = 0; i < 4; ++i) {
                for (std::size_t j = 0; j < 4; ++j) map_[i][j] += term[i][j];
            }
        }
    }

    double reading_m() const { return std::floor(position_m_ / hand_.step_m + 0.5) * hand_.step_m; }
    double position_m() const { return position_m_; }
    double velocity_m_per_s() const { return velocity_m_per_s_; }

    void advance(double force_N) {
        const double time_s = static_cast<double>(ticks_++) * kTick_s;
        const double from_m = reference_m(time_s), to_m = reference_m(time_s + kTick_s);
        const std::array<double, 4> state{
            position_m_, velocity_m_per_s_, (hand_.stiffness_N_per_m * from_m - force_N) / hand_.mass_kg,
            hand_.stiffness_N_per_m * (to_m - from_m) / kTick_s / hand_.mass_kg};
        double next[2] = {0, 0};
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t j = 0; j < 4; ++j) next[i] += map_[i][j] * state[j];
        }
        position_m_ = next[0];
        velocity_m_per_s_ = next[1];
    }

  private:
    using Matrix = std::array<std::array<double, 4>, 4>;
    static Matrix product(const Matrix& a, const Matrix& b, double factor) {
        Matrix c{};
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                for (std::size_t l = 0; l < 4; ++l) c[i][j] += factor * a[i][l] * b[l][j];
            }
        }
        return c;
    }
    double reference_m(double time_s) const {
        return std::min(hand_.start_m + hand_.speed_m_per_s * time_s, hand_.push_N / hand_.stiffness_N_per_m);
    }

    HandCase hand_;
    Matrix map_{};
    double position_m_, velocity_m_per_s_ = 0;
    long ticks_ = 0;
};

// What was put in now comes out `delay` ticks later; the first one until then.
class DelayLine {
  public:
    explicit DelayLine(std::size_t delay) : delay_(delay) {}
    double pass(double value) {
        values_.push_back(value);
        return values_.size() > delay_ ? values_[values_.size() - 1 - delay_] : values_.front();
    }

  private:
    std::size_t delay_;
    std::vector<double> values_;
};

}  // namespace thimble::test
