// Figures of the stability study (tests/golden/stability.json): each computed twice, at 50 digits and in double, by methods that
// share nothing. Some are numbers, some text with more digits.
#pragma once

#include <cmath>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stability/delayed_loop.hpp"

namespace thimble {

inline const nlohmann::json& golden_loops(const char* kind) {
    static const nlohmann::json all = [] {
        std::ifstream in(THIMBLE_GOLDEN_DIR "/stability.json");
        return nlohmann::json::parse(in);
    }();
    EXPECT_FALSE(all.at(kind).empty()) << kind;
    return all.at(kind);
}

inline double figure(const nlohmann::json& c, const char* name) {
    const nlohmann::json& value = c.at(name);
    return value.is_string() ? std::stod(value.get<std::string>()) : value.get<double>();
}

inline HeldMass hand_of(const nlohmann::json& c) { return {figure(c, "m"), figure(c, "b"), figure(c, "k")}; }

inline void expect_relative(double actual, double expected, double relative, const std::string& what) {
    EXPECT_LE(std::abs(actual - expected), relative * std::abs(expected))
        << what << ": " << actual << ", not " << expected;
}

}  // namespace thimble
