// The subjects that the parameters describe.
#include "master/operator/operator_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/netem/statistics_tools.hpp"

namespace thimble::test {
namespace {

template <typename Field>
std::vector<double> logarithms(Field field) {
    std::vector<double> values;
    for (std::uint32_t subject = 1; subject <= 5000; ++subject) {
        values.push_back(std::log(field(draw_subject(OperatorParameters{}, 11, 1, subject))));
    }
    return values;
}

double deviation(const std::vector<double>& values) {
    const double centre = mean_of(values);
    double sum = 0;
    for (const double value : values) sum += (value - centre) * (value - centre);
    return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

TEST(Subject, IsLognormalAboutTheParameters) {
    const auto criterion = logarithms([](const Subject& s) { return s.criterion_N; });
    EXPECT_NEAR(mean_of(criterion), std::log(2.0), 0.02);
    EXPECT_NEAR(deviation(criterion), 0.30, 0.015);
    const auto speed = logarithms([](const Subject& s) { return s.speed_insert_needle_m_per_s; });
    EXPECT_NEAR(mean_of(speed), std::log(0.015), 0.01);
    EXPECT_NEAR(deviation(speed), 0.15, 0.0075);
    const auto visual = logarithms([](const Subject& s) { return s.reaction_modality_factor[3]; });
    EXPECT_NEAR(deviation(visual), 0.05, 0.0025);
}

TEST(Subject, DrawsAreIndependentOfEachOther) {
    const auto arm = logarithms([](const Subject& s) { return s.arm_stiffness_N_per_m; });
    const auto grip = logarithms([](const Subject& s) { return s.grip_stiffness_N_per_m; });
    double product = 0;
    for (std::size_t i = 0; i < arm.size(); ++i)
        product += (arm[i] - mean_of(arm)) * (grip[i] - mean_of(grip));
    EXPECT_NEAR(product / static_cast<double>(arm.size()) / (deviation(arm) * deviation(grip)), 0, 0.07);
}

TEST(Subject, BelongsToStudyExperimentAndNumberOnly) {
    const Subject alone = draw_subject(OperatorParameters{}, 11, 1, 7);
    Subject in_a_batch;
    for (std::uint32_t subject = 1; subject <= 12; ++subject) {
        const Subject drawn = draw_subject(OperatorParameters{}, 11, 1, subject);
        if (subject == 7) in_a_batch = drawn;
    }
    EXPECT_EQ(alone.criterion_N, in_a_batch.criterion_N);
    EXPECT_EQ(alone.reaction_modality_factor, in_a_batch.reaction_modality_factor);
    EXPECT_NE(alone.criterion_N, draw_subject(OperatorParameters{}, 11, 1, 8).criterion_N);
    EXPECT_NE(alone.criterion_N, draw_subject(OperatorParameters{}, 11, 3, 7).criterion_N);
    // The people of experiment 2 are those of experiment 1.
    EXPECT_EQ(alone.criterion_N, draw_subject(OperatorParameters{}, 11, 2, 7).criterion_N);
    EXPECT_NE(alone.criterion_N, draw_subject(OperatorParameters{}, 12, 1, 7).criterion_N);
}

TEST(Subject, ChangingOneSpreadMovesNoOtherDraw) {
    OperatorParameters narrow;
    narrow.spread.speed = 0;
    const Subject subject = draw_subject(narrow, 11, 1, 7);
    EXPECT_EQ(subject.speed_insert_needle_m_per_s, 0.015);
    EXPECT_EQ(subject.criterion_N, draw_subject(OperatorParameters{}, 11, 1, 7).criterion_N);
}

}  // namespace
}  // namespace thimble::test
