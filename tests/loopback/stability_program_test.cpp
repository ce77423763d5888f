// `thimble stability` and `thimble sweep` as users start them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Outcome of_hand(const std::string& command, const std::vector<std::string>& more) {
    return run_thimble(
        words_in(command + " --mass-kg 1 --damping-Ns-per-m 20 --stiffness-N-per-m 500", more));
}

Outcome theory_at(const std::vector<std::string>& more) {
    return of_hand("stability", words_in("--contact-stiffness-N-per-m 9000", more));
}

TEST(StabilityProgram, PrintsWhatTheTheorySays) {
    const Outcome outcome = theory_at({"--delay-s", "0.05", "--step-s", "0.001", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.words;
    const auto json = nlohmann::json::parse(outcome.words);
    EXPECT_NEAR(json.at("critical_delay_s").get<double>() / 2.239576310403288e-3, 1, 1e-12);
    EXPECT_NEAR(json.at("crossing_frequency_rad_per_s").get<double>() / 9.639038705802363e+1, 1, 1e-12);
    EXPECT_EQ(json.at("delay_independent_stiffness_N_per_m").get<double>(), 400);
    EXPECT_NEAR(json.at("rightmost_root_real_per_s").get<double>() / 2.54826669843477e+1, 1, 1e-12);
    EXPECT_NEAR(json.at("rightmost_root_imag_rad_per_s").get<double>() / 3.492447932835105e+1, 1, 1e-12);
    EXPECT_NEAR(json.at("critical_stiffness_N_per_m").get<double>() / 5.340630929273794e+2, 1, 1e-12);
    EXPECT_NEAR(json.at("spectral_radius").get<double>() / 1.025718599497551, 1, 1e-12);
    EXPECT_NEAR(json.at("critical_samples").get<double>() / 1.740452074241897, 1, 1e-12);
    EXPECT_TRUE(json.at("press").at("limit_cycle").at("contact_lost").get<bool>());
    const Outcome table = theory_at({});
    EXPECT_EQ(table.code, 0);
    EXPECT_THAT(table.words, HasSubstr("critical_delay_s                          0.00223958"));
}

TEST(StabilityProgram, RefusesWhatMeansNothing) {
    for (const char* delay : {"-1", "nan", "inf", "x"}) {
        EXPECT_EQ(theory_at({"--delay-s=" + std::string(delay)}).code, 2) << delay;
    }
    const Outcome step = theory_at({"--delay-s", "0.05", "--step-s", "0"});
    EXPECT_EQ(step.code, 2);
    EXPECT_THAT(step.words, HasSubstr("a step must be 1e-9 to 1e3 s"));
    EXPECT_EQ(of_hand("stability", {"--contact-stiffness-N-per-m", "0"}).code, 2);
    EXPECT_EQ(of_hand("stability", {}).code, 2);
}

TEST(StabilityProgram, AnInterruptedMapGoesOnToTheSameBytes) {
    const Folder folder;
    const auto sweep = [&](const std::string& out, const std::string& delays, const std::string& jobs) {
        return of_hand("sweep", {"--delay-s", delays, "--contact-stiffness-N-per-m", "100:20000:4", "--out",
                                 (folder / out).string(), "--jobs", jobs});
    };
    const Outcome whole = sweep("whole", "0:0.1:3", "1");
    ASSERT_EQ(whole.code, 0) << whole.words;
    const std::string table = read_text(folder / "whole/map.csv");
    EXPECT_THAT(table, StartsWith("hand,operator,remedy,"));
    std::filesystem::create_directory(folder / "half");
    std::filesystem::copy(folder / "whole/map.txt", folder / "half/map.txt");
    folder.write("half/map.csv", table.substr(0, table.size() * 2 / 3));
    EXPECT_EQ(sweep("half", "0:0.1:3", "2").code, 0);
    EXPECT_EQ(read_text(folder / "half/map.csv"), table);
    const Outcome other = sweep("half", "0:0.2:3", "2");
    EXPECT_EQ(other.code, 2);
    EXPECT_THAT(other.words, HasSubstr("another map"));
    EXPECT_EQ(sweep("bad", "0.1:0:3", "1").code, 2);
    EXPECT_EQ(sweep("bad", "0,0.1,", "1").code, 2);
    EXPECT_EQ(sweep("bad", "-1", "1").code, 2);
}

}  // namespace
}  // namespace thimble
