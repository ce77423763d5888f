// Wave variables as they travel: the newest sample's and those of a few samples before it, so that single losses lose
// nothing. A wave has the unit of a root of power; what travels in h is its square, half of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace thimble {

struct WaveBurst {
    static constexpr std::size_t kMost = 8;

    std::array<double, kMost> wave_root_W{};  // newest first
    double sum_root_W_s = 0;                  // of all waves until the newest, x h
    double energy_J = 0;                      // of all waves until the newest, sum of u^2 h / 2
    std::uint32_t number = 0;                 // of the newest, from 0 in each trial
    std::uint32_t count = 0;                  // how many there are, at most kMost

    bool operator==(const WaveBurst&) const = default;
};

}  // namespace thimble
