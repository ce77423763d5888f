#include "common/control/wave_channel.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace thimble {

WaveSender::WaveSender(const WaveChannelSettings& settings) : settings_(settings) {
    assert(settings.repeats < WaveBurst::kMost);
}

const WaveBurst& WaveSender::add(double wave_root_W) {
    std::copy_backward(burst_.wave_root_W.begin(), burst_.wave_root_W.end() - 1, burst_.wave_root_W.end());
    burst_.wave_root_W.front() = wave_root_W;
    burst_.count = std::min(burst_.count + 1, settings_.repeats + 1);
    if (!first_) ++burst_.number;
    first_ = false;
    burst_.sum_root_W_s += wave_root_W * settings_.sample_period_s;
    burst_.energy_J += 0.5 * wave_root_W * wave_root_W * settings_.sample_period_s;
    return burst_;
}

WaveReceiver::WaveReceiver(const WaveChannelSettings& settings, std::uint32_t play_out_samples)
    : settings_(settings), play_out_(play_out_samples), next_play_out_(play_out_samples) {
    if (settings.reconstruction == WaveReconstruction::kPlayOut) slots_.resize(kSlots);
}

void WaveReceiver::reset(std::uint32_t play_out_samples) {
    std::fill(slots_.begin(), slots_.end(), Slot{});
    play_out_ = next_play_out_ = play_out_samples;
    next_from_ = 0;
    asked_ = played_ = newest_ = -1;
    fresh_ = false;
    latest_ = {};
    sum_out_root_W_s_ = energy_out_J_ = 0;
    missing_ = 0;
}

void WaveReceiver::play_out_after(std::uint32_t samples) {
    if (samples == next_play_out_) return;
    next_play_out_ = samples;
    next_from_ = samples < play_out_ ? asked_ + play_out_ + 1 : asked_;
}

void WaveReceiver::receive(const WaveBurst& burst) {
    if (burst.count > WaveBurst::kMost || burst.count > std::int64_t{burst.number} + 1) return;
    if (!std::isfinite(burst.sum_root_W_s) || !std::isfinite(burst.energy_J)) return;
    for (std::uint32_t i = 0; i < burst.count; ++i) {
        if (!std::isfinite(burst.wave_root_W[i])) return;
    }
    for (std::uint32_t i = 0; i < burst.count && !slots_.empty(); ++i) {
        const std::int64_t number = std::int64_t{burst.number} - i;
        Slot& slot = slots_[static_cast<std::size_t>(number) % kSlots];
        if (number > slot.number) slot = {number, burst.wave_root_W[i]};
    }
    if (burst.count == 0 || burst.number <= newest_) return;
    newest_ = burst.number;
    latest_ = burst;
    fresh_ = true;
}

double WaveReceiver::play(std::uint32_t number) {
    asked_ = number;
    if (asked_ >= next_from_) play_out_ = next_play_out_;
    const double wave_root_W = next(number);
    const double h_s = settings_.sample_period_s;
    sum_out_root_W_s_ += wave_root_W * h_s;
    energy_out_J_ += 0.5 * wave_root_W * wave_root_W * h_s;
    return wave_root_W;
}

double WaveReceiver::next(std::uint32_t number) {
    switch (settings_.reconstruction) {
        case WaveReconstruction::kPlayOut:
            return next_in_time(number - play_out_);
        case WaveReconstruction::kHoldLast:
            return latest_.wave_root_W.front();
        case WaveReconstruction::kZeroFill: {
            const double wave_root_W = fresh_ ? latest_.wave_root_W.front() : 0;
            missing_ += fresh_ ? 0 : 1;
            fresh_ = false;
            return wave_root_W;
        }
        default:
            return next_by_energy();
    }
}

double WaveReceiver::next_in_time(std::int64_t due) {
    if (due <= played_) return 0;
    played_ = due;
    const Slot& slot = slots_[static_cast<std::size_t>(due) % kSlots];
    if (slot.number == due) return slot.wave_root_W;
    ++missing_;
    return 0;
}

double WaveReceiver::next_by_energy() const {
    const double h_s = settings_.sample_period_s;
    const double owed_root_W = (latest_.sum_root_W_s - sum_out_root_W_s_) / (settings_.catch_up * h_s);
    const double spare_J = std::max(0.0, latest_.energy_J - energy_out_J_);
    const double most_root_W = std::sqrt(2 * spare_J / h_s);
    return std::clamp(owed_root_W, -most_root_W, most_root_W);
}

}  // namespace thimble
