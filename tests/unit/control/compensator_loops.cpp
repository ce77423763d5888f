#include "tests/unit/control/compensator_loops.hpp"

#include <stdexcept>

#include "common/control/energy_bound.hpp"
#include "common/control/passivity_controller.hpp"
#include "common/control/wave_variables.hpp"

namespace thimble::test {

double LoopResult::swing_m() const {
    double low_m = last().position_m, high_m = low_m;
    for (std::size_t i = samples.size() - samples.size() / 10; i < samples.size(); ++i) {
        low_m = std::min(low_m, samples[i].position_m);
        high_m = std::max(high_m, samples[i].position_m);
    }
    return high_m - low_m;
}

LoopSample LoopResult::mean() const {
    LoopSample sum{};
    const std::size_t count = samples.size() / 10;
    for (std::size_t i = samples.size() - count; i < samples.size(); ++i) {
        sum.position_m += samples[i].position_m / static_cast<double>(count);
        sum.velocity_m_per_s += samples[i].velocity_m_per_s / static_cast<double>(count);
        sum.force_N += samples[i].force_N / static_cast<double>(count);
    }
    return sum;
}

LoopResult run_loop(const HandCase& hand, const Controller& controller, int ticks) {
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

Controller plain_wall(const HandCase& hand, std::size_t delay) {
    return [hand, line = DelayLine(delay)](double position_m, double) mutable {
        return std::clamp(hand.wall_N_per_m * std::max(line.pass(position_m), 0.0), 0.0, hand.limit_N);
    };
}

Controller at_the_handle(const HandCase& hand, std::size_t delay,
                         std::shared_ptr<PortCompensator> compensator) {
    return [wall = plain_wall(hand, delay), compensator = std::move(compensator), limit_N = hand.limit_N](
               double position_m, double force_held_N) {
        compensator->observe(kTick_s, position_m, force_held_N);
        return std::clamp(compensator->force_N(wall(position_m, 0)), -limit_N, limit_N);
    };
}

Controller with_waves(const HandCase& hand, std::size_t delay, double impedance_Ns_per_m) {
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

Controller named(const std::string& method, const HandCase& hand, std::size_t delay) {
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
