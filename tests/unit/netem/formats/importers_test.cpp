// irtt, ping and pairs of captures: what measuring programs write becomes a path.
#include "netem/import/importers.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random.hpp"
#include "netem/formats/trace_files.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/netem/formats/capture_writer.hpp"

namespace thimble {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;
using test::CaptureWriter;
using testing::Contains;
using testing::HasSubstr;

std::vector<double> losses(const MeasuredPath& path) {
    std::vector<double> all;
    for (const MeasuredPacket& packet : path.packets) all.push_back(packet.loss);
    return all;
}

// As documented in irtt-client(1), with a packet lost on either way.
constexpr std::string_view kIrtt = R"({"round_trips": [
  {"seqno": 0, "lost": "false", "timestamps": {"client": {"receive": {"wall": 1508180723502871779,
   "monotonic": 2921143}, "send": {"wall": 1508180723502727340, "monotonic": 2776704}},
   "server": {"receive": {}, "send": {}}}, "delay": {"receive": 45177, "rtt": 134460, "send": 89283}, "ipdv": {}},
  {"seqno": 1, "lost": "true_down", "timestamps": {"client": {"receive": {}, "send": {"monotonic": 202856692}}},
   "delay": {}},
  {"seqno": 2, "lost": "true_up", "timestamps": {"client": {"receive": {}, "send": {"monotonic": 402856692}}},
   "delay": {}},
  {"seqno": 3, "lost": false, "timestamps": {"client": {"send": {"monotonic": 602856692}}},
   "delay": {"receive": 45268, "rtt": 99455, "send": 54187}}]})";

TEST(Irtt, BothDirections) {
    const MeasuredPaths paths = parse_irtt(kIrtt, "a.json");
    EXPECT_EQ(losses(paths.up), (std::vector<double>{0, 1, 0}));    // who got up but not back has no delay
    EXPECT_EQ(losses(paths.down), (std::vector<double>{0, 1, 0}));  // who never got up was never sent down
    EXPECT_EQ(paths.up.packets[0].delay, Duration{89283});
    EXPECT_EQ(paths.down.packets[2].delay, Duration{45268});
    EXPECT_EQ(paths.up.packets[2].at, 602856692 - 2776704);
    EXPECT_THAT(paths.up.remarks, Contains(HasSubstr("only as good as their clocks")));
}

std::string irtt_with(std::string_view trip) {
    return R"({"round_trips": [{"seqno": 0, "lost": "false", "timestamps": {"client": {"send": {"wall": 5}}}, )" +
           std::string(trip) + "}]}";
}

TEST(Irtt, HalvesOfTheRoundTripWithoutStampsOfTheServer) {
    const MeasuredPaths paths = parse_irtt(irtt_with(R"("delay": {"rtt": 5000})"), "a.json");
    EXPECT_EQ(paths.up.packets[0].delay, Duration{2500});
    EXPECT_EQ(paths.down.packets[0].delay, Duration{2500});
    EXPECT_THAT(paths.up.remarks, Contains(HasSubstr("half of a round trip")));
}

TEST(Irtt, ClocksThatDisagreeAreNamed) {
    const MeasuredPaths apart =
        parse_irtt(irtt_with(R"("delay": {"rtt": 5000, "send": 4900, "receive": 100})"), "a");
    EXPECT_THAT(apart.down.remarks, Contains(HasSubstr("either the path is asymmetric, or")));
}

TEST(Irtt, Refusals) {
    for (const auto& [text, reason] : std::vector<std::pair<std::string, std::string>>{
             {"", "is not JSON"},
             {"{}", "has no list \"round_trips\""},
             {R"({"round_trips": []})", "has no list"},
             {R"({"round_trips": [5]})", "round_trips[0].lost"},
             {R"({"round_trips": [{"lost": "false"}]})", "no timestamps.client.send"},
             {irtt_with(R"("delay": {})"), "has no delay"},
             {irtt_with(R"("delay": {"rtt": 5, "send": -7, "receive": 12})"), "the two clocks disagree"},
             {irtt_with(R"("delay": {"rtt": 1e300})"), "has no delay"},
             {irtt_with(R"("delay": {"rtt": 900000000000})"), "more than a minute"}}) {
        EXPECT_THAT(refusal([&, &json = text] { parse_irtt(json, "a.json"); }), HasSubstr(reason)) << text;
    }
}

