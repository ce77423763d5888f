// The meaning of errors and silence.
#include <cerrno>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "thimble/link_test/link_figures.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

TEST(PortFinding, EachErrorHasItsMeaning) {
    EXPECT_EQ(classify({}), PortAnswer::kSilent);
    EXPECT_EQ(classify({1, ECONNREFUSED, true, 3}), PortAnswer::kAnswers);  // it came up while we knocked
    EXPECT_EQ(classify({0, ECONNREFUSED, true, 3}), PortAnswer::kNobodyListens);
    EXPECT_EQ(classify({0, ENETUNREACH}), PortAnswer::kNoRoute);
    EXPECT_EQ(classify({0, EHOSTUNREACH, true, 1}), PortAnswer::kNoRoute);
    EXPECT_EQ(classify({0, EPERM}), PortAnswer::kProhibited);
    EXPECT_EQ(classify({0, EACCES}), PortAnswer::kProhibited);
    // Linux tells "administratively prohibited" as host or net unreachable: ICMP's code knows better.
    for (const int code : {9, 10, 13}) {
        EXPECT_EQ(classify({0, EHOSTUNREACH, true, code}), PortAnswer::kProhibited);
        EXPECT_EQ(classify({0, EHOSTUNREACH, false, code}), PortAnswer::kNoRoute);
    }
}

TEST(PortFinding, TheHostIsJudgedByAllItsPorts) {
    using P = PortAnswer;
    const auto said = [](const std::vector<P>& ports) { return diagnose(ports, "robot", 27000); };
    EXPECT_EQ(said({P::kAnswers, P::kAnswers}), "");
    EXPECT_THAT(said({P::kSilent, P::kSilent}), HasSubstr("down, or a firewall drops everything"));
    EXPECT_THAT(said({P::kSilent, P::kAnswers}), HasSubstr("lets only some through"));
    EXPECT_THAT(said({P::kSilent, P::kNobodyListens}), HasSubstr("lets only some through"));
    EXPECT_THAT(said({P::kNobodyListens, P::kNobodyListens}), HasSubstr("--listen --base-port 27000"));
    EXPECT_THAT(said({P::kNobodyListens, P::kAnswers}), HasSubstr("nobody listens at some ports"));
    EXPECT_THAT(said({P::kNoRoute, P::kNoRoute}), HasSubstr("no route to robot"));
    EXPECT_THAT(said({P::kAnswers, P::kProhibited}), HasSubstr("a firewall says no"));
}

}  // namespace
}  // namespace thimble
