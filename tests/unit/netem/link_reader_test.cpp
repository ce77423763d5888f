#include "netem/link_reader.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "netem/delivery_trace.hpp"
#include "netem/jitter_table.hpp"
#include "netem/netem_settings.hpp"
#include "netem/profiles/profiles.hpp"
#include "tests/refusal.hpp"

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

std::string link_refusal(const std::string& text) {
    return refusal([&] { read(text); }, ExitCode::kUsage);
}

TEST(LinkSettings, DefaultIsAnIdealLink) { EXPECT_EQ(read(""), LinkSettings{}); }

TEST(LinkSettings, CapacityMustHoldTheDelay) {
    EXPECT_THAT(link_refusal("delay_s = 0.05\ncapacity = 50"), testing::HasSubstr("51 packets"));
    EXPECT_NO_THROW(read("delay_s = 0.05\ncapacity = 51"));
    EXPECT_GE(read("delay_s = '60s'").capacity, 120'000U);
    const LinkSettings narrow{.delay = milliseconds{100}, .capacity = 50};
    EXPECT_EQ(read("loss = 0.01", narrow).capacity, 50U) << "no key changes the delay";
    EXPECT_EQ(read("delay_s = 0.2", narrow).capacity, 402U);
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

TEST(LinkSettings, RefusesWhatContradictsItself) {
    const std::string uniform = "delay_s = 0.05\njitter = \"uniform\"\njitter_spread_s = ";
    const std::string normal = "delay_s = 0.05\njitter = \"normal\"\njitter_spread_s = ";
    const std::string four = "loss = {model = \"four-state\", ";
    EXPECT_NO_THROW(read(uniform + "0.05"));
    EXPECT_NO_THROW(read(normal + "0.025"));
    const std::vector<std::pair<std::string, const char*>> cases{
        {"delay_s = 0.05\njitter_spread_s = 0.01", "distribution"},
        {"delay_s = 0.05\njitter = \"normal\"", "above 0"},
        {uniform + "0.051", "cut at 0"},
        {normal + "0.026", "must not exceed 0.5 of delay_s"},
        {"jitter = \"gamma\"\ndelay_s = 0.1\njitter_spread_s = 1.1", "ten times"},
        {"jitter_correlation = 0.1", "distribution"},
        {"jitter = \"table\"\ndelay_s = 1\njitter_spread_s = 0.1", "must name a file"},
        {"jitter_table = \"x\"", "jitter = \"table\""},
        {"loss = 0.9\nloss_burst = 2", "0.6667"},
        {"loss = 0.1\nloss_burst = 0.5", "at least 1 packet"},
        {"loss = {share = 0.1}\nloss_burst = 3", "mean_burst"},
        {"loss = {model = \"gilbert\", share = 0.6}", "share"},
        {"loss = {model = \"gilbert\", share = 0.1, bad_to_good = 0.3}", "bad_to_good"},
        {"loss = {model = \"gilbert\", p13 = 0.6}", "choose four-state"},
        {four + "p13 = 0.1, p31 = 0}", "p31"},
        {four + "p31 = 0.5, p32 = 0.1}", "p23"},
        {four + "p13 = 0.1, p31 = 0.7, p32 = 0.6, p23 = 0.4}", "at most 1"},
        {four + "p13 = 0.6, p14 = 0.6}", "p14"},
        {"reorder = 0.1", "in_order = false"},
        {"rate_bits_per_s = 0.5", "at least 1"},
        {"rate_queue_packets = 3", "no packet waits"},
        {"deliveries = \"x\"\nrate_bits_per_s = 1e6", "remove one"},
        {"deliveries = \"x\"\nslot_most_s = 0.1", "remove one"},
        {"slot_least_s = 0.2\nslot_most_s = 0.1", "must not be below slot_least_s"},
        {"slot_most_s = 0.000001", "at least 0.00001"},
        {"slot_packets = 2", "slot_most_s"},
        {"[[link.outage]]\nstart_s = 1", "'link.outage[0].length_s' must be above 0"},
        {"[[link.outage]]\nlength_s = 2\nevery_s = 1", "every_s"},
        {"trace_end = \"hold\"", "name one"}};
    for (const auto& [text, why] : cases) EXPECT_THAT(link_refusal(text), testing::HasSubstr(why)) << text;
}

TEST(LinkSettings, TracesCountForTheCapacity) {
    const LinkSettings link = read("trace = \"x.csv\"\ntrace_by = \"packet\"\ntrace_between = \"linear\"");
    EXPECT_EQ(link.trace->layout().by, TraceBy::kPacket);
    EXPECT_EQ(link.trace->layout().between, TraceBetween::kLinear);
    EXPECT_GE(link.capacity, 4002U);
    EXPECT_THAT(link_refusal("trace = \"x.csv\"\ncapacity = 100"), testing::HasSubstr("2001"));
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

NetemSettings read_netem(const std::string& text) {
    const ConfigFile file = ConfigFile::parse(text, "session.toml");
    NetemSettings netem = read_netem_settings(file);
    file.finish();
    return netem;
}

TEST(Timeline, EachEntryBeginsWithTheSettingsBeforeIt) {
    const NetemSettings netem = read_netem(kTimeline);
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
    const NetemSettings netem = read_netem(
        "[netem.needle]\nprofile = \"5g-nsa\"\n[netem.force]\nprofile = \"5g-nsa\"\nloss = 0.25\n");
    const LinkProfile profile = load_profile("5g-nsa");
    EXPECT_EQ(netem.needle, profile.up);
    EXPECT_EQ(netem.force.delay, profile.down.delay);
    EXPECT_NE(netem.force.delay, netem.needle.delay);
    EXPECT_EQ(netem.force.loss, LossSettings::independent(0.25));
}

TEST(SessionLinks, RefuseAProfileThatIsNotThere) {
    EXPECT_THAT(refusal([] { read_netem("[netem.force]\nprofile = \"5g-sa\"\n"); }, ExitCode::kUsage),
                testing::HasSubstr("5g-nsa"));
}

TEST(Timeline, AnotherDelayHoldsUntilTheTimelineHasItsOwn) {
    NetemSettings netem = read_netem(kTimeline);
    set_delay(netem.force, netem.force_timeline, milliseconds{7});
    EXPECT_EQ(netem.force.delay, milliseconds{7});
    EXPECT_EQ(netem.force_timeline[0].settings.delay, milliseconds{7});
    EXPECT_EQ(netem.force_timeline[1].settings.delay, milliseconds{300});
    EXPECT_EQ(netem.force_timeline[2].settings.delay, milliseconds{300});
}

TEST(Timeline, LinksHoldWhatAnotherDelayNeeds) {
    NetemSettings netem = read_netem(kTimeline);
    set_delay(netem.force, netem.force_timeline, seconds{5});
    EXPECT_EQ(netem.force.capacity, 10'002U);
    EXPECT_EQ(netem.force_timeline[0].settings.capacity, 10'002U);
    EXPECT_EQ(netem.force_timeline[1].settings.capacity, LinkSettings{}.capacity);
    EXPECT_EQ(read_netem("[session]\ndelays_s = ['5s', '6s']\n").force.capacity, 10'002U);
}

TEST(Timeline, RefusesWhatIsOutOfOrder) {
    for (const char* text :
         {"[[netem.force.timeline]]\nloss = 0.1", "[[netem.force.timeline]]\nat_s = 0",
          "[[netem.force.timeline]]\nat_s = 2\n[[netem.force.timeline]]\nat_s = 2",
          "[[netem.force.timeline]]\nat_s = 2\nlos = 1", "[[netem.force.timeline]]\nat_s = 2\ntimeline = 1"})
        EXPECT_THROW(read_netem(text), Error) << text;
}

}  // namespace
}  // namespace thimble
