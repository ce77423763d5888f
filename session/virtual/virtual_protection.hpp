// What protects the six programs of a virtual session, each with a Security and random numbers of its own.
#pragma once

#include <array>
#include <memory>
#include <span>

#include "common/queue_channel.hpp"
#include "common/random.hpp"
#include "common/security/security.hpp"

namespace thimble {

// Without a lab key the channels are returned as they are.
class VirtualProtection {
  public:
    explicit VirtualProtection(const std::shared_ptr<const LabKey>& lab) {
        for (std::size_t role = 0; lab && role < of_.size(); ++role) {
            auto stream = std::make_shared<RandomStream>(
                StreamKey{1, 0, 0, static_cast<std::uint32_t>(role), Purpose::kInstance});
            of_[role] = std::make_unique<Security>(lab, [stream](std::span<std::uint8_t> bytes) {
                for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((*stream)());
            });
        }
    }

    Security* of(Role role) const { return of_[static_cast<std::size_t>(role)].get(); }
    Channel* pair(QueueChannel& wire, Port local, Port remote) const {
        Security* const security = of(owner(local));
        return security ? security->pair(wire, local, remote) : &wire;
    }
    Channel* inlet(QueueChannel& wire, Port local) const {
        Security* const security = of(owner(local));
        return security ? security->inlet(wire, local) : &wire;
    }
    Channel* outlet(Role self, QueueChannel& wire, Port remote) const {
        return of(self) ? of(self)->outlet(wire, remote) : &wire;
    }
    Channel* stop_end(Role self, QueueChannel& wire, StopEnd end) const {
        return of(self) ? of(self)->stop_end(wire, 0, end) : &wire;
    }
    SecurityCounters counters() const {
        SecurityCounters sum;
        for (const auto& one : of_) {
            if (one) sum.add(one->counters());
        }
        return sum;
    }

  private:
    std::array<std::unique_ptr<Security>, kRoleCount> of_;
};

}  // namespace thimble
