// Every way a datagram can be bad, and the name under which it is counted.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <flatbuffers/flatbuffers.h>
#include <gtest/gtest.h>

#include "common/codec.hpp"
#include "tests/fuzz/packets.hpp"
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

// Of the bytes. Of the message itself refusal_of() must say the same.
std::optional<Refusal> verdict(const Message& message) {
    Encoder encoder;
    const std::optional<Refusal> refusal = judged(encoder.encode(message));
    EXPECT_EQ(refusal_of(message), refusal);
    return refusal;
}

std::optional<Refusal> verdict(const Body& body) { return verdict(Message{{}, body}); }
std::optional<Refusal> verdict(const Header& header) { return verdict(Message{header, Heartbeat{}}); }

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
// All but the device fault: a datagram has no room for two of them.
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

TEST(CodecRefusal, TooShortOrMalformedAtEveryCut) {
    const Packet good = good_packet();
    for (std::size_t size = 0; size < good.size(); ++size) {
        // In a block of its own, where a sanitizer sees a read past its end.
        const auto block = std::make_unique<std::uint8_t[]>(size);
        std::copy_n(good.begin(), size, block.get());
        EXPECT_EQ(judged(Bytes(block.get(), size)), size < 8 ? Refusal::kTooShort : Refusal::kMalformed)
            << size;
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

// Of each number of each kind of message, with the value that `values` makes of its range.
template <class Values>
void expect_for_numbers(std::optional<Refusal> expected, Values&& values) {
    for (const Message& sample : sample_messages()) {
        Message message = sample;
        const std::vector<LegalNumber> numbers = numbers_of(message.body);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            const double before = *numbers[i].value;
            for (const double value : values(numbers[i])) {
                *numbers[i].value = value;
                EXPECT_EQ(verdict(message.body), expected)
                    << "kind " << message.body.index() << ", number " << i << ": " << value;
            }
            *numbers[i].value = before;
        }
    }
}

using Values = std::vector<double>;

TEST(CodecRefusal, NotFiniteInAnyField) {
    expect_for_numbers(Refusal::kNotFinite, [](const LegalNumber&) {
        return Values{kNaN, -kNaN, kInfinity, -kInfinity};
    });
}

TEST(CodecRefusal, OutOfRangeInAnyField) {
    expect_for_numbers(std::nullopt, [](const LegalNumber& n) { return Values{n.low, n.high}; });
    constexpr double kMost = std::numeric_limits<double>::max();
    expect_for_numbers(Refusal::kOutOfRange, [](const LegalNumber& n) {
        return Values{std::nextafter(n.low, -kInfinity), std::nextafter(n.high, kInfinity), kMost, -kMost};
    });
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

TEST(CodecRefusal, MoreWavesThanThereIsRoomFor) {
    for (const std::uint32_t count : {8U, 9U}) {
        NeedleWave there;
        ForceWave back;
        there.waves.count = back.waves.count = count;
        EXPECT_EQ(verdict(there), count == 8 ? std::nullopt : std::optional{Refusal::kOutOfRange});
        EXPECT_EQ(verdict(back), verdict(there));
    }
}

TEST(CodecRefusal, NotFiniteBeatsOutOfRange) {
    NeedleCommand body;
    body.position_needle_m = 11;
    body.force_hand_N = kNaN;
    EXPECT_EQ(verdict(body), Refusal::kNotFinite);
}

TEST(CodecRefusal, StampsOutOfRange) {
    constexpr std::int64_t kLast = std::int64_t{1} << 62;
    for (const std::int64_t ns :
         {std::int64_t{0}, kLast, std::int64_t{-1}, kLast + 1, INT64_MAX, INT64_MIN}) {
        SCOPED_TRACE(ns);
        const SessionTime time = from_nanoseconds(ns);
        ForceFeedback echo, hold;
        echo.echo_time = time;
        hold.hold_time = Duration{ns};
        const auto expected = ns >= 0 && ns <= kLast ? std::nullopt : std::optional{Refusal::kOutOfRange};
        EXPECT_EQ(verdict(Header{1, time, 1, 1, Role::kMaster}), expected);
        for (const Body& body :
             std::vector<Body>{echo, hold, ClockProbe{time}, ClockReply{time, {}}, ClockReply{{}, time}})
            EXPECT_EQ(verdict(body), expected) << "kind " << body.index();
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
    expect_enum(&Order::kind, 12);
    expect_enum(&Order::modality, 4);
    expect_enum(&Page::kind, 9);
}

TEST(CodecRefusal, TextsWithoutAnEndAndStopsThatAreNone) {
    DeviceFault fault;
    fault.text.fill('x');
    EXPECT_EQ(verdict(fault), Refusal::kOutOfRange);
    StopOrder order(1, StopKind::kStop, EndReason::kEmergencyStop, "a key");
    EXPECT_EQ(verdict(order), std::nullopt);
    order.reason = EndReason::kCompleted;
    EXPECT_EQ(verdict(order), Refusal::kOutOfRange);
    order.reason = EndReason::kEmergencyStop;
    order.text.fill('x');
    EXPECT_EQ(verdict(order), Refusal::kOutOfRange);
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
