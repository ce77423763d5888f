// The trials of each subject, and their order.
#include "session/settings/protocol.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace thimble {
namespace {

const SystemSettings& settings() {
    static const SystemSettings s = load_system_settings({});
    return s;
}

std::map<Modality, int> count(const std::vector<TrialConditions>& trials) {
    std::map<Modality, int> counts;
    for (const TrialConditions& trial : trials) ++counts[trial.modality];
    return counts;
}

TEST(Protocol, ThePapersExperimentsHaveThePapersTrials) {
    const auto one = all_trials({experiment_1(settings(), 16, 1)});
    const auto two = all_trials({experiment_2(settings(), 16, 1)});
    const auto three = all_trials({experiment_3(settings(), 10, 1)});
    EXPECT_EQ(one.size(), 16U * 24);
    EXPECT_EQ(two.size(), 16U * 2);
    EXPECT_EQ(three.size(), 10U * 24);
    for (const Modality modality : kModalities) {
        EXPECT_EQ(count(one)[modality], 16 * 6);
        EXPECT_EQ(count(two)[modality], 8);
        EXPECT_EQ(count(three)[modality], 10 * 6);
    }
    for (const TrialConditions& trial : two) EXPECT_TRUE(trial.removes_fixture);
    for (const TrialConditions& trial : one) EXPECT_TRUE(!trial.removes_fixture && trial.delay_s == 0);
    for (const TrialConditions& trial : three) EXPECT_EQ(trial.delay_s, 0.05);
}

TEST(Protocol, RemovalsStandAfterTheTwelfthAndTheLastTrial) {
    const auto trials = all_trials({experiment_1(settings(), 16, 1), experiment_2(settings(), 16, 1)});
    ASSERT_EQ(trials.size(), 16U * 26);
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const bool removal = i % 26 == 12 || i % 26 == 25;
        EXPECT_EQ(trials[i].experiment, removal ? 2U : 1U) << i;
        EXPECT_EQ(trials[i].subject, i / 26 + 1);
        if (removal) {
            EXPECT_EQ(trials[i].trial, i % 26 == 12 ? 1U : 2U);
        }
    }
}

// Interleaved or alone, with more subjects or fewer: a trial is the same.
TEST(Protocol, NoTrialDependsOnTheOthers) {
    const auto all = all_trials({experiment_1(settings(), 16, 7), experiment_2(settings(), 16, 7)});
    std::vector<TrialConditions> parts = all_trials({experiment_1(settings(), 20, 7)});
    for (const TrialConditions& trial : all_trials({experiment_2(settings(), 20, 7)})) parts.push_back(trial);
    for (const TrialConditions& trial : all) {
        const auto same = std::find_if(parts.begin(), parts.end(), [&](const TrialConditions& other) {
            return other.experiment == trial.experiment && other.subject == trial.subject &&
                   other.trial == trial.trial;
        });
        ASSERT_NE(same, parts.end());
        EXPECT_EQ(same->modality, trial.modality);
        EXPECT_EQ(same->fixture_position_m, trial.fixture_position_m);
    }
}

std::vector<Modality> modalities_of(const Protocol& protocol, std::uint32_t subject) {
    std::vector<Modality> list;
    for (const TrialConditions& trial : subject_trials(protocol, subject)) list.push_back(trial.modality);
    return list;
}

// The first removals of a group's subjects spell the group's letters; each second removal is the letter `shift` further on.
TEST(Protocol, EachGroupPairsItsRemovalsAtAnotherDistance) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const Protocol protocol = experiment_2(settings(), 16, seed);
        std::set<std::vector<Modality>> letters_of_groups;
        for (std::uint32_t group = 0; group < 4; ++group) {
            std::vector<Modality> letters;
            for (std::uint32_t i = 0; i < 4; ++i)
                letters.push_back(modalities_of(protocol, 4 * group + i + 1)[0]);
            EXPECT_EQ(std::set<Modality>(letters.begin(), letters.end()).size(), 4U);
            letters_of_groups.insert(letters);
            const std::uint32_t shift = 1 + group % 3;
            for (std::uint32_t i = 0; i < 4; ++i) {
                EXPECT_EQ(modalities_of(protocol, 4 * group + i + 1)[1], letters[(i + shift) % 4])
                    << "seed " << seed << ", group " << group << ", subject " << i;
            }
        }
        EXPECT_GE(letters_of_groups.size(), 2U);
    }
}

