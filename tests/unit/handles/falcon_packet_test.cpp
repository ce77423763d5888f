// The Falcon's packets: known bytes, every value back, and a reader that finds its feet again.
#include "master/devices/falcon/falcon_packet.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace thimble {
namespace {

std::string text(const FalconPacket& packet) { return {packet.begin(), packet.end()}; }

TEST(FalconPacket, GoldenCommands) {
    EXPECT_EQ(text(encode(FalconCommand{{}, false, 0})), "<AAAAAAAAAAAAAA>");
    EXPECT_EQ(text(encode(FalconCommand{{}, true, kFalconGreen})), "<AAAAAAAAAAAADA>");
    EXPECT_EQ(text(encode(FalconCommand{{1, -1, 4095}, true, kFalconBlue})), "<BAAAPPPPPPPAFA>");
    EXPECT_EQ(text(encode(FalconCommand{{-4095, 100, -100}, true, kFalconRed})), "<BAAPEGAAMJPPJA>");
}

TEST(FalconPacket, MotorsAreCutAtTheirLimit) {
    EXPECT_EQ(encode(FalconCommand{{32767, -32768, 0}, true, 0}),
              encode(FalconCommand{{4095, -4095, 0}, true, 0}));
}

TEST(FalconPacket, GoldenEncoder) {
    const std::string letters = "<JFKPAAAAAAAAxA>";
    FalconPacket packet{};
    std::copy(letters.begin(), letters.end(), packet.begin());
    packet[13] = 'A' + 0x71;
    const auto report = decode_falcon_report(packet);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->encoders[0], -1447);
    EXPECT_EQ(report->buttons, 1);
    EXPECT_TRUE(report->homed());
}

RC_GTEST_PROP(FalconPacketProperty, ReportsComeBackWhateverStoodBefore,
              (std::int16_t a, std::int16_t b, std::int16_t c, std::vector<std::uint8_t> noise)) {
    const FalconReport sent{{a, b, c}, 5, 7};
    FalconReportReader reader;
    reader.take(noise);
    // Earlier bytes may absorb the first packet, never the second.
    const FalconPacket packet = encode(sent);
    reader.take(packet);
    const auto report = reader.take(packet);
    RC_ASSERT(report.has_value());
    RC_ASSERT(report->encoders == sent.encoders);
    RC_ASSERT(report->buttons == 5 && report->homed());
}

TEST(FalconPacket, AShortReportCostsItselfOnly) {
    FalconReportReader reader;
    const FalconPacket packet = encode(FalconReport{{1, 2, 3}, 0, 7});
    const std::span<const std::uint8_t> whole(packet);
    EXPECT_FALSE(reader.take(whole.first(9)));
    EXPECT_TRUE(reader.take(whole));
    EXPECT_FALSE(reader.take(whole.first(5)));
    EXPECT_TRUE(reader.take(whole.subspan(5)));  // in two pieces
    EXPECT_EQ(reader.reports(), 2U);
}

TEST(FalconPacket, WrongLettersAreNoReport) {
    FalconPacket packet = encode(FalconReport{});
    for (const std::size_t place : {0U, 3U, 12U, 13U, 15U}) {
        FalconPacket wrong = packet;
        wrong[place] = 'A' - 1;
        EXPECT_FALSE(decode_falcon_report(wrong)) << place;
    }
    packet[5] = 'Q';
    EXPECT_FALSE(decode_falcon_report(packet));
}

}  // namespace
}  // namespace thimble
