// Compensators with an end at the handle and one at the slave, as tables.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/control/built_in_controllers.hpp"
#include "common/control/two_port_passivity.hpp"
#include "common/control/wave_end.hpp"

namespace thimble {
namespace {

// The most that two-port passivity moves the proxy in a sample, at the hand: a small force would otherwise need a
// large step.
constexpr double kMostCorrection_m = 1e-3;

enum WaveKey { kImpedance, kSlaveDamping, kReconstruction, kRepeats, kJitter };

WaveBurst burst_of(const thimble_packet& packet) {
    WaveBurst burst;
    std::copy(std::begin(packet.value), std::end(packet.value), burst.wave_root_W.begin());
    burst.sum_root_W_s = packet.sum;
    burst.energy_J = packet.energy_J;
    burst.number = packet.number;
    burst.count = packet.count;
    return burst;
}

WaveChannelSettings channel_of(const thimble_controller_settings& s) {
    WaveChannelSettings channel;
    channel.reconstruction = static_cast<WaveReconstruction>(s.values[kReconstruction]);
    channel.repeats = static_cast<std::uint32_t>(s.values[kRepeats]);
    channel.sample_period_s = s.sample_period_s;
    return channel;
}

class WaveHandle {
  public:
    explicit WaveHandle(const thimble_controller_settings& s)
        : sample_period_(from_seconds(s.sample_period_s)),
          jitter_(from_seconds(s.values[kJitter])),
          repeats_(channel_of(s).repeats),
          master_({s.values[kImpedance], s.sample_period_s}),
          sender_(channel_of(s)),
          receiver_(channel_of(s)) {}
    void start(double delay_s) {
        master_.reset();
        sender_.reset();
        receiver_.reset(play_out_samples(delay_s));
        in_root_W_ = 0;
    }
    // Waves wait for the network from now on, or, where it is quicker, once those under way have come.
    void network_changed(double delay_s) { receiver_.play_out_after(play_out_samples(delay_s)); }
    void sample(const thimble_handle& handle, thimble_packet& out) {
        const WaveBurst& burst = sender_.add(master_.wave_out(handle.position_hand_m, handle.force_hand_N));
        in_root_W_ = receiver_.play(burst.number);
        out = packet_of(burst);
    }
    void hear(const thimble_packet& packet) { receiver_.receive(burst_of(packet)); }
    double force_N(const thimble_feedback& /*newest*/) const { return master_.force_N(in_root_W_); }

  private:
    // The answer to a sample cannot count for that sample: at least one.
    std::uint32_t play_out_samples(double delay_s) const {
        const Duration wait = from_seconds(delay_s) + jitter_;
        const auto samples = (wait + sample_period_ - Duration{1}) / sample_period_;
        return std::max(1U, static_cast<std::uint32_t>(samples) + repeats_);
    }

    Duration sample_period_, jitter_;
    std::uint32_t repeats_;
    WaveMaster master_;
    WaveSender sender_;
    WaveReceiver receiver_;
    double in_root_W_ = 0;
};

class WaveSlaveEnd {
  public:
    explicit WaveSlaveEnd(const thimble_controller_settings& s)
        : end_({s.values[kImpedance], s.sample_period_s, s.values[kSlaveDamping]}, channel_of(s),
               s.force_limit_N) {}
    void start() { end_.reset(); }
    std::uint32_t receive(const thimble_command& command, const thimble_packet& packet) {
        return end_.receive(command.position_hand_m, burst_of(packet));
    }
    double step_m(const thimble_surroundings& s) {
        return end_.step_m({s.plane_hand_m, s.stiffness_hand_N_per_m}, s.other_force_hand_N);
    }
    void answer(const thimble_feedback& /*felt*/, thimble_packet& out) const {
        out = packet_of(end_.burst());
    }
    void hold() {}

  private:
    WaveEnd end_;
};

class TwoPortHandle {
  public:
    explicit TwoPortHandle(const thimble_controller_settings& s)
        : settings_(s), master_({s.sample_period_s, 0}, s.values[0]) {}
    void start(double /*delay_s*/) {
        master_.reset();
        heard_J_ = 0;
    }
    void sample(const thimble_handle& handle, thimble_packet& out) {
        master_.observe(handle.position_hand_m, handle.force_hand_N);
        out.energy_J = master_.energy_in_J();
    }
    void hear(const thimble_packet& packet) { heard_J_ = packet.energy_J; }
    double force_N(const thimble_feedback& newest) {
        return master_.force_N(limited_N(newest.force_total_hand_N, settings_), heard_J_);
    }

  private:
    thimble_controller_settings settings_;
    TwoPortMaster master_;
    double heard_J_ = 0;
};

class TwoPortSlaveEnd {
  public:
    explicit TwoPortSlaveEnd(const thimble_controller_settings& s)
        : settings_(s), slave_(kMostCorrection_m) {}
    void start() {
        slave_.reset();
        force_held_hand_N_ = 0;
    }
    std::uint32_t receive(const thimble_command& command, const thimble_packet& packet) {
        position_hand_m_ = command.position_hand_m;
        heard_J_ = packet.energy_J;
        return command.newer;
    }
    double step_m(const thimble_surroundings& /*surroundings*/) {
        return slave_.move(position_hand_m_, force_held_hand_N_, heard_J_);
    }
    void answer(const thimble_feedback& felt, thimble_packet& out) {
        force_held_hand_N_ = limited_N(felt.force_total_hand_N, settings_);
        out.energy_J = slave_.energy_in_J();
    }
    void hold() { force_held_hand_N_ = 0; }

  private:
    thimble_controller_settings settings_;
    TwoPortSlave slave_;
    double position_hand_m_ = 0, heard_J_ = 0;
    double force_held_hand_N_ = 0;  // of the last answer
};

constexpr std::array kWaveKeys{
    thimble_controller_key{"wave_impedance_Ns_per_m", kByDefault.wave_impedance_Ns_per_m, 0.1, 1000,
                           "Impedance b of the wave variables."},
    thimble_controller_key{"wave_slave_damping_Ns_per_m", kByDefault.wave_slave_damping_Ns_per_m, 0, 1000,
                           "Damping of the slave."},
    thimble_controller_key{"wave_reconstruction", static_cast<double>(kByDefault.channel.reconstruction), 0,
                           3, "Replacement for waves that are lost or late."},
    thimble_controller_key{
        "wave_repeats", double{kByDefault.channel.repeats}, 0, double{WaveBurst::kMost - 1},
        "Number of earlier waves that each packet repeats; an overtaken packet counts as lost."},
    thimble_controller_key{"wave_jitter_s", to_seconds(kByDefault.jitter), 0, 1,
                           "Extra time of the play-out buffer, beyond the network's delay."}};
constexpr std::array kTwoPortKeys{kMostDamping};

thimble_controller wave_table() {
    thimble_controller table = named("wave", "Niemeyer and Slotine 1991", kWaveKeys);
    table.network_changed = [](void* self, double delay_s) {
        ControllerFunctions<WaveHandle>::of(self).network_changed(delay_s);
    };
    return with_slave<WaveSlaveEnd>(with_packets<WaveHandle>(with_handle<WaveHandle>(table)));
}

}  // namespace

const thimble_controller& wave_controller() {
    static const thimble_controller kTable = wave_table();
    return kTable;
}

const thimble_controller& two_port_controller() {
    static const thimble_controller kTable = with_slave<TwoPortSlaveEnd>(with_packets<TwoPortHandle>(
        with_handle<TwoPortHandle>(named("two-port", "Ryu, Artigas and Preusche 2010", kTwoPortKeys))));
    return kTable;
}

}  // namespace thimble
