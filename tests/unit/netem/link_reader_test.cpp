#include "netem/link_reader.hpp"

#include <string>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "netem/delivery_trace.hpp"
#include "netem/jitter_table.hpp"
#include "netem/netem_settings.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Stands for the readers of files: whatever the name, one of each.
LinkSources sources() {
    LinkSources all;
    all.jitter_table = [](const std::string&) {
        return std::make_shared<const JitterTable>(std::vector{-1.0, 1.0});
    };
    all.trace = [](const TraceRequest& request) {
        return std::make_shared<const PacketTrace>(
            std::vector<TraceRow>{{.at = 0, .delay = seconds{2}}},
            TraceLayout{.by = request.by, .between = request.between, .end = request.end});
    };
    all.deliveries = [](const std::string&) {
        return std::make_shared<const DeliveryTrace>(std::vector<std::uint32_t>{4});
    };
    all.profile = [](const std::string& name) {
        LinkSettings link{.delay = milliseconds{name == "leo" ? 30 : 300}};
        link.loss = LossSettings::gilbert(0.01, 3);
        return link;
    };
    return all;
}

LinkSettings read(const std::string& text, const LinkSettings& base = {}) {
    const ConfigFile file = ConfigFile::parse("[link]\n" + text, "link.toml");
    const LinkSettings link = read_link_settings(file.table("link"), base, sources());
    file.finish();
    return link;
}

// The message of the refusal, empty if there was none.
std::string refusal(const std::string& text) {
    try {
        read(text);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        return error.what();
    }
    return {};
}

TEST(LinkSettings, DefaultIsAnIdealLink) {
    const LinkSettings link = read("");
    EXPECT_EQ(link.delay, Duration::zero());
    EXPECT_EQ(link.jitter.shape, JitterShape::kNone);
    EXPECT_EQ(link.loss, LossSettings::independent(0));
    EXPECT_TRUE(link.in_order);
    EXPECT_EQ(link.capacity, 4096U);
}

TEST(LinkSettings, ReadsEveryKey) {
    const LinkSettings link = read(
        "delay_s = 0.05\njitter = \"normal\"\njitter_spread_s = 0.005\nloss = 0.01\nin_order = false\n"
        "capacity = 100");
    EXPECT_EQ(link.delay, milliseconds{50});
    EXPECT_EQ(link.jitter.shape, JitterShape::kNormal);
    EXPECT_EQ(link.jitter.spread, milliseconds{5});
    EXPECT_EQ(link.loss, LossSettings::independent(0.01));
    EXPECT_FALSE(link.in_order);
    EXPECT_EQ(link.capacity, 100U);
    EXPECT_EQ(read("jitter = \"uniform\"\ndelay_s = 1\njitter_spread_s = 1").jitter.shape,
              JitterShape::kUniform);
}

TEST(LinkSettings, RefusesWhatIsOutOfRange) {
    EXPECT_NE(refusal("delay_s = -0.001").find("delay_s"), std::string::npos);
    EXPECT_NE(refusal("delay_s = 60.1").find("delay_s"), std::string::npos);
    EXPECT_NE(refusal("loss = 1.01").find("loss"), std::string::npos);
    EXPECT_NE(refusal("jitter = \"parreto\"").find("uniform"), std::string::npos);
    EXPECT_NE(refusal("capacity = 0").find("capacity"), std::string::npos);
    EXPECT_NE(refusal("delay_ms = 50").find("delay_ms"), std::string::npos);
}

TEST(LinkSettings, RefusesWhatContradictsItself) {
    EXPECT_NE(refusal("delay_s = 0.05\njitter_spread_s = 0.01").find("distribution"), std::string::npos);
    EXPECT_NE(refusal("delay_s = 0.05\njitter = \"normal\"").find("above 0"), std::string::npos);
    const std::string uniform = "delay_s = 0.05\njitter = \"uniform\"\njitter_spread_s = ";
    EXPECT_EQ(refusal(uniform + "0.05"), "");
    EXPECT_NE(refusal(uniform + "0.051").find("cut at 0"), std::string::npos);
    const std::string normal = "delay_s = 0.05\njitter = \"normal\"\njitter_spread_s = ";
    EXPECT_EQ(refusal(normal + "0.025"), "");
    EXPECT_NE(refusal(normal + "0.026").find("cut at 0"), std::string::npos);
}

