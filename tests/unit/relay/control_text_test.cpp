#include "netem/relay/control_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "common/error.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;

LinkPair fifty() {
    LinkPair links;
    links.up.delay = links.down.delay = milliseconds{50};
    return links;
}

std::string assign_refusal(const std::vector<std::string>& assignments) {
    return refusal([&] { assign(fifty(), assignments); }, ExitCode::kUsage);
}

TEST(ControlRequest, IsAVerbAndItsLines) {
    EXPECT_EQ(parse_request("show").verb, ControlRequest::Verb::kShow);
    EXPECT_EQ(parse_request("  show \r\n\n").verb, ControlRequest::Verb::kShow);
    const ControlRequest set = parse_request("set\nup.delay_s = 0.1\n\nloss=0.01\n");
    EXPECT_EQ(set.verb, ControlRequest::Verb::kSet);
    EXPECT_THAT(set.assignments, ElementsAre("up.delay_s = 0.1", "loss=0.01"));
}

TEST(ControlRequest, RefusesEverythingElse) {
    for (const std::string& text :
         std::vector<std::string>{"", "\n\n", "set", "shown", "show now", "show\nloss=1", "SHOW",
                                  std::string(3, '\0'), std::string(kLongestRequestBytes + 1, 'x')}) {
        EXPECT_THROW(parse_request(text), Error) << text.substr(0, 20);
    }
}

TEST(Assign, ChangesOneDirectionOrBoth) {
    const LinkPair links = assign(fifty(), {"up.delay_s=0.1", "loss = 0.01"});
    EXPECT_EQ(links.up.delay, milliseconds{100});
    EXPECT_EQ(links.down.delay, milliseconds{50});
    EXPECT_EQ(stationary_loss(links.up.loss), 0.01);
    EXPECT_EQ(stationary_loss(links.down.loss), 0.01);
}

TEST(Assign, KeepsWhatIsNotNamed) {
    const LinkPair before = assign(fifty(), {"jitter=normal", "jitter_spread_s=0.005", "loss=0.2"});
    const LinkPair after = assign(before, {"down.delay_s=0.06"});
    EXPECT_EQ(after.up, before.up);
    EXPECT_EQ(after.down.jitter, before.down.jitter);
    EXPECT_EQ(after.down.loss, before.down.loss);
    EXPECT_EQ(after.down.delay, milliseconds{60});
}

TEST(Assign, TakesABareWordAsText) {
    for (const char* jitter : {"jitter=uniform", "jitter=\"uniform\""})
        EXPECT_EQ(assign(fifty(), {jitter, "jitter_spread_s=0.005"}).up.jitter.shape, JitterShape::kUniform)
            << jitter;
    EXPECT_FALSE(assign(fifty(), {"in_order=false"}).up.in_order);
}

TEST(Assign, TakesSecondsWithAUnit) {
    const LinkPair links = assign(fifty(), {"up.delay_s=20ms", "down.delay_s = 5s"});
    EXPECT_EQ(links.up.delay, milliseconds{20});
    EXPECT_EQ(links.down.delay, milliseconds{5000});
    EXPECT_THAT(assign_refusal({"delay_s=20xs"}), HasSubstr("is \"20xs\": write seconds"));
    EXPECT_THAT(assign_refusal({"delay_s=20"}), HasSubstr("for 20 ms write 0.02"));
}

TEST(Assign, SaysWhatIsWrong) {
    for (const char* no_assignment : {"delay_s", "=3", "delay_s=", "a b=3"})
        EXPECT_THAT(assign_refusal({no_assignment}), HasSubstr("KEY=VALUE"));
    for (const auto& [assignment, key] : {std::pair{"up.nonsense=3", "nonsense"},
                                          {"loss=1.5", "loss"},
                                          {"delay_s=-1", "delay_s"},
                                          {"jitter_spread_s=0.001", "jitter"}}) {
        EXPECT_THAT(assign_refusal({assignment}), HasSubstr(key));
    }
    EXPECT_THAT(assign_refusal({"delay_s=0.1", "delay_s=0.2"}), HasSubstr("delay_s"));
    EXPECT_THROW(assign(fifty(), {"loss=[[[["}), Error);
}

RC_GTEST_PROP(Assign, RefusesOrObeysWhateverComes, (const std::string& key, const std::string& value)) {
    try {
        assign(fifty(), {key + "=" + value});
    } catch (const Error& error) {
        RC_ASSERT(error.code() == ExitCode::kUsage);
    }
}

RC_GTEST_PROP(ControlRequest, RefusesOrReadsWhateverComes, (const std::string& text)) {
    try {
        parse_request(text);
    } catch (const Error& error) {
        RC_ASSERT(error.code() == ExitCode::kUsage);
    }
}

}  // namespace
}  // namespace thimble
