#include "analysis/statistics/mixed_model.hpp"

#include "tests/unit/statistics/golden.hpp"

namespace thimble {
namespace {

struct MixedCase {
    NamedValues values;
    std::vector<NamedValues> columns;
    std::vector<std::size_t> group;
};

MixedCase case_of(const nlohmann::json& j) {
    MixedCase data{column("y", j.at("y")), {}, j.at("subject").get<std::vector<std::size_t>>()};
    data.columns.push_back({"intercept", std::vector<double>(data.values.values.size(), 1.0)});
    for (const char* name : {"first", "second", "trial"}) data.columns.push_back(column(name, j.at(name)));
    return data;
}

// tests/golden/make_mixed_models.R
TEST(MixedModel, AgreesWithLme4) {
    std::ifstream in(THIMBLE_GOLDEN_DIR "/mixed_models.json");
    const auto all = nlohmann::json::parse(in).at("cases");
    ASSERT_EQ(all.size(), 4U);
    for (const auto& expected : all) {
        SCOPED_TRACE(expected.at("name"));
        const MixedCase data = case_of(expected);
        const MixedModel model = mixed_model(data.values, data.columns, data.group);
        const double rest = expected.at("variances")[1].get<double>();
        EXPECT_NEAR(model.variance_group, expected.at("variances")[0].get<double>(), 2e-5 * rest);
        EXPECT_NEAR(model.variance_rest, rest, 1e-5 * rest);
        EXPECT_NEAR(model.log_likelihood, expected.at("log_likelihood").get<double>(), 1e-7);
        for (std::size_t k = 0; k < model.effects.size(); ++k) {
            const double error = expected.at("standard_errors")[k].get<double>();
            EXPECT_NEAR(model.effects[k].standard_error, error, 1e-5 * error);
            EXPECT_NEAR(model.effects[k].estimate, expected.at("estimates")[k].get<double>(), 1e-5 * error);
        }
    }
}

TEST(MixedModel, AConstantPerSubjectChangesNoSlope) {
    std::ifstream in(THIMBLE_GOLDEN_DIR "/mixed_models.json");
    MixedCase data = case_of(nlohmann::json::parse(in).at("cases")[0]);
    const MixedModel before = mixed_model(data.values, data.columns, data.group);
    for (std::size_t i = 0; i < data.group.size(); ++i)
        data.values.values[i] += 100.0 * static_cast<double>(data.group[i]);
    const MixedModel after = mixed_model(data.values, data.columns, data.group);
    EXPECT_GT(after.variance_group, 1000 * before.variance_group);
    EXPECT_NEAR(after.effects[3].estimate, before.effects[3].estimate,
                0.1 * before.effects[3].standard_error);
}

TEST(MixedModel, RefusesWhatItCannotTell) {
    const NamedValues values{"y", {1, 2, 3, 5, 4, 6}}, one{"intercept", {1, 1, 1, 1, 1, 1}};
    const NamedValues twice{"twice", {2, 2, 2, 2, 2, 2}};
    EXPECT_THROW(mixed_model(values, {one}, {1, 1, 1, 1, 1, 1}), Error);
    EXPECT_THROW(mixed_model(values, {one}, {1, 2, 3, 4, 5, 6}), Error);
    EXPECT_THROW(mixed_model(values, {one}, {1, 2}), Error);
    EXPECT_THROW(mixed_model(values, {}, {1, 1, 1, 2, 2, 2}), Error);
    EXPECT_THROW(mixed_model(values, {one, twice}, {1, 1, 1, 2, 2, 2}), Error);
    EXPECT_THROW(mixed_model(values, {{"short", {1}}}, {1, 1, 1, 2, 2, 2}), Error);
}

// Ten subjects with each of four modalities in the same order. Rounding hides that the columns depend on each other.
TEST(MixedModel, RefusesAnOrderThatIsTheSameForAll) {
    const auto model = [](bool same_order) {
        MixedCase data{{"y", {}}, {{"intercept", {}}, {"trial", {}}, {"a", {}}, {"b", {}}, {"c", {}}}, {}};
        for (std::size_t place = 0; place < 4; ++place) {
            for (std::size_t subject = 0; subject < 10; ++subject) {
                const std::size_t modality = same_order ? place : (place + subject) % 4;
                data.group.push_back(subject);
                data.values.values.push_back(static_cast<double>((7 * subject + 5 * place * place) % 11));
                data.columns[0].values.push_back(1);
                data.columns[1].values.push_back(static_cast<double>(place + 1) / 10);
                for (std::size_t k = 1; k < 4; ++k)
                    data.columns[k + 1].values.push_back(k == modality ? 1 : 0);
            }
        }
        return mixed_model(data.values, data.columns, data.group);
    };
    EXPECT_THROW(model(true), Error);
    EXPECT_LT(model(false).effects[1].standard_error, 100);
}

}  // namespace
}  // namespace thimble