TEST(Ping, LinuxWithStampsGapsAndDuplicates) {
    const MeasuredPath path = parse_ping(
        "PING host (10.0.0.1) 56(84) bytes of data.\n"
        "[100.0100] 64 bytes from 10.0.0.1: icmp_seq=1 ttl=64 time=10.0 ms\n"
        "[100.0105] 64 bytes from 10.0.0.1: icmp_seq=1 ttl=64 time=10.5 ms (DUP!)\n"
        "[100.2300] no answer yet for icmp_seq=2\n"
        "[100.4300] 64 bytes from host (10.0.0.1): icmp_seq=3 ttl=64 time=30 ms\n"
        "\n--- host ping statistics ---\n4 packets transmitted, 2 received, +1 duplicates, 50% packet loss, "
        "time 602ms\n",
        "ping.txt", milliseconds{200});
    EXPECT_EQ(losses(path), (std::vector<double>{0, 1, 0, 1}));
    EXPECT_EQ(path.packets[0].delay, milliseconds{5});
    EXPECT_EQ(path.packets[2].delay, milliseconds{15});
    EXPECT_NEAR(static_cast<double>(path.packets[2].at), 0.4e9, 1e3);
    EXPECT_THAT(path.remarks, Contains(HasSubstr("1 duplicates")));
    EXPECT_THAT(path.remarks, Contains(HasSubstr("cannot separate the directions")));
}

void expect_times(const MeasuredPath& path, const std::vector<double>& expected_s) {
    ASSERT_EQ(path.packets.size(), expected_s.size());
    for (std::size_t i = 0; i < expected_s.size(); ++i)
        EXPECT_NEAR(static_cast<double>(path.packets[i].at), 1e9 * expected_s[i], 1e3) << i;
}

// Sent each 100 ms, and `import` was not told so: stamps decide.
TEST(Ping, ALostPacketStandsBetweenItsNeighbours) {
    std::string text;
    for (const int number : {3, 4, 7, 8})
        text += "[" + std::to_string(100 + number / 10) + "." + std::to_string(number % 10) +
                "100] 64 bytes from a: icmp_seq=" + std::to_string(number) + " ttl=64 time=10.0 ms\n";
    text += "10 packets transmitted, 4 received, 60% packet loss, time 900ms\n";
    const MeasuredPath path = parse_ping(text, "ping.txt", seconds{1});
    EXPECT_EQ(losses(path), (std::vector<double>{1, 1, 0, 0, 1, 1, 0, 0, 1, 1}));
    expect_times(path, {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9});
}

// After a pause of ping itself (its machine slept) each packet keeps its own stamp.
TEST(Ping, StampsThatAreNotAtTheIntervalStand) {
    const MeasuredPath path = parse_ping(
        "[100.01] 64 bytes from a: icmp_seq=1 ttl=64 time=10 ms\n"
        "[100.51] 64 bytes from a: icmp_seq=2 ttl=64 time=10 ms\n"
        "[103.51] 64 bytes from a: icmp_seq=5 ttl=64 time=10 ms\n"
        "[103.71] 64 bytes from a: icmp_seq=6 ttl=64 time=10 ms\n",
        "ping.txt", seconds{1});
    expect_times(path, {0, 0.5, 1.5, 2.5, 3.5, 3.7});
}

