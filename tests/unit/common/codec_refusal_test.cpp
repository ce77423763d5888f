// Every way a datagram can be bad, and the name under which it is counted.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <flatbuffers/flatbuffers.h>
#include <gtest/gtest.h>

#include "common/codec.hpp"
#include "tests/unit/common/packet.hpp"

namespace thimble {

// For readable failures.
void PrintTo(Refusal refusal, std::ostream* stream) { *stream << to_string(refusal); }

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::optional<Refusal> judged(Bytes bytes) {
    const Decoded decoded = decode(bytes);
    EXPECT_EQ(decoded.message.has_value(), !decoded.refusal);
    return decoded.refusal;
}

template <class Body>
std::optional<Refusal> verdict(const Body& body) {
    Encoder encoder;
    return judged(encoder.encode(Header{}, body));
}

std::optional<Refusal> verdict(const Header& header) {
    Encoder encoder;
    return judged(encoder.encode(header, Heartbeat{}));
}

Packet good_packet() {
    Encoder encoder;
    const Bytes bytes = encoder.encode(Header{}, NeedleCommand{});
    return {bytes.begin(), bytes.end()};
}

// A packet put together by hand from the schema: a table whose fields hold structs of zeros.
struct alignas(8) ZeroHeader {
    std::array<std::uint8_t, 32> bytes{};
};
struct alignas(8) ZeroBody {  // as large as the largest
    std::array<std::uint8_t, 176> bytes{};
};
constexpr flatbuffers::voffset_t kHeaderField = 4;
// All but the device fault, of which two have no room in a datagram.
constexpr std::array<flatbuffers::voffset_t, 14> kBodyFields{6,  8,  10, 12, 14, 16, 18,
                                                             20, 22, 24, 26, 28, 32, 34};

Packet by_hand(bool header, const std::vector<flatbuffers::voffset_t>& bodies,
               const char* identifier = "THM1") {
    flatbuffers::FlatBufferBuilder builder;
    const ZeroHeader zero_header;
    const ZeroBody zero_body;
    const auto start = builder.StartTable();
    for (const auto field : bodies) builder.AddStruct(field, &zero_body);
    if (header) builder.AddStruct(kHeaderField, &zero_header);
    builder.Finish(flatbuffers::Offset<void>(builder.EndTable(start)), identifier);
    return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

TEST(CodecRefusal, TooShort) {
    const Packet good = good_packet();
    for (std::size_t size = 0; size < 8; ++size) {
        EXPECT_EQ(judged(Bytes(good.data(), size)), Refusal::kTooShort) << size;
    }
}

TEST(CodecRefusal, TooLong) {
    Packet packet = good_packet();
    packet.resize(kMaxDatagramBytes);
    EXPECT_EQ(judged(packet), std::nullopt);  // what follows the message does not matter
    packet.resize(kMaxDatagramBytes + 1);
    EXPECT_EQ(judged(packet), Refusal::kTooLong);
}

TEST(CodecRefusal, ForeignFormat) {
    EXPECT_EQ(judged(by_hand(true, {6}, "THM2")), Refusal::kForeignFormat);
    EXPECT_EQ(judged(Packet(100, 0)), Refusal::kForeignFormat);
    const std::string text = "GET / HTTP/1.1\r\n";
    EXPECT_EQ(judged(Packet(text.begin(), text.end())), Refusal::kForeignFormat);
}

TEST(CodecRefusal, MalformedAtEveryCut) {
    const Packet good = good_packet();
    for (std::size_t size = 8; size < good.size(); ++size) {
        // In a block of its own, where a sanitizer sees a read past its end.
        const auto block = std::make_unique<std::uint8_t[]>(size);
        std::copy_n(good.begin(), size, block.get());
        EXPECT_EQ(judged(Bytes(block.get(), size)), Refusal::kMalformed) << size;
    }
}

TEST(CodecRefusal, MalformedWithoutHeader) { EXPECT_EQ(judged(by_hand(false, {6})), Refusal::kMalformed); }

TEST(CodecRefusal, MalformedWhenTheTableLiesElsewhere) {
    for (const std::uint8_t root : std::vector<std::uint8_t>{0x00, 0x01, 0x7f, 0xff}) {
        Packet packet = good_packet();
        packet[0] = root;
        packet[3] = root;
        EXPECT_EQ(judged(packet), Refusal::kMalformed) << int{root};
    }
}

TEST(CodecRefusal, NotOneBody) {
    EXPECT_EQ(judged(by_hand(true, {})), Refusal::kNotOneBody);
    for (const auto one : kBodyFields) {
        EXPECT_EQ(judged(by_hand(true, {one})), std::nullopt) << one;
        for (const auto other : kBodyFields) {
            if (one != other) {
                EXPECT_EQ(judged(by_hand(true, {one, other})), Refusal::kNotOneBody) << one << ' ' << other;
            }
        }
    }
    // A body that a later version may add is none that we know.
    EXPECT_EQ(judged(by_hand(true, {38})), Refusal::kNotOneBody);
}

struct Number {
    const char* name;
    double low, high;
    std::function<std::optional<Refusal>(double)> verdict_with;
};

template <class Body>
Number field(const char* name, double Body::*member, double low, double high) {
    return {name, low, high, [member](double value) {
                Body body;
                body.*member = value;
                return verdict(body);
            }};
}

// Written from docs/protocol.md's ranges, not from the codec.
std::vector<Number> numbers() {
    using N = NeedleCommand;
    using F = ForceFeedback;
    using P = Percept;
    return {
        field("needle position", &N::position_needle_m, -10, 10),
        field("needle velocity", &N::velocity_needle_m_per_s, -1000, 1000),
        field("needle estimate", &N::position_needle_estimate_m, -10, 10),
        field("hand position", &N::position_hand_m, -10, 10),
        field("hand velocity", &N::velocity_hand_m_per_s, -1000, 1000),
        field("hand force", &N::force_hand_N, -1e5, 1e5),
        field("feedback needle", &F::position_needle_m, -10, 10),
        field("feedback surface", &F::position_surface_m, -10, 10),
        field("surface velocity", &F::velocity_surface_m_per_s, -1000, 1000),
        field("proxy", &F::position_proxy_m, -10, 10),
        field("tissue force", &F::force_tissue_N, -1e5, 1e5),
        field("fixture force", &F::force_fixture_N, -1e5, 1e5),
        field("total force", &F::force_total_N, -2e5, 2e5),
        field("contact time", &F::contact_time_s, 0, 1e6),
        field("finger force", &P::force_N, 0, 1e5),
        field("bar", &P::bar_N, 0, 1e5),
        field("needle shown", &P::position_needle_shown_m, -10, 10),
        field("surface shown", &P::position_surface_shown_m, -10, 10),
        field("sample age", &P::sample_age_s, 0, 1e6),
        field("fixture position", &SessionControl::fixture_position_m, -10, 10),
        field("network delay", &SessionControl::network_delay_s, 0, 1e6),
        field("round trip median", &Heartbeat::round_trip_median_s, 0, 1e6),
        field("round trip worst", &Heartbeat::round_trip_worst_s, 0, 1e6),
        field("hold median", &Heartbeat::hold_median_s, 0, 1e6),
        field("handle force", &Heartbeat::force_hand_N, -1e5, 1e5),
        field("handle energy", &Heartbeat::energy_in_J, -1e6, 1e6),
        field("hand input", &HandInput::position_hand_m, -10, 10),
        field("monitor time", &Monitor::time_s, 0, 1e6),
        field("monitor needle", &Monitor::position_needle_m, -10, 10),
        field("monitor surface", &Monitor::position_surface_m, -10, 10),
        field("monitor fixture", &Monitor::position_fixture_m, -10, 10),
        field("monitor tissue force", &Monitor::force_tissue_N, -1e5, 1e5),
        field("monitor fixture force", &Monitor::force_fixture_N, -1e5, 1e5),
        field("monitor total force", &Monitor::force_total_N, -2e5, 2e5),
        field("monitor contact time", &Monitor::contact_time_s, 0, 1e6),
        field("monitor handle force", &Monitor::force_hand_N, -1e5, 1e5),
        field("monitor energy", &Monitor::energy_in_J, -1e6, 1e6),
        field("monitor round trip", &Monitor::round_trip_s, 0, 1e6),
        field("monitor one way", &Monitor::one_way_s, -1, 1e6),
        field("monitor bound", &Monitor::one_way_bound_s, 0, 1e6),
        field("monitor delay", &Monitor::network_delay_s, 0, 1e6),
        field("order value", &Order::value, 0, 1e6),
        field("page remaining", &Page::remaining_s, 0, 1e6),
        field("silence", &SessionControl::silence_s, 0, 1e6),
        field("replay duration", &ReplayState::duration_s, 0, 1e6),
        field("replay speed", &ReplayState::speed, 0, 1e6),
        field("replay contact", &ReplayState::contact_s, -1, 1e6),
        field("replay beep", &ReplayState::beep_s, -1, 1e6),
    };
}

TEST(CodecRefusal, NotFiniteInAnyField) {
    for (const Number& number : numbers()) {
        for (const double value : {kNaN, -kNaN, kInfinity, -kInfinity}) {
            EXPECT_EQ(number.verdict_with(value), Refusal::kNotFinite) << number.name << ' ' << value;
        }
    }
}

TEST(CodecRefusal, OutOfRangeInAnyField) {
    for (const Number& number : numbers()) {
        EXPECT_EQ(number.verdict_with(number.low), std::nullopt) << number.name;
        EXPECT_EQ(number.verdict_with(number.high), std::nullopt) << number.name;
        for (const double beyond :
             {std::nextafter(number.low, -kInfinity), std::nextafter(number.high, kInfinity),
              std::numeric_limits<double>::max(), -std::numeric_limits<double>::max()}) {
            EXPECT_EQ(number.verdict_with(beyond), Refusal::kOutOfRange) << number.name << ' ' << beyond;
        }
    }
}

TEST(CodecRefusal, NamesOfNetworksThatAreNone) {
    const auto verdict_on = [](std::string_view text) {
        Order order;
        std::copy(text.begin(), text.end(), order.network.text.begin());
        return verdict(order);
    };
    EXPECT_EQ(verdict_on("transatlantic"), std::nullopt);
    EXPECT_EQ(verdict_on("fifteen-letters"), std::nullopt);
    EXPECT_EQ(verdict_on("no-zero-at-its-e"), Refusal::kOutOfRange);
    EXPECT_EQ(verdict_on("../secret"), Refusal::kOutOfRange);
    EXPECT_EQ(verdict_on("LTE"), Refusal::kOutOfRange);
    EXPECT_EQ(verdict_on(std::string_view("lte\0x", 5)), Refusal::kOutOfRange);  // something behind the end
}

TEST(CodecRefusal, MoreMarksThanThereIsRoomFor) {
    ReplayState state;
    state.changes = ReplayState::kMostChanges;
    EXPECT_EQ(verdict(state), std::nullopt);
    ++state.changes;
    EXPECT_EQ(verdict(state), Refusal::kOutOfRange);
}

TEST(CodecRefusal, WavesThatNoHandMakes) {
    const auto verdict_after = [](auto change) {
        NeedleWave there;
        ForceWave back;
        change(there.waves);
        change(back.waves);
        EXPECT_EQ(verdict(there), verdict(back));
        return verdict(back);
    };
    EXPECT_EQ(verdict_after([](WaveBurst& w) { w.count = 8; }), std::nullopt);
    EXPECT_EQ(verdict_after([](WaveBurst& w) { w.count = 9; }), Refusal::kOutOfRange);
    EXPECT_EQ(verdict_after([](WaveBurst& w) { w.wave_root_W[7] = -2e6; }), Refusal::kOutOfRange);
    EXPECT_EQ(verdict_after([](WaveBurst& w) { w.wave_root_W[7] = kNaN; }), Refusal::kNotFinite);
    EXPECT_EQ(verdict_after([](WaveBurst& w) { w.energy_J = -1; }), Refusal::kOutOfRange);
    EXPECT_EQ(verdict_after([](WaveBurst& w) { w.sum_root_W_s = 2e12; }), Refusal::kOutOfRange);
}

TEST(CodecRefusal, NotFiniteBeatsOutOfRange) {
    NeedleCommand body;
    body.position_needle_m = 11;
    body.force_hand_N = kNaN;
    EXPECT_EQ(verdict(body), Refusal::kNotFinite);
}

TEST(CodecRefusal, StampsOutOfRange) {
    constexpr std::int64_t kLast = std::int64_t{1} << 62;
    const auto header = [](std::int64_t ns) {
        return verdict(Header{1, from_nanoseconds(ns), 1, 1, Role::kMaster});
    };
    const auto echo = [](std::int64_t ns) {
        ForceFeedback body;
        body.echo_time = from_nanoseconds(ns);
        return verdict(body);
    };
    const auto hold = [](std::int64_t ns) {
        ForceFeedback body;
        body.hold_time = Duration{ns};
        return verdict(body);
    };
    const auto probe = [](std::int64_t ns) { return verdict(ClockProbe{from_nanoseconds(ns)}); };
    const auto reply_to = [](std::int64_t ns) { return verdict(ClockReply{from_nanoseconds(ns), {}}); };
    const auto arrival = [](std::int64_t ns) { return verdict(ClockReply{{}, from_nanoseconds(ns)}); };
    for (const std::int64_t ns : {std::int64_t{0}, kLast}) {
        EXPECT_EQ(header(ns), std::nullopt);
        EXPECT_EQ(echo(ns), std::nullopt);
        EXPECT_EQ(hold(ns), std::nullopt);
        EXPECT_EQ(probe(ns), std::nullopt);
        EXPECT_EQ(reply_to(ns), std::nullopt);
        EXPECT_EQ(arrival(ns), std::nullopt);
    }
    for (const std::int64_t ns : {std::int64_t{-1}, kLast + 1, INT64_MAX, INT64_MIN}) {
        EXPECT_EQ(header(ns), Refusal::kOutOfRange);
        EXPECT_EQ(echo(ns), Refusal::kOutOfRange);
        EXPECT_EQ(hold(ns), Refusal::kOutOfRange);
        EXPECT_EQ(probe(ns), Refusal::kOutOfRange);
        EXPECT_EQ(reply_to(ns), Refusal::kOutOfRange);
        EXPECT_EQ(arrival(ns), Refusal::kOutOfRange);
    }
}

// The values of an enum field of a body, each judged; `legal` of them from 0 on are good.
template <class Body, class Enum>
void expect_enum(Enum Body::*member, int legal) {
    for (int value = 0; value < 256; ++value) {
        Body body;
        body.*member = static_cast<Enum>(value);
        ASSERT_EQ(verdict(body), value < legal ? std::nullopt : std::optional{Refusal::kOutOfRange}) << value;
    }
}

TEST(CodecRefusal, EnumsOutOfRange) {
    expect_enum(&Header::sender, 7);
    expect_enum(&ForceFeedback::phase, 3);
    expect_enum(&Percept::finger, 3);
    expect_enum(&SessionControl::kind, 6);
    expect_enum(&SessionControl::modality, 4);
    expect_enum(&SessionControl::reason, 8);
    expect_enum(&Heartbeat::state, 4);
    expect_enum(&Heartbeat::reason, 8);
    expect_enum(&Monitor::phase, 3);
    expect_enum(&Monitor::modality, 4);
    expect_enum(&Monitor::state, 4);
    expect_enum(&Monitor::reason, 8);
    expect_enum(&Order::kind, 11);
    expect_enum(&Order::modality, 4);
    expect_enum(&Page::kind, 8);
}

TEST(CodecRefusal, AFaultWhoseTextHasNoEnd) {
    DeviceFault fault;
    fault.text.fill('x');
    Encoder encoder;
    EXPECT_EQ(decode(encoder.encode(Header{}, fault)).refusal, Refusal::kOutOfRange);
}

TEST(CodecRefusal, AStopThatIsNone) {
    Encoder encoder;
    StopOrder order(1, StopKind::kStop, EndReason::kEmergencyStop, "a key");
    EXPECT_TRUE(decode(encoder.encode(Header{}, order)).message);
    order.reason = EndReason::kCompleted;
    EXPECT_EQ(decode(encoder.encode(Header{}, order)).refusal, Refusal::kOutOfRange);
    order.reason = EndReason::kEmergencyStop;
    order.text.fill('x');
    EXPECT_EQ(decode(encoder.encode(Header{}, order)).refusal, Refusal::kOutOfRange);
}

TEST(CodecRefusal, EveryRefusalHasANameOfItsOwn) {
    std::set<std::string> names;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(Refusal::kCount); ++i) {
        names.insert(to_string(static_cast<Refusal>(i)));
    }
    EXPECT_EQ(names.size(), static_cast<std::size_t>(Refusal::kCount) + 1);
}

}  // namespace
}  // namespace thimble
