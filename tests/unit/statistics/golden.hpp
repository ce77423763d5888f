// Results of R, SciPy and statsmodels (tests/golden/statistics.json, made by make_statistics.py), and the allowed differences.
#pragma once

#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "analysis/statistics/sample_table.hpp"
#include "common/error.hpp"

namespace thimble {

// The data sets of one kind; fewer than ten fail the test that asked.
inline const nlohmann::json& golden(const char* kind) {
    static const nlohmann::json all = [] {
        std::ifstream in(THIMBLE_GOLDEN_DIR "/statistics.json");
        return nlohmann::json::parse(in);
    }();
    EXPECT_GE(all.at(kind).size(), 10U) << kind;
    return all.at(kind);
}

inline std::vector<double> numbers(const nlohmann::json& j) { return j.get<std::vector<double>>(); }

inline NamedValues column(const std::string& name, const nlohmann::json& values) {
    return {name, numbers(values)};
}

inline std::vector<NamedValues> columns(const std::vector<std::vector<double>>& values) {
    std::vector<NamedValues> named;
    for (const auto& one : values) named.push_back({"column " + std::to_string(named.size()), one});
    return named;
}

inline std::vector<NamedValues> golden_columns(const nlohmann::json& values) {
    return columns(values.get<std::vector<std::vector<double>>>());
}

inline SampleTable table(const std::vector<std::vector<double>>& values) {
    return SampleTable::from_columns(columns(values));
}

inline testing::AssertionResult close(double actual, double expected, double relative, double absolute = 0) {
    const double error = std::abs(actual - expected);
    if (error <= relative * std::abs(expected) + absolute) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << std::hexfloat << actual << std::defaultfloat << " (" << actual << ") is not " << expected
           << ", off by " << error << ", relative " << error / std::abs(expected);
}

// The words an Error must hold for the reader to know what to do.
template <class Call>
void expect_refused(const Call& call, const std::vector<std::string>& words) {
    try {
        call();
        FAIL() << "not refused";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kData);
        for (const std::string& word : words) {
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
                << word << ": " << error.what();
        }
    }
}

inline constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

}  // namespace thimble