TEST(Ping, MacWithoutStampsStandsAtTheInterval) {
    const MeasuredPath path = parse_ping(
        "64 bytes from 1.1.1.1: icmp_seq=0 ttl=49 time=12.9 ms\r\nRequest timeout for icmp_seq 1\r\n"
        "64 bytes from 1.1.1.1: icmp_seq=3 ttl=49 time=13.7 ms\r\n64 bytes from 1.1.1.1: icmp_seq=2 ttl=49 "
        "time=900 ms\r\n",
        "ping.txt", seconds{1});
    EXPECT_EQ(losses(path), (std::vector<double>{0, 1, 0, 0}));
    EXPECT_EQ(path.packets[3].at, 3'000'000'000);
    EXPECT_EQ(path.packets[2].delay, milliseconds{450});
    EXPECT_THAT(path.remarks, Contains(HasSubstr("no time stamps")));
    EXPECT_THAT(path.remarks, Contains(HasSubstr("1 replies came out of order")));
}

TEST(Ping, NumbersBeginAgain) {
    const MeasuredPath path = parse_ping(
        "64 bytes from a: icmp_seq=65534 time=1 ms\n64 bytes from a: icmp_seq=65535 time=1 ms\n"
        "64 bytes from a: icmp_seq=0 time=1 ms\n64 bytes from a: icmp_seq=2 time=1 ms\n",
        "a", seconds{1});
    const auto all = losses(path);
    EXPECT_EQ(std::vector<double>(all.end() - 5, all.end()), (std::vector<double>{0, 0, 0, 1, 0}));
}

TEST(Ping, Refusals) {
    for (const auto& [text, reason] : std::vector<std::pair<std::string, std::string>>{
             {"PING host\n100% packet loss\n", "p.txt:2: no line like"},
             {"from a: icmp_seq=70000 time=1 ms\n", "p.txt:1: a number"},
             // Found by the fuzzer: more than any integer holds.
             {"from a: icmp_seq=1 time=1 ms\n" + std::string(32, '6') + " packets transmitted, 1 received\n",
              "p.txt:2: more than"},
             {"from a: icmp_seq=5000 time=1 ms\n20000 packets transmitted, 1 received\n",
              "p.txt:2: 20000 packets were sent, and there is no reply after packet 5000"}}) {
        EXPECT_THAT(refusal([&, &said = text] { parse_ping(said, "p.txt", seconds{1}); }), HasSubstr(reason));
    }
}

TEST(Capture, EveryLink) {
    for (const std::uint32_t link : {0U, 1U, 101U, 113U, 276U}) {
        CaptureWriter writer(link);
        for (const bool v6 : {false, true})
            writer.udp(1'700'000'000'123'456'000, 5000, 9000, "needle", {.v6 = v6});
        const Capture capture = parse_capture(writer.bytes(), "a.pcap");
        ASSERT_EQ(capture.datagrams.size(), 2U) << link;
        for (const CapturedDatagram& datagram : capture.datagrams) {
            EXPECT_EQ(datagram.stamp_ns, 1'700'000'000'123'456'000);
            EXPECT_EQ(datagram.to_port, 9000);
            EXPECT_EQ(datagram.payload_bytes, 6U);
            EXPECT_EQ(datagram.payload_hash, capture.datagrams[0].payload_hash);
        }
    }
}

TEST(Capture, Ip6HasHeadersBeforeTheDatagram) {
    CaptureWriter writer(1);
    writer.udp(0, 1, 2, "a", {.v6 = true, .options = true});
    writer.udp(1, 1, 2, "a", {.fragment = true, .v6 = true, .options = true});
    writer.udp(2, 1, 2, "a", {.protocol = 6, .v6 = true, .options = true});
    const Capture capture = parse_capture(writer.bytes(), "a");
    ASSERT_EQ(capture.datagrams.size(), 1U);
    EXPECT_EQ(capture.datagrams[0].payload_bytes, 1U);
    EXPECT_EQ(capture.fragments, 1U);
    EXPECT_EQ(capture.others, 1U);
}

TEST(Capture, PaddingVlanOthersAndAKilledCapture) {
    CaptureWriter writer(1);
    writer.udp(0, 1, 2, "a");
    writer.udp(1, 1, 2, "a", {.vlan = true, .padding = 40});
    writer.udp(2, 1, 2, "a", {.protocol = 6});
    writer.udp(3, 1, 2, "a", {.fragment = true});
    std::string bytes = writer.bytes();
    const Capture whole = parse_capture(bytes, "a");
    ASSERT_EQ(whole.datagrams.size(), 2U);
    EXPECT_EQ(whole.datagrams[0].payload_hash, whole.datagrams[1].payload_hash);
    EXPECT_EQ(whole.others, 1U);
    EXPECT_EQ(whole.fragments, 1U);
    bytes.resize(bytes.size() - 1);
    EXPECT_TRUE(parse_capture(bytes, "a").cut_at_end);
}

std::string words(std::initializer_list<std::uint32_t> values, bool big_endian = false) {
    std::string bytes;
    for (const std::uint32_t value : values) {
        for (unsigned i = 0; i < 4; ++i)
            bytes += static_cast<char>(value >> 8 * (big_endian ? 3 - i : i) & 255);
    }
    return bytes;
}

// A raw IP packet with 8 bytes for port 9000.
std::string raw_packet() {
    CaptureWriter writer(101);
    writer.udp(0, 5000, 9000, "a needle");
    return writer.bytes().substr(40);  // behind the headers of the file and of the packet
}

// Blocks for the section and the interface, and an enhanced packet.
std::string pcapng_head() {
    return words({0x0a0d0d0a, 28, 0x1a2b3c4d, 1, ~0U, ~0U, 28}) + words({1, 20, 101, 65535, 20});
}
std::string pcapng_packet(std::uint64_t stamp_us) {
    return words({6, 68, 0, static_cast<std::uint32_t>(stamp_us >> 32), static_cast<std::uint32_t>(stamp_us),
                  36, 36}) +
           raw_packet() + words({68});
}

TEST(Capture, EveryKindOfFile) {
    constexpr std::uint32_t kTime_s = 1'700'000'000;
    const auto classic = [](std::uint32_t magic, std::uint32_t version, std::uint32_t part, bool big_endian) {
        return words({magic, version, 0, 0, 65535, 101, kTime_s, part, 36, 36}, big_endian) + raw_packet();
    };
    for (const std::string& bytes :
         {classic(0xa1b2c3d4, 0x00040002, 123'456, false), classic(0xa1b2c3d4, 0x00020004, 123'456, true),
          classic(0xa1b23c4d, 0x00020004, 123'456'000, true),
          pcapng_head() + pcapng_packet(1'700'000'000'123'456)}) {
        const Capture capture = parse_capture(bytes, "a");
        ASSERT_EQ(capture.datagrams.size(), 1U);
        EXPECT_EQ(capture.datagrams[0].stamp_ns, 1'700'000'000'123'456'000);
        EXPECT_EQ(capture.datagrams[0].to_port, 9000);
        EXPECT_EQ(capture.datagrams[0].payload_bytes, 8U);
        EXPECT_FALSE(capture.cut_at_end);
    }
}

TEST(Capture, PcapngIsReadUpToTheCut) {
    const std::string whole = pcapng_head() + pcapng_packet(5), next = pcapng_packet(6);
    for (std::size_t kept = 1; kept < next.size(); ++kept) {
        const Capture capture = parse_capture(whole + next.substr(0, kept), "a");
        EXPECT_EQ(capture.datagrams.size(), 1U) << kept;
        EXPECT_TRUE(capture.cut_at_end) << kept;
    }
}

TEST(Capture, Refusals) {
    std::string late = CaptureWriter(1).bytes() + std::string(16, '\0');
    late.replace(28, 4, "\xff\xff\xff\xff");  // nanoseconds of the first packet
    for (const auto& [bytes, reason] : std::vector<std::pair<std::string, std::string>>{
             {"", "not a capture (it is empty)"},
             {"short", "not a capture"},
             {std::string(24, 'x'), "not a capture"},
             {CaptureWriter(147).bytes(), "link type 147"},
             {pcapng_head() + pcapng_packet(~0ULL), "packet 1: a time stamp out of range"},
             {late, "packet 1: a time stamp out of range"},
             {CaptureWriter(1).bytes() + std::string(16, '\x0f'),
              "packet 1: invalid packet capture length"}}) {
        EXPECT_THAT(refusal([&, &file = bytes] { parse_capture(file, "a"); }), HasSubstr(reason));
    }
}

CapturePair matched(const CaptureWriter& sent, const CaptureWriter& received,
                    const CapturePairOptions& options = {}) {
    return match_captures(parse_capture(sent.bytes(), "a"), parse_capture(received.bytes(), "b"), options);
}

// Ten packets a millisecond apart, delayed by 5 ms and more: 3 is lost, 5 comes twice, 7 comes after 8.
struct Pair {
    CaptureWriter sent{1}, received{101};
    explicit Pair(std::int64_t offset_ns) {
        const auto arrive = [&](int packet, std::int64_t delay_ns) {
            received.udp(kStart + packet * 1'000'000 + delay_ns + offset_ns, 7000, 9001, payload(packet));
        };
        for (int packet = 0; packet < 10; ++packet) {
            sent.udp(kStart + packet * 1'000'000, 5000, 9000, payload(packet));
        }
        for (const int packet : {0, 1, 2, 4, 5, 5, 6, 8, 7, 9})
            arrive(packet, 5'000'000 + packet * 1000 + (packet == 7 ? 1'500'000 : 0));
        sent.udp(kStart, 9000, 5000, "answer");
    }
    static std::string payload(int packet) { return "packet " + std::to_string(packet); }
    CapturePair match(const CapturePairOptions& options) const { return matched(sent, received, options); }
    static constexpr std::int64_t kStart = 1'700'000'000'000'000'000;
};

TEST(CapturePair, DelayLossDuplicatesAndOrder) {
    const CapturePair pair = Pair(0).match({.sent_port = std::uint16_t{9000}});
    EXPECT_EQ(pair.sent, 10U);
    EXPECT_EQ(pair.lost, 1U);
    EXPECT_EQ(pair.duplicates, 1U);
    EXPECT_EQ(pair.reordered, 1U);
    EXPECT_EQ(pair.ambiguous, 0U);
    EXPECT_EQ(losses(pair.path), (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(pair.path.packets[9].delay, microseconds{5009});
    EXPECT_EQ(pair.path.packets[9].at, 9'000'000);
    EXPECT_NO_THROW(parse_packet_trace(print_path(pair.path), "a.csv", {}));
}

TEST(CapturePair, ClocksThatAreNotSynchronised) {
    const Pair apart(-1'000'000'000);
    EXPECT_THAT(refusal([&] { apart.match({.sent_port = std::uint16_t{9000}}); }),
                HasSubstr("clocks are not synchronised"));
    const CapturePair moved = apart.match({.sent_port = std::uint16_t{9000}, .least_delay = milliseconds{2}});
    EXPECT_EQ(moved.path.packets[0].delay, milliseconds{2});
    EXPECT_EQ(moved.path.packets[9].delay, microseconds{2009});
    EXPECT_THAT(moved.path.remarks, Contains(HasSubstr("Delays were shifted by")));
}

TEST(CapturePair, EqualPayloadsAreMatchedInOrderAndSaid) {
    CaptureWriter sent(1), received(1);
    for (int i = 0; i < 4; ++i) sent.udp(i * 1000, 1, 2, "beat");
    for (int i = 0; i < 3; ++i) received.udp(i * 1000 + 500, 1, 2, "beat");
    const CapturePair pair = matched(sent, received);
    EXPECT_EQ(pair.lost, 1U);
    EXPECT_EQ(pair.ambiguous, 4U);
    EXPECT_EQ(pair.path.packets[2].delay, Duration{500});
    EXPECT_THAT(pair.path.remarks, Contains(HasSubstr("is a guess")));
}

TEST(CapturePair, NothingInCommon) {
    CaptureWriter sent(1), received(1);
    sent.udp(0, 1, 2, "a");
    received.udp(0, 1, 2, "b");
    EXPECT_THAT(refusal([&] { matched(sent, received); }), HasSubstr("are they of the same traffic"));
}

TEST(CapturePair, ClocksThatRunApartAreSaid) {
    CaptureWriter sent(1), received(1);
    for (int i = 0; i < 300; ++i) {
        sent.udp(i * 10'000'000LL, 1, 2, std::to_string(i));
        received.udp(i * 10'000'000LL + 1'000'000 + i * 1000, 1, 2, std::to_string(i));  // 100 ppm
    }
    EXPECT_THAT(matched(sent, received).path.remarks, Contains(HasSubstr("+100.0 us per second")));
}

// The least of a normal jitter wanders by itself. One clock must not seem to run apart from itself for that.
TEST(CapturePair, JitterAloneIsNoRateOfClocks) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        RandomStream random(StreamKey{.study = seed});
        Capture sent, received;
        for (int i = 0; i < 3000; ++i) {
            const std::int64_t at_ns = std::int64_t{i} * 1'000'000;
            const std::int64_t delay_ns = 50'000'000 + std::llround(5e6 * random.normal());
            const auto payload = static_cast<std::size_t>(i);
            sent.datagrams.push_back({.stamp_ns = at_ns, .payload_bytes = 8, .payload_hash = payload});
            received.datagrams.push_back(
                {.stamp_ns = at_ns + delay_ns, .payload_bytes = 8, .payload_hash = payload});
        }
        EXPECT_THAT(match_captures(sent, received, {}).path.remarks,
                    testing::Not(Contains(HasSubstr("per second"))))
            << seed;
    }
}

}  // namespace
}  // namespace thimble
