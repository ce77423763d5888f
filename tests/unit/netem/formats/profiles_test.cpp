// The profiles that come with the program, and those that people write.
#include "netem/profiles/profiles.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "netem/formats/tc_text.hpp"
#include "netem/link_model.hpp"
#include "netem/packet_trace.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::Contains;
using testing::HasSubstr;

std::string no_files(std::string_view name) {
    throw Error(ExitCode::kData, std::string(name) + ": no such file");
}

LinkProfile parsed_profile(std::string_view text) { return parse_profile(text, "lab.toml", no_files); }

// The link's effects, by the first words of a source line.
std::vector<std::string> topics_of(const LinkSettings& link) {
    std::vector<std::string> topics;
    if (link.delay > Duration::zero()) topics.emplace_back("delay");
    if (link.jitter.shape != JitterShape::kNone) topics.emplace_back("jitter");
    if (link.jitter.correlation > 0) topics.emplace_back("jitter_correlation");
    if (link.loss.shape != LossShape::kNone || (link.trace && link.trace->layout().has_loss)) {
        topics.emplace_back("loss");
    }
    if (link.rate.bits_per_s > 0) topics.emplace_back("rate");
    if (link.slot.most > Duration::zero()) topics.emplace_back("slot");
    if (!link.outages.empty()) topics.emplace_back("outage");
    if (link.trace) topics.emplace_back("trace");
    return topics;
}

bool has_source(const LinkProfile& profile, const std::string& topic) {
    return std::any_of(profile.source.begin(), profile.source.end(), [&](const std::string& line) {
        const std::size_t dot = line.find("down.") == 0 ? 5 : line.find("up.") == 0 ? 3 : 0;
        return line.compare(dot, topic.size() + 1, topic + ":") == 0 && line.size() > topic.size() + 20;
    });
}

TEST(Profiles, EachHasASourceForAllItDoesAndWorks) {
    ASSERT_EQ(profile_names().size(), 14U);
    for (const std::string_view name : profile_names()) {
        const LinkProfile profile = load_profile(std::string(name));
        EXPECT_EQ(profile.name, name);
        EXPECT_FALSE(profile.about.empty()) << name;
        EXPECT_FALSE(profile.source.empty()) << name;
        for (const LinkSettings* link : {&profile.up, &profile.down}) {
            for (const std::string& topic : topics_of(*link)) {
                EXPECT_TRUE(has_source(profile, topic)) << name << ": no source for " << topic;
            }
            EXPECT_FALSE(print_tc(*link, "eth0").command.empty());
            LinkModel model(*link, StreamKey{}, 0);
            const std::uint8_t bytes[100]{};
            for (int i = 0; i < 1000; ++i) model.push(SessionTime{milliseconds{i}}, bytes);
            EXPECT_GT(model.counters().pushed - model.counters().lost, 950U) << name;
        }
    }
}

TEST(Profiles, EveryFileIsAName) {
    for (const BuiltInFile& file : built_in_profile_files()) {
        if (file.name.find(".toml") == std::string_view::npos) continue;
        EXPECT_THAT(profile_names(), Contains(file.name.substr(0, file.name.size() - 5)));
    }
}

TEST(Profiles, DirectionsAreThePapers) {
    const LinkProfile paper = load_profile("paper50");
    EXPECT_EQ(paper.up, LinkSettings{});
    EXPECT_EQ(paper.down.delay, milliseconds{50});
    EXPECT_EQ(paper.down.jitter, JitterSettings{});
    EXPECT_EQ(load_profile("ideal").down, LinkSettings{});
}

