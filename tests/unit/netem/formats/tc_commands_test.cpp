// Command lines of tc and its output are read, also a table of such texts from other people.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "netem/formats/tc_command.hpp"
#include "netem/formats/tc_text.hpp"
#include "netem/formats/text_lines.hpp"
#include "netem/profiles/profiles.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::Contains;
using testing::HasSubstr;

std::string refused(const std::string& text) {
    return refusal([&] { parse_tc(text); }, ExitCode::kUsage);
}

TEST(TcCommands, AQdiscIsTheWayUpUnlessItSaysBoth) {
    const TcWays one = parse_tc("tc qdisc add dev eth0 root netem delay 100ms");
    EXPECT_EQ(one.up.delay, milliseconds{100});
    EXPECT_EQ(one.down, LinkSettings{});
    EXPECT_TRUE(one.one_way);
    EXPECT_THAT(one.notes, Contains(HasSubstr("add `both`")));
    for (const Way known : {Way::kUp, Way::kDown}) {
        const TcWays said = parse_tc("tc qdisc add dev ifb0 root netem delay 100ms", known);
        EXPECT_EQ((known == Way::kUp ? said.up : said.down).delay, milliseconds{100});
        EXPECT_EQ(known == Way::kUp ? said.down : said.up, LinkSettings{});
        EXPECT_TRUE(said.notes.empty());
    }
    EXPECT_THAT(refusal([] { parse_tc("delay 1ms both", Way::kUp); }, ExitCode::kUsage),
                HasSubstr("`both` contradicts"));
    const TcWays both = parse_tc("delay 100ms both");
    EXPECT_EQ(both.up, both.down);
    EXPECT_FALSE(both.one_way);
    EXPECT_EQ(load_profile("delay 100ms").down, LinkSettings{});
    EXPECT_EQ(load_profile("delay 100ms both").down.delay, milliseconds{100});
}

TEST(TcCommands, InATableOfASessionWordsAreThatDirections) {
    for (const Way way : {Way::kUp, Way::kDown})
        EXPECT_EQ(session_sources({}, way).profile("delay 20ms").delay, milliseconds{20});
}

TEST(TcCommands, CommandsAreCarriedOutInTurn) {
    const std::string add = "tc qdisc add dev eth0 root netem delay 100ms";
    EXPECT_EQ(parse_tc(add + " && tc qdisc change dev eth0 root netem loss 1%").up.delay, Duration{});
    EXPECT_EQ(parse_tc(add + "; sleep 5; tc qdisc replace dev eth0 root netem delay 7ms").up.delay,
              milliseconds{7});
    EXPECT_EQ(parse_tc("tc qdisc del dev eth0 root 2> /dev/null || true\n" + add + " 2>&1 >out").up.delay,
              milliseconds{100});
    EXPECT_THAT(refused(add + "\ntc qdisc del dev eth0 root"),
                HasSubstr("'tc qdisc del dev eth0 root' removes"));
    EXPECT_THAT(refused("sudo tc qdisc del dev eth0 root"), HasSubstr("\"ideal\""));
}

TEST(TcCommands, TwoDevicesAreTwoWays) {
    const TcWays ways = parse_tc(
        "ip netns exec h1 tc qdisc add dev eth0 root netem delay 10ms && ip netns exec h2 tc qdisc add dev "
        "eth0 root "
        "netem delay 20ms");
    EXPECT_EQ(ways.up.delay, milliseconds{10});
    EXPECT_EQ(ways.down.delay, milliseconds{20});
    EXPECT_THAT(ways.notes, Contains(HasSubstr("dev ip netns exec h1 eth0 is the way up")));
    const TcWays incoming = parse_tc(
        "tc qdisc add dev ifb0 root netem delay 1ms\ntc -n h1 qdisc add dev eth0 root netem delay 2ms");
    EXPECT_EQ(incoming.down.delay, milliseconds{1});
    EXPECT_EQ(incoming.up.delay, milliseconds{2});
    EXPECT_EQ(parse_tc("tc qdisc add dev ifb0 root netem delay 1ms").up, LinkSettings{});
}