TEST(LinkSettings, CapacityMustHoldTheDelay) {
    EXPECT_NE(refusal("delay_s = 0.05\ncapacity = 50").find("51 packets"), std::string::npos);
    EXPECT_EQ(refusal("delay_s = 0.05\ncapacity = 51"), "");
    EXPECT_GE(read("delay_s = 60").capacity, 120'000U);
}

TEST(LinkSettings, ReadsEveryKindOfFault) {
    const LinkSettings link = read(
        "duplicate = 0.1\ncorrupt = 0.2\ncorrupt_bits = 3\nreorder = 0.3\nreorder_gap = 5\nin_order = false\n"
        "rate_bits_per_s = 1e6\nrate_overhead_bytes = 28\nrate_queue_packets = 10\nrate_queue_bytes = 9000\n"
        "rate_drop = \"head\"\nslot_least_s = 0.001\nslot_most_s = 0.01\nslot_packets = 42\nslot_bytes = "
        "64000\n"
        "[[link.outage]]\nstart_s = 15\nlength_s = 0.14\nevery_s = 15\n[[link.outage]]\nlength_s = 1");
    LinkSettings expected;
    expected.duplicate = 0.1;
    expected.corrupt = 0.2;
    expected.corrupt_bits = 3;
    expected.reorder = 0.3;
    expected.reorder_gap = 5;
    expected.in_order = false;
    expected.rate = {1e6, 28, 10, 9000, Drop::kHead};
    expected.slot = {milliseconds{1}, milliseconds{10}, 42, 64000};
    expected.outages = {{seconds{15}, milliseconds{140}, seconds{15}}, {{}, seconds{1}, {}}};
    EXPECT_EQ(link, expected);
}

TEST(LinkSettings, ReadsEveryJitter) {
    const std::string rest = "\ndelay_s = 0.05\njitter_spread_s = 0.02\njitter_correlation = 0.5";
    EXPECT_EQ(read("jitter = \"gamma\"" + rest).jitter.shape, JitterShape::kGamma);
    EXPECT_EQ(read("jitter = \"pareto\"" + rest).jitter.shape, JitterShape::kPareto);
    EXPECT_EQ(read("jitter = \"pareto-normal\"" + rest).jitter.correlation, 0.5);
    const LinkSettings table = read("jitter = \"table\"\njitter_table = \"wifi.dist\"" + rest);
    ASSERT_NE(table.jitter.table, nullptr);
    EXPECT_EQ(table.jitter.table->quantile(0.5), 0);
}

TEST(LinkSettings, ReadsEveryLoss) {
    EXPECT_EQ(read("loss = 0.1\nloss_burst = 4").loss, LossSettings::gilbert(0.1, 4));
    EXPECT_EQ(read("[link.loss]\nshare = 0.1").loss, LossSettings::independent(0.1));
    EXPECT_EQ(read("[link.loss]\nmodel = \"gilbert\"\nshare = 0.1\nmean_burst = 4").loss,
              LossSettings::gilbert(0.1, 4));
    EXPECT_EQ(read("loss = 0", read("loss = 0.1")).loss, LossSettings{});
    const LossSettings chain =
        read("loss = {model = \"gilbert\", good_to_bad = 0.1, bad_to_good = 0.3}").loss;
    EXPECT_DOUBLE_EQ(stationary_loss(chain), 0.25);
    const LossSettings elliott =
        read(
            "loss = {model = \"gilbert-elliott\", good_to_bad = 0.1, bad_to_good = 0.3, loss_in_good = 0.01, "
            "loss_in_bad = 0.5}")
            .loss;
    EXPECT_DOUBLE_EQ(stationary_loss(elliott), 0.75 * 0.01 + 0.25 * 0.5);
    const LossSettings four =
        read("loss = {model = \"four-state\", p13 = 0.1, p31 = 0.2, p32 = 0.3, p23 = 0.4, p14 = 0.05}").loss;
    EXPECT_EQ(four.shape, LossShape::kFourState);
    EXPECT_EQ(four.p14, 0.05);
}

TEST(LinkSettings, RefusesLossesThatCannotBe) {
    EXPECT_NE(refusal("loss = 0.9\nloss_burst = 2").find("0.6667"), std::string::npos);
    EXPECT_NE(refusal("loss = {model = \"gilbert\", share = 0.6}").find("share"), std::string::npos);
    EXPECT_NE(refusal("loss = {model = \"four-state\", p13 = 0.1, p31 = 0}").find("p31"), std::string::npos);
    EXPECT_NE(refusal("loss = {model = \"four-state\", p31 = 0.5, p32 = 0.1}").find("p23"),
              std::string::npos);
    EXPECT_NE(refusal("loss = {model = \"four-state\", p13 = 0.1, p31 = 0.7, p32 = 0.6, p23 = 0.4}")
                  .find("at most 1"),
              std::string::npos);
    EXPECT_NE(refusal("loss = {model = \"four-state\", p13 = 0.6, p14 = 0.6}").find("p14"),
              std::string::npos);
    EXPECT_NE(refusal("loss = {model = \"gilbert\", p13 = 0.6}").find("p13"), std::string::npos);
    EXPECT_NE(refusal("loss = \"much\"").find("number"), std::string::npos);
}

TEST(LinkSettings, RefusesMoreThatContradictsItself) {
    EXPECT_NE(refusal("reorder = 0.1").find("in_order = false"), std::string::npos);
    EXPECT_NE(refusal("jitter_correlation = 0.1").find("distribution"), std::string::npos);
    EXPECT_NE(refusal("jitter = \"table\"\ndelay_s = 1\njitter_spread_s = 0.1").find("file"),
              std::string::npos);
    EXPECT_NE(refusal("jitter_table = \"x\"").find("jitter = \"table\""), std::string::npos);
    EXPECT_NE(refusal("rate_queue_packets = 3").find("nothing ever waits"), std::string::npos);
    EXPECT_NE(refusal("deliveries = \"x\"\nrate_bits_per_s = 1e6").find("remove one"), std::string::npos);
    EXPECT_NE(refusal("deliveries = \"x\"\nslot_most_s = 0.1").find("remove one"), std::string::npos);
    EXPECT_NE(refusal("slot_least_s = 0.2\nslot_most_s = 0.1").find("slot_least_s"), std::string::npos);
    EXPECT_NE(refusal("slot_packets = 2").find("slot_most_s"), std::string::npos);
    EXPECT_NE(refusal("[[link.outage]]\nstart_s = 1").find("length_s"), std::string::npos);
    EXPECT_NE(refusal("[[link.outage]]\nlength_s = 2\nevery_s = 1").find("every_s"), std::string::npos);
    EXPECT_NE(refusal("trace_end = \"hold\"").find("name one"), std::string::npos);
    EXPECT_NE(refusal("jitter = \"gamma\"\ndelay_s = 0.1\njitter_spread_s = 1.1").find("ten times"),
              std::string::npos);
}

TEST(LinkSettings, TracesCountForTheCapacity) {
    const LinkSettings link = read("trace = \"x.csv\"\ntrace_by = \"packet\"\ntrace_between = \"linear\"");
    EXPECT_EQ(link.trace->layout().by, TraceBy::kPacket);
    EXPECT_EQ(link.trace->layout().between, TraceBetween::kLinear);
    EXPECT_GE(link.capacity, 4002U);
    EXPECT_NE(refusal("trace = \"x.csv\"\ncapacity = 100").find("2001"), std::string::npos);
}

TEST(LinkSettings, ProfileIsWhatTheOtherKeysStartFrom) {
    const LinkSettings link = read("profile = \"leo\"\nduplicate = 0.1");
    EXPECT_EQ(link.delay, milliseconds{30});
    EXPECT_EQ(link.loss, LossSettings::gilbert(0.01, 3));
    EXPECT_EQ(link.duplicate, 0.1);
    EXPECT_EQ(read("profile = \"leo\"\ndelay_s = 0.1").delay, milliseconds{100});
}

TEST(LinkSettings, WithoutASourceFilesAreRefused) {
    for (const std::string key : {"trace", "deliveries", "profile", "jitter_table"}) {
        const ConfigFile file = ConfigFile::parse(key + " = \"x\"", "link.toml");
        EXPECT_THROW(read_link_settings(file.root()), Error) << key;
    }
}

const char* const kTimeline =
    "[netem.force]\ndelay_s = 0.05\nloss = 0.01\n"
    "[[netem.force.timeline]]\nat_s = 10\nloss = 0.2\n"
    "[[netem.force.timeline]]\nat_s = 20.5\ndelay_s = 0.3\n"
    "[[netem.force.timeline]]\nat_s = 30\nloss = 0\n";

TEST(Timeline, EachEntryBeginsWithTheSettingsBeforeIt) {
    const ConfigFile file = ConfigFile::parse(kTimeline, "session.toml");
    const NetemSettings netem = read_netem_settings(file);
    file.finish();
    ASSERT_EQ(netem.force_timeline.size(), 3U);
    EXPECT_TRUE(netem.needle_timeline.empty());
    EXPECT_EQ(netem.force_timeline[0].at, seconds{10});
    EXPECT_EQ(netem.force_timeline[0].settings.delay, milliseconds{50});
    EXPECT_EQ(netem.force_timeline[0].settings.loss, LossSettings::independent(0.2));
    EXPECT_EQ(netem.force_timeline[1].at, milliseconds{20'500});
    EXPECT_EQ(netem.force_timeline[1].settings.loss, LossSettings::independent(0.2));
    EXPECT_EQ(netem.force_timeline[2].settings.delay, milliseconds{300});
    EXPECT_EQ(netem.force_timeline[2].settings.loss, LossSettings{});
}

TEST(SessionLinks, AProfileGivesEachDirectionItsWay) {
    const ConfigFile file = ConfigFile::parse(
        "[netem.needle]\nprofile = \"5g-nsa\"\n[netem.force]\nprofile = \"5g-nsa\"\nloss = 0.25\n",
        "session.toml");
    const NetemSettings netem = read_netem_settings(file);
    file.finish();
    const LinkProfile profile = load_profile("5g-nsa");
    EXPECT_EQ(netem.needle, profile.up);
    EXPECT_EQ(netem.force.delay, profile.down.delay);
    EXPECT_NE(netem.force.delay, netem.needle.delay);
    EXPECT_EQ(netem.force.loss, LossSettings::independent(0.25));
}

TEST(SessionLinks, RefuseAProfileThatIsNotThere) {
    const ConfigFile file = ConfigFile::parse("[netem.force]\nprofile = \"5g-sa\"\n", "session.toml");
    try {
        read_netem_settings(file);
        FAIL() << "nothing was refused";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("5g-nsa"), std::string::npos) << error.what();
    }
}

TEST(Timeline, AnotherDelayHoldsUntilTheTimelineHasItsOwn) {
    NetemSettings netem = read_netem_settings(ConfigFile::parse(kTimeline, "session.toml"));
    set_delay(netem.force, netem.force_timeline, milliseconds{7});
    EXPECT_EQ(netem.force.delay, milliseconds{7});
    EXPECT_EQ(netem.force_timeline[0].settings.delay, milliseconds{7});
    EXPECT_EQ(netem.force_timeline[1].settings.delay, milliseconds{300});
    EXPECT_EQ(netem.force_timeline[2].settings.delay, milliseconds{300});
}

TEST(Timeline, RefusesWhatIsOutOfOrder) {
    const auto refused = [](const std::string& text) {
        const ConfigFile file = ConfigFile::parse(text, "session.toml");
        EXPECT_THROW(
            {
                read_netem_settings(file);
                file.finish();
            },
            Error)
            << text;
    };
    refused("[[netem.force.timeline]]\nloss = 0.1");
    refused("[[netem.force.timeline]]\nat_s = 0");
    refused("[[netem.force.timeline]]\nat_s = 2\n[[netem.force.timeline]]\nat_s = 2");
    refused("[[netem.force.timeline]]\nat_s = 2\nlos = 1");
    refused("[[netem.force.timeline]]\nat_s = 2\ntimeline = 1");
}

}  // namespace
}  // namespace thimble