TEST(Protocol, RemovalsGoThroughAllModalitiesBeforeOneComesAgain) {
    Protocol protocol = experiment_2(settings(), 16, 1);
    protocol.removals_per_subject = 5;
    for (std::uint32_t subject = 1; subject <= 16; ++subject) {
        const std::vector<Modality> order = modalities_of(protocol, subject);
        ASSERT_EQ(order.size(), 5U);
        EXPECT_EQ(std::set<Modality>(order.begin(), order.begin() + 4).size(), 4U) << subject;
        EXPECT_EQ(order[4], order[0]) << subject;
    }
    protocol.modalities = {Modality::kCF};
    EXPECT_EQ(modalities_of(protocol, 2), std::vector<Modality>(5, Modality::kCF));
}

TEST(Protocol, FixturesAreDrawnWithinTheJitter) {
    for (const TrialConditions& trial : all_trials({experiment_1(settings(), 16, 3)})) {
        EXPECT_GE(trial.fixture_position_m, 0.108);
        EXPECT_LE(trial.fixture_position_m, 0.138);
    }
}

// Each condition once in each position, and after each other condition equally often.
TEST(Williams, DesignsAreBalancedForPositionAndCarryOver) {
    for (const std::uint32_t n : {2U, 3U, 4U, 5U, 6U}) {
        const auto rows = williams_design(n);
        EXPECT_EQ(rows.size(), n % 2 == 0 ? n : 2 * n);
        std::map<std::pair<std::size_t, std::uint32_t>, std::size_t> positions;
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> follows;
        for (const auto& row : rows) {
            ASSERT_EQ(std::set<std::uint32_t>(row.begin(), row.end()).size(), n);
            for (std::size_t i = 0; i < n; ++i) ++positions[{i, row[i]}];
            for (std::size_t i = 1; i < n; ++i) ++follows[{row[i - 1], row[i]}];
        }
        for (const auto& [where, times] : positions) EXPECT_EQ(times, rows.size() / n);
        EXPECT_EQ(follows.size(), std::size_t{n} * (n - 1));
        for (const auto& [pair, times] : follows) EXPECT_EQ(times, rows.size() / n);
    }
}

// A subject begins with the row after the one of the subject before, and goes on row by row. Each row has every modality.
TEST(Williams, BlocksRotateThroughTheRows) {
    Protocol protocol = experiment_1(settings(), 16, 1);
    protocol.order = TrialOrder::kWilliams;
    std::vector<std::vector<Modality>> before;
    std::map<Modality, int> first;
    for (std::uint32_t subject = 1; subject <= 16; ++subject) {
        SCOPED_TRACE(subject);
        const std::vector<Modality> order = modalities_of(protocol, subject);
        ASSERT_EQ(order.size(), 24U);
        std::vector<std::vector<Modality>> own;
        for (auto at = order.begin(); at != order.end(); at += 4) {
            EXPECT_EQ(std::set<Modality>(at, at + 4).size(), 4U);
            own.emplace_back(at, at + 4);
        }
        ++first[order[0]];
        EXPECT_EQ(std::set<std::vector<Modality>>(own.begin(), own.begin() + 4).size(), 4U);
        EXPECT_EQ(own[4], own[0]);
        for (std::size_t block = 1; block < before.size(); ++block) EXPECT_EQ(own[block - 1], before[block]);
        before = own;
    }
    for (const auto& [modality, times] : first) EXPECT_EQ(times, 4);
}

TEST(TrialOrder, HasNames) {
    EXPECT_EQ(parse_order("williams"), TrialOrder::kWilliams);
    EXPECT_EQ(parse_order(to_string(TrialOrder::kShuffled)), TrialOrder::kShuffled);
    EXPECT_FALSE(parse_order("latin"));
}

}  // namespace
}  // namespace thimble