TEST(Profiles, LeoRepeatsEachFifteenSeconds) {
    const LinkProfile leo = load_profile("leo");
    for (const LinkSettings* link : {&leo.up, &leo.down}) {
        ASSERT_TRUE(link->trace);
        EXPECT_EQ(link->trace->period(), 15'000'000'000);
        const auto delay_at = [&](double at_s) { return link->trace->at(from_seconds(at_s).count()).delay; };
        EXPECT_EQ(delay_at(7), milliseconds{18});
        EXPECT_GT(delay_at(15.05), milliseconds{40});
        EXPECT_GT(delay_at(29.97), milliseconds{40});
        EXPECT_EQ(delay_at(30.2), milliseconds{18});
    }
}

TEST(Profiles, UnknownNamesAreAnsweredWithThoseThereAre) {
    EXPECT_THAT(refusal([] { load_profile("5g"); }, ExitCode::kUsage), HasSubstr("ideal, paper50"));
}

TEST(Profiles, TcsWordsAreTheWayUp) {
    const LinkProfile profile = load_profile("delay 50ms 10ms duplicate 1% 20%");
    EXPECT_EQ(profile.up, parse_tc("delay 50ms 10ms duplicate 1%").up);
    EXPECT_EQ(profile.down, LinkSettings{});
    EXPECT_THAT(profile.notes, testing::ElementsAre(HasSubstr("duplicate"), HasSubstr("the way up only")));
}

TEST(ProfileLink, KeysOfOneDirection) {
    const LinkProfile profile = parsed_profile(R"(
[up]
delay_s = 0.05
jitter = "gamma"
jitter_spread_s = 0.01
jitter_correlation = 0.5
loss = 0.01
loss_burst = 4
duplicate = 0.02
corrupt = 0.03
corrupt_bits = 8
reorder = 0.1
reorder_gap = 3
ecn = true
rate_cell_bytes = 48
rate_cell_overhead_bytes = 5
slot_shape = "pareto"
in_order = false
rate_bits_per_s = 1e6
rate_overhead_bytes = 42
rate_queue_packets = 10
rate_queue_bytes = 1000
rate_drop = "head"
slot_least_s = 0.001
slot_most_s = 0.01
slot_packets = 5
slot_bytes = 500
[[up.outage]]
start_s = 10
length_s = 1
every_s = 20
)");
    LinkSettings link;
    link.delay = milliseconds{50};
    link.jitter = {JitterShape::kGamma, milliseconds{10}, 0.5};
    link.loss.shape = LossShape::kGilbertElliott;
    link.loss.bad_to_good = 0.25;
    link.loss.good_to_bad = 0.01 / 0.99 / 4;
    link.duplicate = 0.02;
    link.corrupt = 0.03;
    link.corrupt_bits = 8;
    link.reorder = 0.1;
    link.reorder_gap = 3;
    link.in_order = false;
    link.ecn = true;
    link.rate = {1e6, 42, 10, 1000, Drop::kHead, 48, 5};
    link.slot = {milliseconds{1}, milliseconds{10}, 5, 500, JitterShape::kPareto};
    link.outages = {{seconds{10}, seconds{1}, seconds{20}}};
    EXPECT_EQ(profile.up, link);
    EXPECT_NEAR(stationary_loss(profile.up.loss), 0.01, 1e-12);
    EXPECT_EQ(profile.down, LinkSettings{});
    // A new part must be named here, set above, and written.
    const auto& [delay, jitter, loss, duplicate, corrupt, corrupt_bits, reorder, reorder_gap, in_order, ecn,
                 rate, slot, outages, trace, deliveries, capacity] = link;
    link.capacity = capacity + 10'000;
    link.outages.clear();     // not written
    link.delay = seconds{5};  // which a reader doubts without its unit
    LinkProfile written{"lab", "a \"quoted\" name", {"line \\ one"}, link, {}, {}, {}};
    const LinkProfile again = parsed_profile(print_profile(written));
    EXPECT_EQ(again.about, written.about);
    EXPECT_EQ(again.source, written.source);
    EXPECT_NEAR(again.up.loss.good_to_bad, link.loss.good_to_bad, 1e-12);
    written.up.loss = again.up.loss;
    EXPECT_EQ(again.up, written.up);
}

TEST(ProfileLink, RefusalsNameTheKey) {
    for (const auto& [text, reason] :
         {std::pair{"[up]\ndelay = 1\n", "unknown key 'up.delay'"},
          {"[upp]\n", "unknown"},
          {"[[change]]\nat_s = 2\n[[change]]\nat_s = 1\n", "must not be before"}})
        EXPECT_THAT(refusal([&, &lines = text] { parsed_profile(lines); }, ExitCode::kUsage),
                    HasSubstr(reason))
            << text;
}

TEST(Timeline, ChangesBuildOnOneAnother) {
    const LinkProfile profile = parsed_profile(R"(
[down]
delay_s = 0.05
[[change]]
at_s = 10
direction = "down"
loss = 0.1
[[change]]
at_s = 20
delay_s = 0.2
)");
    ASSERT_EQ(profile.down_changes.size(), 2U);
    ASSERT_EQ(profile.up_changes.size(), 1U);
    EXPECT_EQ(profile.down_changes[0].settings.delay, milliseconds{50});
    EXPECT_EQ(profile.down_changes[0].settings.loss, LossSettings::independent(0.1));
    EXPECT_EQ(profile.down_changes[1].at, seconds{20});
    EXPECT_EQ(profile.down_changes[1].settings.delay, milliseconds{200});
    EXPECT_EQ(profile.down_changes[1].settings.loss, LossSettings::independent(0.1));
    EXPECT_EQ(profile.up_changes[0].settings.delay, milliseconds{200});
}

}  // namespace
}  // namespace thimble
