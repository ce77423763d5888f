// A program of the same machine that speaks at every port of a session, without its key: broken bytes, impossible numbers, orders.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "common/codec.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/udp_channel.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {

inline constexpr std::uint64_t kHostileInstance = 0xBAD;
inline constexpr std::size_t kIdentifierAt = 4;

inline Header header_of(Role sender, std::uint32_t sequence, std::uint32_t trial) {
    return {kHostileInstance, from_nanoseconds(1'000'000'000), sequence, trial, sender};
}

inline NeedleCommand needle_at(double position_m) {
    NeedleCommand command;
    command.position_needle_m = command.position_needle_estimate_m = position_m;
    return command;
}

inline ForceFeedback wild_force() {
    ForceFeedback feedback;
    feedback.force_total_N = feedback.force_fixture_N = 1000;
    feedback.echo_time = from_nanoseconds(1);
    return feedback;
}

inline std::vector<std::uint8_t> datagram(const Header& header, const Body& body) {
    Encoder encoder;
    const Bytes bytes = encoder.encode(Message{header, body});
    return {bytes.begin(), bytes.end()};
}

// One of each that no receiver may decode: too short, cut off, of a foreign format, not finite, out of range,
// too long.
inline std::vector<std::vector<std::uint8_t>> broken_datagrams() {
    const Header header = header_of(Role::kMaster, 1, 1);
    const auto good = datagram(header, needle_at(0.01));
    const auto half = good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2);
    auto foreign = good;
    foreign[kIdentifierAt] ^= 0xFF;
    return {{0xDE, 0xAD},
            {good.begin(), half},
            foreign,
            datagram(header, needle_at(std::numeric_limits<double>::quiet_NaN())),
            datagram(header, needle_at(1e9)),
            std::vector<std::uint8_t>(kMaxDatagramBytes + 1, 0x55),
            std::vector<std::uint8_t>(20'000, 0x55)};
}

// Sends to every port of a session, from the peers' own host and from a foreign one.
class HostilePeer {
  public:
    explicit HostilePeer(std::uint16_t base_port) : broken_(broken_datagrams()) {
        const NetworkSettings network = network_at(base_port);
        for (std::size_t i = 0; i < static_cast<std::size_t>(Port::kCount); ++i) {
            const Endpoint target = network.at(static_cast<Port>(i));
            near_.push_back(std::make_unique<UdpChannel>(std::nullopt, target));
            far_.push_back(std::make_unique<UdpChannel>(Endpoint{"127.0.0.2", 0}, target));
        }
    }
    // everything broken, to every port
    void send_broken() {
        for (const auto& channel : near_) {
            for (const auto& bytes : broken_) channel->send(bytes);
        }
    }
    // broken nowhere, but from 127.0.0.2
    void send_from_strangers() {
        SessionControl shutdown;
        shutdown.kind = ControlKind::kShutdown;
        const auto order = datagram(header_of(Role::kSession, ++sequence_, 1), shutdown);
        for (const auto& channel : far_) channel->send(order);
    }
    // Flawless messages with the right role on the flows that a running HF trial has in use, but of another
    // instance: a needle elsewhere, wild forces, an end to everything.
    void send_as_second_sender(std::uint32_t trial) {
        ++sequence_;
        const auto command = datagram(header_of(Role::kMaster, sequence_, trial), needle_at(0.2));
        for (const Port port : {Port::kSlaveNeedle, Port::kNetemNeedle}) to(port).send(command);
        const auto force = datagram(header_of(Role::kSlaveSim, sequence_, trial), wild_force());
        for (const Port port : {Port::kMasterForce, Port::kCutaneousForce, Port::kVisualForce,
                                Port::kSessionRecord, Port::kNetemForceMaster}) {
            to(port).send(force);
        }
        SessionControl shutdown;
        shutdown.kind = ControlKind::kShutdown;
        const auto order = datagram(header_of(Role::kSession, sequence_, trial), shutdown);
        for (const Port port : {Port::kMasterControl, Port::kSlaveControl, Port::kCutaneousControl,
                                Port::kVisualControl, Port::kNetemControl}) {
            to(port).send(order);
        }
        Heartbeat failed;
        failed.state = NodeState::kFailed;
        to(Port::kSessionMaster).send(datagram(header_of(Role::kMaster, sequence_, trial), failed));
    }

  private:
    UdpChannel& to(Port port) { return *near_[static_cast<std::size_t>(port)]; }

    std::vector<std::unique_ptr<UdpChannel>> near_, far_;  // by Port
    std::vector<std::vector<std::uint8_t>> broken_;
    std::uint32_t sequence_ = 0;
};

}  // namespace thimble
