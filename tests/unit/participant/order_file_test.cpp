// The order of a participant: drawn once, written, read back.
#include "session/participant/order_file.hpp"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/settings/protocol.hpp"
#include "tests/unit/participant/short_sessions.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

SystemSettings paper_session() {
    return read_system_settings(
        ConfigFile::parse("[protocol]\nexperiments = [1, 2]\nbreak_every = 13\n", "session.toml"));
}

void expect_same(const TrialConditions& a, const TrialConditions& b) {
    EXPECT_EQ(a.trial, b.trial);
    EXPECT_EQ(a.experiment, b.experiment);
    EXPECT_EQ(a.modality, b.modality);
    EXPECT_EQ(a.fixture_position_m, b.fixture_position_m);
}

TEST(OrderFile, ThePapersFirstSession) {
    const auto order = plan_order(paper_session(), 7);
    ASSERT_EQ(order.size(), 4U + 24 + 2);
    std::set<std::pair<std::uint32_t, std::uint32_t>> keys;
    for (std::size_t i = 0; i < order.size(); ++i) {
        EXPECT_EQ(order[i].position, i + 1);
        EXPECT_EQ(order[i].practice, i < 4);
        EXPECT_EQ(order[i].block, i < 4 ? 0U : i < 17 ? 1U : 2U);
        EXPECT_EQ(order[i].conditions.subject, 7U);
        EXPECT_EQ(order[i].conditions.removes_fixture, i == 4 + 12 || i == 4 + 25);
        keys.insert({order[i].conditions.experiment, order[i].conditions.trial});
    }
    EXPECT_EQ(keys.size(), order.size()) << "no trial of one experiment has the number of another";
}

TEST(OrderFile, PracticeChangesNoOtherTrial) {
    const auto with = plan_order(short_settings(), 2);
    SystemSettings settings = short_settings();
    settings.protocol->practice_trials = 0;
    const auto without = plan_order(settings, 2);
    ASSERT_EQ(with.size(), without.size() + 1);
    for (std::size_t i = 0; i < without.size(); ++i)
        expect_same(with[i + 1].conditions, without[i].conditions);
}

TEST(OrderFile, AgreesWithTheStudy) {
    const SystemSettings settings = paper_session();
    const auto order = plan_order(settings, 3);
    auto study = all_trials({experiment_1(settings, 16, 1), experiment_2(settings, 16, 1)});
    std::erase_if(study, [](const TrialConditions& c) { return c.subject != 3; });
    ASSERT_EQ(study.size() + 4, order.size());
    for (std::size_t i = 0; i < study.size(); ++i) expect_same(order[i + 4].conditions, study[i]);
}

TEST(OrderFile, ComesBackToTheBit) {
    const TemporaryDirectory folder;
    const auto order = plan_order(paper_session(), 7);
    write_order(folder / "orders/sub-07_order.tsv", order);
    EXPECT_EQ(difference(read_order(folder / "orders/sub-07_order.tsv", 7), order), "");
}

TEST(OrderFile, SaysWhatDiffers) {
    const auto order = plan_order(paper_session(), 7);
    auto other = order;
    other[20].conditions.modality =
        other[20].conditions.modality == Modality::kHF ? Modality::kCF : Modality::kHF;
    EXPECT_THAT(difference(order, other), HasSubstr("position 21 modality is"));
    other = order;
    other.pop_back();
    EXPECT_THAT(difference(order, other), HasSubstr("30 trials, the settings give 29"));
    EXPECT_NE(difference(order, plan_order(paper_session(), 8)), "");
}

TEST(OrderFile, DamageIsNamedWithItsLine) {
    const TemporaryDirectory folder;
    const auto file = folder / "order.tsv";
    write_order(file, plan_order(short_settings(), 1));
    const std::string text = read_text(file);
    for (const auto& [from, to] : {std::pair{"HF", "XF"}, {"\n2\t", "\n9\t"}, {"position", "place"}}) {
        std::string damaged = text;
        damaged.replace(damaged.find(from), std::string(from).size(), to);
        write_text(file, damaged);
        EXPECT_THAT(refusal([&] { read_order(file, 1); }), HasSubstr("order.tsv:")) << from;
    }
}

TEST(OrderFile, NobodyBeyondThePlan) {
    EXPECT_NO_THROW(plan_order(short_settings(), 4));
    EXPECT_THROW(plan_order(short_settings(), 5), Error);
    EXPECT_THROW(plan_order(SystemSettings{}, 1), Error);
}

}  // namespace
}  // namespace thimble