TEST(TcCommands, TheOutputOfShowIsRead) {
    const TcWays shown = parse_tc(
        "qdisc noqueue 0: dev lo root refcnt 2\n"
        "qdisc netem 8001: dev eth0 root refcnt 2 limit 1000 delay 50ms  10ms 25% loss gemodel p 1% r 10% "
        "1-h 70% 1-k "
        "0.1% duplicate 1% rate 1Mbit packetoverhead 20 cellsize 100 celloverhead 5 ecn \n"
        " Sent 0 bytes 0 pkt (dropped 0, overlimits 0 requeues 0)\n backlog 0b 0p requeues 0\n");
    EXPECT_EQ(shown.up.capacity, 1000U);
    EXPECT_EQ(shown.up.jitter.correlation, 0.25);
    EXPECT_EQ(shown.up.loss.loss_in_bad, 0.7);
    EXPECT_EQ(shown.up.rate, (RateSettings{1e6, 20, 0, 0, Drop::kTail, 100, 5}));
    EXPECT_TRUE(shown.up.ecn);
    EXPECT_THAT(shown.notes, Contains(HasSubstr("tc's output has no distribution")));
    EXPECT_EQ(parse_tc("qdisc netem 1: root refcnt 2 limit 9 loss state p13 1% p31 2% p32 3% p23 4% p14 5%")
                  .up.loss.p14,
              0.05);
}

TEST(TcCommands, WhatIsNotNetemsIsSaid) {
    EXPECT_THAT(refused("tc qdisc add dev eth0 root tbf rate 1mbit burst 32kbit latency 400ms"),
                HasSubstr("tbf limits the rate and is not netem's"));
    EXPECT_THAT(refused("tc qdisc show dev eth0"), HasSubstr("paste its output"));
    EXPECT_THAT(refused("tc qdisc add dev a root netem delay ${D}ms"), HasSubstr("shell variable"));
    EXPECT_THAT(
        parse_tc(
            "tc qdisc add dev a root handle 1: prio; tc filter add dev a parent 1: u32; tc qdisc add dev a "
            "parent 1:1 netem loss 1%; modprobe ifb")
            .notes,
        testing::AllOf(Contains(HasSubstr("prio is a qdisc of its own")), Contains(HasSubstr("filter sorts")),
                       Contains(HasSubstr("left out 1 command that is not part of tc"))));
    EXPECT_THAT(
        refused("tc qdisc add dev a parent 1:1 netem loss 1%; tc qdisc add dev a parent 1:2 netem loss 2%"),
        HasSubstr("dev a has several netem qdiscs"));
}

TEST(TcCommands, TheSeedIsTheRelays) {
    EXPECT_EQ(load_profile("loss 1% seed 18446744073709551615").seed, 18446744073709551615U);
    EXPECT_FALSE(load_profile("loss 1%").seed);
}

std::string unescaped(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool escape = text[i] == '\\' && i + 1 < text.size();
        out += !escape ? text[i] : text[++i] == 'n' ? '\n' : text[i];
    }
    return out;
}

std::string way_text(const LinkSettings& link) {
    return link == LinkSettings{} ? "nothing"
                                  : print_tc(link, "").words + (link.in_order ? "" : " [overtakes]");
}

// As the table has it.
std::string outcome(const std::string& text) {
    try {
        const TcWays ways = parse_tc(text);
        return "up " + way_text(ways.up) + "; down " + way_text(ways.down);
    } catch (const Error& error) {
        return std::string("refused: ") + error.what();
    }
}

TEST(TcCommands, TheTableOfRealCommandLines) {
    const std::string text =
        read_whole_file(std::string(THIMBLE_SOURCE_DIR) + "/tests/unit/netem/formats/tc_command_lines.tsv");
    int rows = 0;
    for (LineReader lines(text, "table"); lines.next();) {
        if (lines.line().starts_with('#')) continue;
        const std::size_t first = lines.line().find('\t'), second = lines.line().rfind('\t');
        ASSERT_NE(first, second) << lines.number();
        const std::string command(lines.line().substr(first + 1, second - first - 1));
        EXPECT_EQ(outcome(unescaped(command)), lines.line().substr(second + 1))
            << lines.number() << ": " << command;
        EXPECT_TRUE(looks_like_tc_words(unescaped(command))) << lines.number();
        ++rows;
    }
    EXPECT_GE(rows, 60);
}

}  // namespace
}  // namespace thimble
