#include "study/maps/compensated_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "common/control/two_port_passivity.hpp"
#include "common/error.hpp"

namespace thimble {
namespace {

constexpr double kSameInstant = 1e-9;  // of a step
constexpr double kMostWaiting = 1e7;   // packets

// True for compensators whose force comes from a model at the handle.
bool gives_own_force(Compensator compensator) {
    return compensator == Compensator::kLocalFixture || compensator == Compensator::kAdaptiveFixture ||
           compensator == Compensator::kFourChannel;
}

HandleControlScale scale_of(const LoopConditions& loop) {
    const double limit_N =
        loop.force_limit_N > 0 ? loop.force_limit_N : std::numeric_limits<double>::infinity();
    return {1, 1, limit_N, from_seconds(loop.loop.step_s)};
}

const CompensatedConditions& checked(const CompensatedConditions& c) {
    const bool network = c.jitter_s >= 0 && c.loss >= 0 && c.loss < 1 && c.mean_burst >= 1 &&
                         c.loss <= c.mean_burst / (1 + c.mean_burst) &&
                         (c.loop.loop.delay_s + c.jitter_s) / c.loop.loop.step_s < kMostWaiting;
    if (network) return c;
    throw Error(ExitCode::kUsage,
                "sweep: jitter must be 0 s or more, loss 0 to 0.5 (with longer bursts up to burst / (1 + "
                "burst)), and delay and jitter together below 1e7 steps");
}

HandMotion checked_motion(const CompensatedConditions& c, double position_m, double velocity_m_per_s) {
    const LoopSimulator refuses_what_is_none(c.loop, position_m, velocity_m_per_s);
    HandMotion hand(c.loop.loop.hand, position_m, velocity_m_per_s);
    hand.rub(c.loop.friction_N);
    return hand;
}

}  // namespace

struct CompensatedLoop::Packet {
    std::int64_t number = 0;
    double rest_s = 0;  // of its arrival after the sample
    double position_m = 0, force_N = 0;
    double energy_in_J = 0;  // two ports: of the wall's end
    WaveBurst burst;
};

struct CompensatedLoop::Waves {
    WaveMaster master;
    WaveSlave slave;
    WaveSender sender;
    WaveReceiver receiver;
    std::uint32_t play_out = 0;
};

struct CompensatedLoop::TwoPorts {
    TwoPortMaster master;
    TwoPortWall wall;
    double heard_J = 0;  // of the wall's end, as it came last
};

CompensatedLoop::CompensatedLoop(const CompensatedConditions& conditions, double position_m,
                                 double velocity_m_per_s)
    : conditions_(checked(conditions)),
      hand_(checked_motion(conditions, position_m, velocity_m_per_s)),
      step_s_(conditions.loop.loop.step_s),
      delays_({conditions.seed, 0, 0, 0, Purpose::kLinkDelay}),
      losses_({conditions.seed, 0, 0, 0, Purpose::kLinkLoss}) {
    const double longest = (conditions.loop.loop.delay_s + conditions.jitter_s) / step_s_;
    arriving_.resize(static_cast<std::size_t>(longest) + 2);
    for (std::vector<Packet>& packets : arriving_) packets.reserve(2);
    const ControlSettings& c = conditions.control;
    if (c.compensator == Compensator::kTwoPort) {
        two_ports_ = std::make_unique<TwoPorts>(
            TwoPorts{TwoPortMaster({step_s_, 0}, c.most_damping_Ns_per_m),
                     TwoPortWall(0, conditions.loop.loop.stiffness_N_per_m, force_limit_N())});
    }
    if (c.compensator != Compensator::kWave) {
        if (c.compensator == Compensator::kNone || two_ports_) return;
        end_ = std::make_unique<HandleEnd>(c, scale_of(conditions.loop));
        end_->start(from_seconds(conditions.loop.loop.delay_s + conditions.jitter_s));
        own_force_ = gives_own_force(c.compensator);
        if (!end_->has(THIMBLE_BOTH_ENDS)) return;
        slave_end_ = std::make_unique<SlaveEnd>(c, scale_of(conditions.loop));
        slave_end_->start();
        return;
    }
    WaveChannelSettings channel = c.channel;
    channel.sample_period_s = step_s_;
    if (conditions.loss == 0) channel.repeats = 0;
    const auto play_out = static_cast<std::uint32_t>(std::ceil(longest - kSameInstant)) + channel.repeats;
    const WaveSettings at_hand{c.wave_impedance_Ns_per_m, step_s_};
    const WaveSettings at_wall{c.wave_impedance_Ns_per_m, step_s_, c.wave_slave_damping_Ns_per_m};
    waves_ = std::make_unique<Waves>(Waves{WaveMaster(at_hand), WaveSlave(at_wall), WaveSender(channel),
                                           WaveReceiver(channel, play_out), play_out});
    waves_->slave.place(position_m);
}

CompensatedLoop::~CompensatedLoop() = default;

double CompensatedLoop::force_limit_N() const {
    const double limit_N = conditions_.loop.force_limit_N;
    return limit_N > 0 ? limit_N : std::numeric_limits<double>::infinity();
}

double CompensatedLoop::sampled_m() const {
    const double step_m = conditions_.loop.encoder_step_m;
    return step_m > 0 ? step_m * std::round(position_m() / step_m) : position_m();
}

double CompensatedLoop::effective_delay_s() const {
    if (waves_) return (waves_->play_out + 0.5) * step_s_;
    return aged_s_ > 0 ? age_s2_ / aged_s_ : std::numeric_limits<double>::quiet_NaN();
}

// Gilbert's chain, as netem's: found in a state, then moved.
bool CompensatedLoop::lost() {
    const double p = conditions_.loss, burst = conditions_.mean_burst;
    if (p == 0) return false;
    if (burst == 1) return losses_.uniform() < p;
    const bool now = losing_;
    const double leave = 1 / burst, enter = p * leave / (1 - p);
    losing_ = losses_.uniform() < (now ? 1 - leave : enter);
    return now;
}

void CompensatedLoop::send(double reading_m) {
    const LoopConditions& loop = conditions_.loop;
    Packet packet;
    packet.number = sample_;
    packet.position_m = reading_m;
    if (waves_) {
        const double u = waves_->master.wave_out(reading_m, force_N_);
        packet.burst =
            waves_->sender.add(waves_->slave.step(u, {0, loop.loop.stiffness_N_per_m}, 0, force_limit_N()));
    } else if (two_ports_) {
        packet.force_N = two_ports_->wall.force_N(reading_m, two_ports_->master.energy_in_J());
        packet.energy_in_J = two_ports_->wall.energy_in_J();
    } else if (slave_end_) {
        meet_wall(reading_m, packet);
    } else {
        packet.force_N = loop.loop.stiffness_N_per_m * std::max(reading_m, 0.0);
    }
    const double late_s = conditions_.jitter_s > 0 ? conditions_.jitter_s * delays_.uniform() : 0;
    if (lost()) return;
    const double steps = (loop.loop.delay_s + late_s) / step_s_;
    const double whole = std::floor(steps + kSameInstant);
    packet.rest_s = steps - whole > kSameInstant ? (steps - whole) * step_s_ : 0;
    const auto due = static_cast<std::size_t>(sample_) + static_cast<std::size_t>(whole);
    arriving_[due % arriving_.size()].push_back(packet);
}

// The needle goes where the slave's end leads it.
void CompensatedLoop::meet_wall(double reading_m, Packet& packet) {
    const double stiffness_N_per_m = conditions_.loop.loop.stiffness_N_per_m;
    NeedleWave message;
    message.command.position_hand_m = reading_m;
    message.command.force_hand_N = force_N_;
    message.waves = sent_;
    for (std::uint32_t left = slave_end_->receive(message, true); left > 0; --left)
        packet.position_m = slave_end_->step_hand_m({0, stiffness_N_per_m, 0});
    packet.force_N = stiffness_N_per_m * std::max(packet.position_m, 0.0);
    thimble_feedback felt{};
    felt.position_hand_m = packet.position_m;
    felt.force_total_hand_N = felt.force_fixture_hand_N = packet.force_N;
    felt.known = 1;
    packet.burst = slave_end_->answer(felt);
}

void CompensatedLoop::deliver(const Packet& packet) {
    if (waves_) waves_->receiver.receive(packet.burst);
    if (packet.number <= newest_) return;  // overtaken
    newest_ = packet.number;
    asked_N_ = packet.force_N;
    if (two_ports_) two_ports_->heard_J = packet.energy_in_J;
    if (!end_) return;
    if (slave_end_) end_->receive(packet.burst);
    thimble_feedback feedback{};
    feedback.position_hand_m = packet.position_m;
    feedback.force_total_hand_N = feedback.force_fixture_hand_N = packet.force_N;
    feedback.age_s = static_cast<double>(sample_ - packet.number) * step_s_ + packet.rest_s;
    feedback.known = 1;
    end_->receive(feedback);
}

void CompensatedLoop::set_force() {
    const double limit_N = conditions_.loop.force_limit_N;
    double wanted_N = end_ ? end_->force_N() : asked_N_;
    if (two_ports_) wanted_N = two_ports_->master.force_N(asked_N_, two_ports_->heard_J);
    if (waves_) wanted_N = waves_->master.force_N(waves_->receiver.play(static_cast<std::uint32_t>(sample_)));
    force_N_ = limit_N > 0 ? std::clamp(wanted_N, -limit_N, limit_N) : wanted_N;
    asked_of_ = newest_;
}

Propagator CompensatedLoop::propagator(double duration_s) {
    constexpr std::size_t kMostKnown = 3;  // the parts of a step, where delays do not vary
    for (const Propagator& p : known_) {
        if (p.duration_s == duration_s) return p;
    }
    const Propagator p = hand_.propagator(duration_s);
    if (known_.size() < kMostKnown) known_.push_back(p);
    return p;
}

void CompensatedLoop::move(double from_s, double to_s) {
    const double duration_s = to_s - from_s, from_m = position_m();
    hand_.advance(propagator(duration_s), conditions_.loop.press_N - force_N_);
    energy_J_ += force_N_ * (position_m() - from_m);
    if (asked_of_ < 0 || own_force_) return;
    const double age_s = static_cast<double>(sample_ - asked_of_) * step_s_ + (from_s + to_s) / 2;
    age_s2_ += age_s * duration_s;
    aged_s_ += duration_s;
}

void CompensatedLoop::step() {
    const double reading_m = sampled_m();
    if (end_) {
        const SessionTime now{sample_ * from_seconds(step_s_)};
        sent_ =
            end_->sample(now, reading_m, sample_ > 0 ? (reading_m - read_before_m_) / step_s_ : 0, force_N_);
        read_before_m_ = reading_m;
    }
    if (two_ports_) two_ports_->master.observe(reading_m, force_N_);
    send(reading_m);
    std::vector<Packet>& arrived = arriving_[static_cast<std::size_t>(sample_) % arriving_.size()];
    std::sort(arrived.begin(), arrived.end(), [](const Packet& a, const Packet& b) {
        return a.rest_s != b.rest_s ? a.rest_s < b.rest_s : a.number < b.number;
    });
    auto next = arrived.begin();
    for (; next != arrived.end() && next->rest_s == 0; ++next) deliver(*next);
    set_force();
    double done_s = 0;
    for (; next != arrived.end(); ++next) {
        if (at_once()) move(std::exchange(done_s, next->rest_s), next->rest_s);
        deliver(*next);
        if (at_once()) set_force();
    }
    move(done_s, step_s_);
    arrived.clear();
    ++sample_;
}

}  // namespace thimble
