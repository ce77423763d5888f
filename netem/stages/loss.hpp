// Which packets are lost: LossSettings, one packet after the other.
//
// Gilbert-Elliott (Gilbert 1960; Elliott 1963): the packet is lost with the probability of the state it finds. Four
// states (Salsano, Ludovici, Ordine and Giannuzzi 2012, "Definition of a general and intuitive loss model for packet
// networks and its implementation in the Netem module"): lost in states 3 and 4. The chain moves by one number per
// packet and starts in its stationary distribution, so the share of lost packets is stationary_loss() from packet 0.
#pragma once

#include <array>
#include <cstdint>

#include "netem/link_settings.hpp"
#include "netem/stages/packet_numbers.hpp"

namespace thimble {

// State after a move by `u` from state 1, 2, 3 or 4.
inline int next_state(const LossSettings& loss, int state, double u) {
    switch (state) {
        case 1:
            if (u < loss.p13) return 3;
            return u < loss.p13 + loss.p14 ? 4 : 1;
        case 2:
            return u < loss.p23 ? 3 : 2;
        case 3:
            if (u < loss.p31) return 1;
            return u < loss.p31 + loss.p32 ? 2 : 3;
        default:
            return 1;
    }
}

inline int stationary_state(const LossSettings& loss, double u) {
    const std::array<double, 4> shares = four_state_shares(loss);
    double sum = 0;
    for (int state = 1; state < 4; ++state) {
        sum += shares[static_cast<std::size_t>(state - 1)];
        if (u < sum) return state;
    }
    return shares[3] > 0 ? 4 : 1;  // not a state that rounding alone would reach
}

class Loss {
  public:
    Loss(const StreamKey& key, std::uint32_t direction)
        : losses_(link_key(key, direction, Purpose::kLinkLoss)),
          moves_(link_key(key, direction, Purpose::kLinkChain)) {}

    // Other chain settings start a chain anew at the next packet.
    void configure(const LossSettings& settings) {
        if (settings != settings_) begun_ = false;
        settings_ = settings;
    }

    // Asked once for each packet, in order.
    bool lost(std::uint64_t packet) {
        switch (settings_.shape) {
            case LossShape::kNone:
                return false;
            case LossShape::kIndependent:
                return lost(packet, settings_.probability);
            case LossShape::kGilbertElliott:
                return lost_by_gilbert_elliott(packet);
            case LossShape::kFourState:
                return lost_by_four_state(packet);
        }
        return false;
    }

    // With a probability from elsewhere (a trace).
    bool lost(std::uint64_t packet, double probability) {
        return probability > 0 && losses_.uniform(packet) < probability;
    }

  private:
    bool lost_by_gilbert_elliott(std::uint64_t packet) {
        const double u = moves_.uniform(packet);
        if (!begun_) {
            bad_ = u < share_in_bad(settings_);
        } else {
            bad_ = bad_ ? u >= settings_.bad_to_good : u < settings_.good_to_bad;
        }
        begun_ = true;
        return lost(packet, bad_ ? settings_.loss_in_bad : settings_.loss_in_good);
    }

    bool lost_by_four_state(std::uint64_t packet) {
        const double u = moves_.uniform(packet);
        state_ = begun_ ? next_state(settings_, state_, u) : stationary_state(settings_, u);
        begun_ = true;
        return state_ >= 3;
    }

    LossSettings settings_{};
    PacketNumbers losses_;
    PacketNumbers moves_;
    bool begun_ = false;
    bool bad_ = false;
    int state_ = 1;  // of the four
};

}  // namespace thimble
