#include "tests/unit/security/security_rig.hpp"

#include <array>

#include "common/random.hpp"

namespace thimble {

void TestWire::send(Bytes datagram) {
    said.emplace_back(datagram.begin(), datagram.end());
    if (peer_ != nullptr && !cut) peer_->deliver(said.back());
}

Bytes TestWire::take() {
    if (waiting_.empty()) return {};
    taken_ = std::move(waiting_.front());
    waiting_.pop_front();
    return taken_;
}

RandomBytes seeded_bytes(std::uint64_t seed) {
    auto stream = std::make_shared<RandomStream>(StreamKey{seed, 0, 0, 0, Purpose::kInstance});
    return [stream](std::span<std::uint8_t> bytes) {
        for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((*stream)());
    };
}

std::shared_ptr<const LabKey> test_lab_key(std::uint8_t byte) {
    std::array<std::uint8_t, kKeyBytes> bytes{};
    bytes.fill(byte);
    return std::make_shared<const LabKey>(bytes);
}

Bytes bytes_of(std::string_view text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string received(Channel& channel) {
    const Bytes bytes = channel.receive();
    return {bytes.begin(), bytes.end()};
}

std::string hex(std::span<const std::uint8_t> bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    for (const std::uint8_t byte : bytes) {
        text += kDigits[byte >> 4U];
        text += kDigits[byte & 15U];
    }
    return text;
}

PairRig::PairRig(const SecurityTimes& t) : times(t) {
    restart_session();
    restart_node();
}

void PairRig::turn(Duration later) {
    now += later;
    for (int i = 0; i < 6; ++i) {
        for (SecurePair* end : {session.get(), node.get()}) {
            end->tick(now);
            while (!end->receive().empty()) {
            }
        }
    }
}

void PairRig::restart_session(const std::shared_ptr<const LabKey>& lab) {
    session_lab = lab;
    while (!wire.a.receive().empty()) {
    }
    session = std::make_unique<SecurePair>(wire.a, *session_lab,
                                           SecurePair::Ends{Port::kSessionMaster, Port::kMasterControl},
                                           seeded_bytes(100 + ++lives_), times);
}

void PairRig::restart_node(const std::shared_ptr<const LabKey>& lab) {
    node_lab = lab;
    while (!wire.b.receive().empty()) {
    }
    node = std::make_unique<SecurePair>(wire.b, *node_lab,
                                        SecurePair::Ends{Port::kMasterControl, Port::kSessionMaster},
                                        seeded_bytes(100 + ++lives_), times);
}

}  // namespace thimble
