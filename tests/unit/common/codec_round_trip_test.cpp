// Every message of a node arrives as it was sent.
#include <algorithm>
#include <bit>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/codec.hpp"
#include "tests/fuzz/packets.hpp"
#include "tests/unit/common/packet.hpp"
#include "tests/unit/master/allocation_count.hpp"

namespace thimble {
namespace {

constexpr std::int64_t kMaxStamp_ns = std::int64_t{1} << 62;

// Legal numbers, with a taste for the edges. Two draws: where, then how far.
double draw(double low, double high) {
    switch (*rc::gen::inRange(0, 8)) {
        case 0:
            return low;
        case 1:
            return high;
        case 2:
            return low < 0 ? -0.0 : 0.0;
        case 3:
            return std::numeric_limits<double>::denorm_min();
        case 4:
            return low < 0 ? -std::numeric_limits<double>::min() : std::numeric_limits<double>::min();
        default:
            return low + (high - low) * static_cast<double>(*rc::gen::inRange<std::int64_t>(0, 1LL << 53)) *
                             0x1p-53;
    }
}
double draw(double limit) { return draw(-limit, limit); }

std::int64_t draw_stamp() {
    switch (*rc::gen::inRange(0, 3)) {
        case 0:
            return 0;
        case 1:
            return kMaxStamp_ns;
        default:
            return *rc::gen::inRange<std::int64_t>(0, kMaxStamp_ns);
    }
}

template <class Unsigned>
Unsigned draw_bits() {
    return *rc::gen::oneOf(rc::gen::just(std::numeric_limits<Unsigned>::max()), rc::gen::just(Unsigned{0}),
                           rc::gen::arbitrary<Unsigned>());
}

template <class Enum>
Enum draw_enum(Enum last) {
    return static_cast<Enum>(*rc::gen::inRange(0, static_cast<int>(last) + 1));
}

bool draw_bool() { return *rc::gen::arbitrary<bool>(); }

Header draw_header() {
    return {draw_bits<std::uint64_t>(), from_nanoseconds(draw_stamp()), draw_bits<std::uint32_t>(),
            draw_bits<std::uint32_t>(), draw_enum(Role::kExperimenter)};
}

NetworkName draw_network() {
    static constexpr std::array<std::string_view, 5> kNames{"", "-", "geo", "5g-nsa", "fifteen-letters"};
    return *NetworkName::of(kNames[*rc::gen::inRange<std::size_t>(0, kNames.size())]);
}

Monitor draw_monitor() {
    return {draw(0, 1e6),
            draw(10),
            draw(10),
            draw(10),
            draw(1e5),
            draw(1e5),
            draw(2e5),
            draw(0, 1e6),
            draw(1e5),
            draw(1e6),
            draw(0, 1e6),
            draw(-1, 1e6),
            draw(0, 1e6),
            draw(0, 1e6),
            draw_bits<std::uint64_t>(),
            draw_bits<std::uint64_t>(),
            draw_bits<std::uint32_t>(),
            draw_bits<std::uint32_t>(),
            draw_enum(TissuePhase::kPenetrated),
            draw_enum(Modality::kVF),
            draw_enum(NodeState::kFailed),
            draw_enum(kLastEndReason),
            draw_bool(),
            draw_bool(),
            draw_bool(),
            draw_bool(),
            draw_network()};
}

ReplayState draw_replay() {
    ReplayState state{draw(0, 1e6), draw(0, 1e6), draw(-1, 1e6), draw(-1, 1e6), {}, 0};
    for (double& time_s : state.change_s) time_s = draw(0, 1e6);
    state.changes = *rc::gen::inRange(0U, 17U);
    return state;
}

StopOrder draw_stop() {
    StopOrder stop(draw_bits<std::uint64_t>(), draw_enum(StopKind::kAsk),
                   draw_bool() ? EndReason::kSafetyStop : EndReason::kEmergencyStop,
                   std::string(*rc::gen::inRange<std::size_t>(0, 200), 'x'));
    stop.held_ms = draw_bits<std::uint32_t>();
    return stop;
}

WaveBurst draw_waves() {
    WaveBurst waves;
    for (double& wave_root_W : waves.wave_root_W) wave_root_W = draw(1e6);
    waves.sum_root_W_s = draw(1e12);
    waves.energy_J = draw(0, 1e12);
    waves.number = draw_bits<std::uint32_t>();
    waves.count = *rc::gen::inRange(0U, 9U);
    return waves;
}

Body draw_body() {
    switch (*rc::gen::inRange(0, 15)) {
        case 0:
            return NeedleCommand{draw(10), draw(1000), draw(10), draw(10), draw(1000), draw(1e5)};
        case 1:
            return ForceFeedback{draw(10),
                                 draw(10),
                                 draw(1000),
                                 draw(10),
                                 draw(1e5),
                                 draw(1e5),
                                 draw(2e5),
                                 draw(0, 1e6),
                                 from_nanoseconds(draw_stamp()),
                                 Duration{draw_stamp()},
                                 draw_bits<std::uint32_t>(),
                                 draw_enum(TissuePhase::kPenetrated),
                                 draw_bool(),
                                 draw_bool()};
        case 2:
            return Percept{draw(0, 1e5), draw(0, 1e5), draw(10),
                           draw(10),     draw(0, 1e6), draw_enum(Finger::kThumb),
                           draw_bool(),  draw_bool()};
        case 3:
            return SessionControl{draw_bits<std::uint64_t>(),
                                  draw(10),
                                  draw(0, 1e6),
                                  draw_bits<std::uint32_t>(),
                                  draw_bits<std::uint32_t>(),
                                  draw_enum(ControlKind::kNetworkChange),
                                  draw_enum(Modality::kVF),
                                  draw_bool(),
                                  draw_enum(kLastEndReason),
                                  draw(0, 1e6),
                                  draw_network()};
        case 4:
            return ClockProbe{from_nanoseconds(draw_stamp())};
        case 5:
            return ClockReply{from_nanoseconds(draw_stamp()), from_nanoseconds(draw_stamp())};
        case 6:
            return HandInput{draw(10), draw_bool()};
        case 7:
            return draw_monitor();
        case 8:
            return Order{draw(0, 1e6), draw_bits<std::uint32_t>(), draw_enum(OrderKind::kNetwork),
                         draw_enum(Modality::kVF), draw_network()};
        case 9:
            return Page{draw(0, 1e6), draw_bits<std::uint32_t>(), draw_bits<std::uint32_t>(),
                        draw_enum(PageKind::kWait)};
        case 10:
            return draw_replay();
        case 11:
            return DeviceFault(std::string(*rc::gen::inRange<std::size_t>(0, 400), 'x'));
        case 12:
            return NeedleWave{{draw(10), draw(1000), draw(10), draw(10), draw(1000), draw(1e5)},
                              draw_waves()};
        case 13:
            return ForceWave{ForceFeedback{}, draw_waves()};
        case 14:
            return draw_stop();
        default:
            return Heartbeat{draw_bits<std::uint64_t>(),
                             draw_bits<std::uint64_t>(),
                             draw(0, 1e6),
                             draw(0, 1e6),
                             draw(0, 1e6),
                             draw(1e5),
                             draw(1e6),
                             draw_enum(NodeState::kFailed),
                             draw_enum(kLastEndReason)};
    }
}

TEST(CodecRoundTrip, EveryLegalMessageArrivesAsItWasSent) {
    Encoder first, second;
    EXPECT_TRUE(rc::check([&] {
        const Message sent{draw_header(), draw_body()};
        const Packet bytes = copy(first.encode(sent));
        RC_ASSERT(bytes.size() <= kMaxDatagramBytes);
        const Decoded decoded = decode(bytes);
        RC_ASSERT(decoded.message.has_value());
        RC_ASSERT(same(sent, *decoded.message));
        // Bytes tell more than ==: signs of zero, and that nothing undefined goes out.
        RC_ASSERT(copy(second.encode(*decoded.message)) == bytes);
    }));
}

TEST(CodecRoundTrip, EachKindKeepsEachField) {
    Encoder encoder;
    for (const Message& message : sample_messages()) {
        const Decoded decoded = decode(encoder.encode(message));
        ASSERT_TRUE(decoded.message) << to_string(*decoded.refusal);
        EXPECT_TRUE(same(message, *decoded.message)) << "kind " << message.body.index();
    }
}

// The bytes are in the buffer's own storage until the next call, so a sender needs no copy.
TEST(CodecRoundTrip, AllocatesNothingAfterTheFirstCall) {
    Encoder encoder;
    const std::vector<Message> messages = sample_messages();
    encoder.encode(messages.front());
    const std::uint64_t before = test::allocation_count();
    std::size_t bytes = 0;
    bool all = true;
    for (int i = 0; i < 100; ++i) {
        for (const Message& message : messages) {
            const Bytes encoded = encoder.encode(message);
            bytes += encoded.size();
            all = decode(encoded).message.has_value() && all;
        }
    }
    EXPECT_EQ(test::allocation_count() - before, 0U);
    EXPECT_TRUE(all);
    EXPECT_GT(bytes, 0U);
}

// Other programs read these bytes: layouts of a release never change. The header is the last struct written,
// so it stands where docs/protocol.md draws it.
TEST(CodecRoundTrip, WireBytesOfANeedleCommand) {
    Encoder encoder;
    const Header header{0x1122334455667788, from_nanoseconds(0x0102030405060708), 0xa1a2a3a4, 7,
                        Role::kMaster};
    const Packet bytes = copy(encoder.encode(header, NeedleCommand{1, 2, 3, 4, 5, 6}));
    ASSERT_GE(bytes.size(), 8U);
    EXPECT_EQ(std::string(bytes.begin() + 4, bytes.begin() + 8), "THM1");
    const Packet header_bytes{0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11, 0x08, 0x07, 0x06,
                              0x05, 0x04, 0x03, 0x02, 0x01, 0xa4, 0xa3, 0xa2, 0xa1, 0x07, 0x00,
                              0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00};
    EXPECT_NE(std::search(bytes.begin(), bytes.end(), header_bytes.begin(), header_bytes.end()), bytes.end());
    Packet body_bytes;
    for (const double value : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        for (int shift = 0; shift < 64; shift += 8)
            body_bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
    }
    EXPECT_NE(std::search(bytes.begin(), bytes.end(), body_bytes.begin(), body_bytes.end()), bytes.end());
}

}  // namespace
}  // namespace thimble
