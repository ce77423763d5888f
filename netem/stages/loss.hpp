// Which packets are lost: LossSettings, one packet after the other.
//
// Gilbert-Elliott (Gilbert 1960; Elliott 1963): the packet is lost with the probability of the state it finds. Four
// states (Salsano, Ludovici, Ordine and Giannuzzi 2012, "Definition of a general and intuitive loss model for packet
// networks and its implementation in the Netem module"): lost in states 3 and 4. The chain moves by one number per
// packet and starts in its stationary distribution, so the share of lost packets is stationary_loss() from packet 0.
#pragma once

#include <cstdint>

#include "netem/link_settings.hpp"
#include "netem/stages/packet_numbers.hpp"

namespace thimble {

class Loss {
  public:
    Loss(const StreamKey& key, std::uint32_t direction)
        : losses_(link_key(key, direction, Purpose::kLinkLoss)),
          moves_(link_key(key, direction, Purpose::kLinkChain)) {}

    // Other chain settings start a chain anew at the next packet.
    void configure(const LossSettings& settings);

    // Asked once for each packet, in order.
    bool lost(std::uint64_t packet);
    // With a probability from elsewhere (a trace).
    bool lost(std::uint64_t packet, double probability) {
        return probability > 0 && losses_.uniform(packet) < probability;
    }

  private:
    bool lost_by_gilbert_elliott(std::uint64_t packet);
    bool lost_by_four_state(std::uint64_t packet);

    LossSettings settings_{};
    PacketNumbers losses_;
    PacketNumbers moves_;
    bool begun_ = false;
    bool bad_ = false;
    int state_ = 1;  // of the four
};

}  // namespace thimble
