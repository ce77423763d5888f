// The hand against the wall through each compensator, over an ideal network: nothing towards the wall, a constant delay back.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/control/energy_bound.hpp"
#include "common/control/local_fixture.hpp"
#include "common/control/passivity_controller.hpp"
#include "common/control/port_compensator.hpp"
#include "common/control/port_observer.hpp"
#include "common/control/wave_variables.hpp"

namespace thimble::test {

// The hand of tests/golden/compensators.json: m x" + b x' + k (x - x_d) = -F, exact for a held F and a straight x_d, read by an
// encoder; it approaches a wall at 0 and pushes with F_0 there.
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

// Returns each value `delay` ticks later; before that the first one.
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

// Once per tick: the reading and the force held on the way there; the force until the next tick.
using Controller = std::function<double(double position_m, double force_held_N)>;

struct LoopSample {
    double position_m, velocity_m_per_s, force_N;  // the force that was held until here
};

struct LoopResult {
    std::vector<LoopSample> samples;  // of each tick, from 0
    double least_J = 0, last_J = 0;   // work of the hand, true positions
    const LoopSample& last() const { return samples.back(); }
    // Of the last tenth.
    double swing_m() const {
        double low_m = last().position_m, high_m = low_m;
        for (std::size_t i = samples.size() - samples.size() / 10; i < samples.size(); ++i) {
            low_m = std::min(low_m, samples[i].position_m);
            high_m = std::max(high_m, samples[i].position_m);
        }
        return high_m - low_m;
    }
    LoopSample mean() const {
        LoopSample sum{};
        const std::size_t count = samples.size() / 10;
        for (std::size_t i = samples.size() - count; i < samples.size(); ++i) {
            sum.position_m += samples[i].position_m / static_cast<double>(count);
            sum.velocity_m_per_s += samples[i].velocity_m_per_s / static_cast<double>(count);
            sum.force_N += samples[i].force_N / static_cast<double>(count);
        }
        return sum;
    }
};

inline LoopResult run_loop(const HandCase& hand, const Controller& controller, int ticks) {
    HeldHand held(hand);
    PortObserver port;
    LoopResult result;
    result.samples.reserve(static_cast<std::size_t>(ticks) + 1);
    double force_N = 0;
    for (int tick = 0; tick <= ticks; ++tick) {
        port.add(held.position_m(), force_N);
        result.least_J = std::min(result.least_J, port.energy_in_J());
        result.samples.push_back({held.position_m(), held.velocity_m_per_s(), force_N});
        force_N = controller(held.reading_m(), force_N);
        held.advance(force_N);
    }
    result.last_J = port.energy_in_J();
    return result;
}

// Pairs of places in a wall at 40 mm and its forces.
inline void learn_wall(LocalFixture& fixture, double stiffness_N_per_m) {
    for (int i = 0; i < 400; ++i) {
        const double inside_m = 5e-4 + 3e-4 * std::sin(0.1 * i);
        fixture.learn(0.04 + inside_m, stiffness_N_per_m * inside_m);
    }
}

// Reading -> wall force, delayed.
inline Controller plain_wall(const HandCase& hand, std::size_t delay) {
    return [hand, line = DelayLine(delay)](double position_m, double) mutable {
        return std::clamp(hand.wall_N_per_m * std::max(line.pass(position_m), 0.0), 0.0, hand.limit_N);
    };
}
// The same, with a compensator at the handle and its force limited.
inline Controller at_the_handle(const HandCase& hand, std::size_t delay,
                                std::shared_ptr<PortCompensator> compensator) {
    return [wall = plain_wall(hand, delay), compensator = std::move(compensator), limit_N = hand.limit_N](
               double position_m, double force_held_N) {
        compensator->observe(kTick_s, position_m, force_held_N);
        return std::clamp(compensator->force_N(wall(position_m, 0)), -limit_N, limit_N);
    };
}
inline Controller with_waves(const HandCase& hand, std::size_t delay, double impedance_Ns_per_m) {
    struct Waves {
        WaveMaster master;
        WaveSlave slave;
        std::vector<double> back;
    };
    const WaveSettings settings{impedance_Ns_per_m, kTick_s};
    auto waves = std::make_shared<Waves>(Waves{WaveMaster(settings), WaveSlave(settings), {}});
    return [hand, delay, waves](double position_m, double force_held_N) {
        if (waves->back.empty()) waves->slave.place(position_m);
        const double u = waves->master.wave_out(position_m, force_held_N);
        waves->back.push_back(waves->slave.step(u, {0, hand.wall_N_per_m}, 0, hand.limit_N));
        const std::size_t sent = waves->back.size();
        const double w = sent > delay ? waves->back[sent - 1 - delay] : 0;
        return std::clamp(waves->master.force_N(w), -hand.limit_N, hand.limit_N);
    };
}
// "hf", "wave", "tdpa", "eba", "ebalc", "tank" with the numbers of the golden traces.
inline Controller named(const std::string& method, const HandCase& hand, std::size_t delay) {
    const PortSettings port{kTick_s, 0.5};
    if (method == "hf") return plain_wall(hand, delay);
    if (method == "wave") return with_waves(hand, delay, 20);
    if (method == "tdpa")
        return at_the_handle(hand, delay, std::make_shared<PassivityController>(port, 1000));
    if (method == "eba") return at_the_handle(hand, delay, std::make_shared<MemorylessBound>(port));
    if (method == "ebalc") return at_the_handle(hand, delay, std::make_shared<LeastConservativeBound>(port));
    if (method == "tank")
        return at_the_handle(hand, delay, std::make_shared<TwoLayerTank>(port, TankSettings{0.05, 10}));
    throw std::invalid_argument(method);
}

}  // namespace thimble::test
