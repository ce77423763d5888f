// Every message of a node arrives as it was sent.
#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <limits>
#include <map>
#include <regex>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "common/codec.hpp"
#include "common/codec_fields.hpp"
#include "tests/allocation_count.hpp"
#include "tests/fuzz/packets.hpp"
#include "tests/read_text.hpp"
#include "tests/unit/common/packet.hpp"

namespace thimble {
namespace {

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

template <class Unsigned>
Unsigned draw_bits() {
    return *rc::gen::oneOf(rc::gen::just(std::numeric_limits<Unsigned>::max()), rc::gen::just(Unsigned{0}),
                           rc::gen::arbitrary<Unsigned>());
}

// Draws each field of a message.
struct FieldDrawer {
    void operator()(double& value, const NumberRange& range) { value = draw(range.low, range.high); }
    void operator()(std::unsigned_integral auto& bits) { bits = draw_bits<std::decay_t<decltype(bits)>>(); }
    void operator()(bool& flag) { flag = *rc::gen::arbitrary<bool>(); }
    void operator()(std::uint32_t& count, std::uint32_t most) { count = *rc::gen::inRange(0U, most + 1); }
    void operator()(SessionTime& time) { time = from_nanoseconds(stamp()); }
    void operator()(Duration& duration) { duration = Duration{stamp()}; }
    void operator()(NetworkName& name) {
        static constexpr std::array<std::string_view, 5> kNames{"", "-", "geo", "5g-nsa", "fifteen-letters"};
        name = *NetworkName::of(kNames[*rc::gen::inRange<std::size_t>(0, kNames.size())]);
    }
    template <class Enum>
    void operator()(Enum& value, Enum last) {
        (*this)(value, Enum{}, last);
    }
    template <class Enum>
    void operator()(Enum& value, Enum first, Enum last) {
        value = static_cast<Enum>(*rc::gen::inRange(static_cast<int>(first), static_cast<int>(last) + 1));
    }
    template <std::size_t N>
    void operator()(std::array<char, N>& text) {
        text = {};
        std::fill_n(text.begin(), *rc::gen::inRange<std::size_t>(0, N), 'x');
    }

    static std::int64_t stamp() {
        constexpr std::int64_t kLast = std::int64_t{1} << 62;
        return *rc::gen::oneOf(rc::gen::just(std::int64_t{0}), rc::gen::just(kLast),
                               rc::gen::inRange<std::int64_t>(0, kLast));
    }
};

Message draw_message() {
    static const std::vector<Message> kOneOfEach = sample_messages();
    Message message = kOneOfEach[*rc::gen::inRange<std::size_t>(0, kOneOfEach.size())];
    FieldDrawer drawer;
    visit_fields(drawer, message.header);
    std::visit([&](auto& body) { visit_fields(drawer, body); }, message.body);
    return message;
}

TEST(CodecRoundTrip, EveryLegalMessageArrivesAsItWasSent) {
    Encoder first, second;
    EXPECT_TRUE(rc::check([&] {
        const Message sent = draw_message();
        const Packet bytes = copy(first.encode(sent));
        RC_ASSERT(bytes.size() <= kMaxDatagramBytes);
        const Decoded decoded = decode(bytes);
        RC_ASSERT(decoded.message.has_value());
        RC_ASSERT(sent == *decoded.message);
        RC_ASSERT(!refusal_of(sent));  // so who hands it over instead changes nothing
        // Bytes tell more than ==: signs of zero, and that nothing undefined goes out.
        RC_ASSERT(copy(second.encode(*decoded.message)) == bytes);
    }));
}

// A datagram is read by the layout of the one before, or by the verifier. Both must say the same of any bytes.
TEST(CodecRoundTrip, EachKindKeepsEachFieldAndIsReadAlikeBehindItsOwnAndBehindAnother) {
    Encoder encoder;
    for (const Message& sent : sample_messages()) {
        const Message other{sent.header, sent.body.index() == 0 ? Body(Percept{}) : Body(NeedleCommand{})};
        Packet bytes = copy(encoder.encode(sent));
        ASSERT_EQ(decode(bytes).message, sent) << "kind " << sent.body.index();
        const auto read_alike = [&](std::size_t place) {
            Message behind_own = sent, behind_other = other;
            const auto refusal = decode_into(bytes, behind_own);
            ASSERT_EQ(refusal, decode_into(bytes, behind_other)) << sent.body.index() << ", " << place;
            if (refusal) return;
            EXPECT_EQ(copy(encoder.encode(behind_own)), copy(encoder.encode(behind_other))) << place;
        };
        read_alike(bytes.size());
        for (std::size_t place = 0; place < bytes.size(); ++place) {
            const std::uint8_t before = bytes[place];
            for (const int change : {0x01, 0x80, 0xff}) {
                bytes[place] = static_cast<std::uint8_t>(before ^ change);
                read_alike(place);
            }
            bytes[place] = before;
        }
    }
}

// The bytes are in the buffer's own storage until the next call, so a sender needs no copy.
TEST(CodecRoundTrip, AllocatesNothingAfterTheFirstCall) {
    Encoder encoder;
    const std::vector<Message> messages = sample_messages();
    encoder.encode(messages.front());
    const std::uint64_t before = test::allocation_count();
    bool all = true;
    for (int i = 0; i < 100; ++i) {
        for (const Message& message : messages)
            all = decode(encoder.encode(message)).message.has_value() && all;
    }
    EXPECT_EQ(test::allocation_count() - before, 0U);
    EXPECT_TRUE(all);
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

// Programs of others take their buffers' lengths from there.
TEST(CodecRoundTrip, TheProtocolPageHasTheSizeOfEachKind) {
    static constexpr std::array<const char*, std::variant_size_v<Body>> kNames{
        "NeedleCommand", "ForceFeedback", "Percept",   "SessionControl", "Heartbeat", "ClockProbe",
        "ClockReply",    "HandInput",     "Monitor",   "Order",          "Page",      "ReplayState",
        "DeviceFault",   "NeedleWave",    "ForceWave", "StopOrder"};
    const std::string page = whole_text(THIMBLE_SOURCE_DIR "/docs/protocol.md");
    std::map<std::string, std::string> bytes_of;
    const std::regex row(R"(\n\| `(\w+)`(?:, `(\w+)`)? \| (\d+)(?:, (\d+))? \|)");
    for (std::sregex_iterator found(page.begin(), page.end(), row), end; found != end; ++found) {
        bytes_of[(*found)[1]] = (*found)[3];
        bytes_of[(*found)[2]] = (*found)[4];
    }
    Encoder encoder;
    for (const Message& message : sample_messages()) {
        const std::string name = kNames.at(message.body.index());
        EXPECT_EQ(bytes_of[name], std::to_string(encoder.encode(message).size())) << name;
    }
}

// The same of one message of each kind, as a digest (FNV-1a): a field in another place changes it.
TEST(CodecRoundTrip, WireBytesOfEachKind) {
    Encoder encoder;
    std::uint64_t digest = 0xcbf29ce484222325;
    for (const Message& message : sample_messages()) {
        for (const std::uint8_t byte : encoder.encode(message)) digest = (digest ^ byte) * 0x100000001b3;
    }
    EXPECT_EQ(digest, 0xc8001049901de2b6);
}

}  // namespace
}  // namespace thimble
