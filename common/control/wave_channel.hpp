// Waves over a network that delays, reorders and loses. Only one way of putting them together again is passive and keeps the
// force; the others are here to show why not.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/messages.hpp"

namespace thimble {

enum class WaveReconstruction : std::uint8_t {
    // Each wave once, at its own sample + play_out; none came: 0. Passive, and lossless as long as every wave comes, itself
    // or repeated, within that time.
    kPlayOut,
    // The newest that came, again and again. Not passive: u = 1, then n samples lost of a sender that sends 0, gives out
    // n h / 2 too much.
    kHoldLast,
    // Those that come, each when it comes, the newest of several; 0 between. Passive, but loss and jitter take a steady force
    // away within half a second.
    kZeroFill,
    // As much as sums and energies in the packets allow: u = (U_rx - U_out) / (catch_up h) within
    // +-sqrt(2 (E_rx - E_out) / h). Passive by construction; keeps little of a steady force.
    kEnergyLimited,
};
inline constexpr std::array<std::string_view, 4> kWaveReconstructionNames{"play-out", "hold-last",
                                                                          "zero-fill", "energy-limited"};

struct WaveChannelSettings {
    WaveReconstruction reconstruction = WaveReconstruction::kPlayOut;
    std::uint32_t repeats = 3;  // r: waves that are sent again; below WaveBurst::kMost
    double catch_up = 10;       // kEnergyLimited, samples; >= 1
    double sample_period_s = 1e-3;
};

class WaveSender {
  public:
    explicit WaveSender(const WaveChannelSettings& settings);  // repeats asserted
    void reset() {
        burst_ = {};
        first_ = true;
    }
    // The next sample has this number, and what was before it is not sent again.
    void skip_to(std::uint32_t number) {
        burst_.number = number;
        burst_.count = 0;
        first_ = true;
    }
    // The next sample's wave, into what is to be sent now.
    const WaveBurst& add(double wave_root_W);

  private:
    WaveChannelSettings settings_;
    WaveBurst burst_;
    bool first_ = true;
};

class WaveReceiver {
  public:
    // play_out_samples: kPlayOut; from the sample at which a wave was made to that at which it is played.
    explicit WaveReceiver(const WaveChannelSettings& settings, std::uint32_t play_out_samples = 0);
    void reset(std::uint32_t play_out_samples);
    // While it runs. A longer time holds at once. A shorter one holds once the waves made before have come, which takes the old
    // time. A wave that was played is not played again, and one that is then overdue is left out: both are passive.
    void play_out_after(std::uint32_t samples);

    // In any order, any number of times. Not a number, or a count beyond kMost: refused.
    void receive(const WaveBurst& burst);
    // The wave for sample `number`; asked once for each, in order.
    double play(std::uint32_t number);

    std::uint64_t missing() const { return missing_; }  // waves that were due and had not come
    double energy_out_J() const { return energy_out_J_; }

  private:
    // Waits for more than any network delays; older ones are overwritten, which is a loss.
    static constexpr std::size_t kSlots = 16384;
    struct Slot {
        std::int64_t number = -1;
        double wave_root_W = 0;
    };
    double next(std::uint32_t number);
    double next_in_time(std::int64_t due);
    double next_by_energy() const;

    WaveChannelSettings settings_;
    std::int64_t play_out_;
    std::int64_t next_play_out_, next_from_ = 0;  // holds from sample next_from_ on
    std::vector<Slot> slots_;
    std::int64_t asked_ = -1, played_ = -1, newest_ = -1;
    bool fresh_ = false;
    WaveBurst latest_;
    double sum_out_root_W_s_ = 0, energy_out_J_ = 0;
    std::uint64_t missing_ = 0;
};

}  // namespace thimble
