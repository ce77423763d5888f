// Replays of recorded needles: the golden vectors through files, and what a replay refuses.
#include "thimble/commands/replay.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/messages.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Replay : public testing::Test {
  protected:
    ReplayOptions options(const std::string& scene, const std::string& needle) const {
        ReplayOptions o;
        o.scene = folder_ / "scene.toml";
        o.needle = folder_ / "needle.csv";
        o.out = folder_ / "out.csv";
        write_text(o.scene, scene);
        write_text(o.needle, "time_s,position_needle_m\n" + needle);
        return o;
    }
    std::string refused(const ReplayOptions& o, ExitCode code) const {
        const std::string words = refusal([&o] { replay(o); }, code);
        EXPECT_FALSE(std::filesystem::exists(folder_ / "out.csv"));
        return words;
    }

    const TemporaryDirectory folder_;
};

std::vector<std::vector<std::string>> fields(const std::filesystem::path& path) {
    std::vector<std::vector<std::string>> lines;
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) {
        lines.emplace_back();
        std::istringstream rest(line);
        for (std::string field; std::getline(rest, field, ',');) lines.back().push_back(field);
    }
    return lines;
}

std::string scene_text(const json& p) {
    const auto text = [&p](const char* key) { return p.at(key).get<std::string>(); };
    return fmt::format(
        "[tissue]\nmass_kg = {}\nstiffness_N_per_m = {}\ndamping_Ns_per_m = {}\ndrag_Ns_per_m = {}\n"
        "puncture_force_N = {}\nrest_position_m = {}\n[fixture]\nstiffness_N_per_m = {}\nposition_m = {}\n",
        text("M"), text("K"), text("B"), text("V"), text("Fp"), text("zbar"), text("Kvf"), text("zvf"));
}

double number(const json& value) { return std::stod(value.get<std::string>()); }

bool near_event(const json& events, double time_s) {
    for (const json& event : events) {
        if (std::abs(number(event.at("t")) - time_s) < 1e-9) return true;
    }
    return false;
}

void expect_samples(const json& g, const std::vector<std::vector<std::string>>& lines) {
    ASSERT_EQ(lines.size(), g.at("t").size() + 1);
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
        const std::vector<std::string>& line = lines[i + 1];
        ASSERT_EQ(line.size(), 8u);
        ASSERT_EQ(std::stod(line[0]), number(g.at("t")[i]));
        ASSERT_EQ(std::stod(line[1]), number(g.at("z_needle")[i]));
        ASSERT_EQ(std::stod(line[7]), std::stod(line[5]) + std::stod(line[6]));
        if (near_event(g.at("events"), std::stod(line[0]))) continue;
        ASSERT_NEAR(std::stod(line[2]), number(g.at("z_tissue")[i]), 1e-14) << line[0];
        ASSERT_NEAR(std::stod(line[3]), number(g.at("v_tissue")[i]), 1e-13) << line[0];
        ASSERT_EQ(line[4], g.at("mode")[i].get<std::string>()) << line[0];
        ASSERT_NEAR(std::stod(line[7]), number(g.at("force")[i]), 1e-12) << line[0];
    }
}

void expect_events(const json& golden, const std::vector<std::vector<std::string>>& lines) {
    ASSERT_EQ(lines[0], (std::vector<std::string>{"time_s", "element", "phase"}));
    std::size_t found = 0;
    for (std::size_t i = 1; i < lines.size(); ++i) {
        if (lines[i][1] != "tissue") continue;
        ASSERT_LT(found, golden.size());
        EXPECT_NEAR(std::stod(lines[i][0]), number(golden[found].at("t")), 1e-12);
        EXPECT_EQ(lines[i][2], golden[found].at("mode").get<std::string>());
        ++found;
    }
    EXPECT_EQ(found, golden.size());
}

TEST_F(Replay, GoldenNeedles) {
    std::ifstream in(THIMBLE_GOLDEN_DIR "/tissue.json");
    const json cases = json::parse(in);
    ASSERT_EQ(cases.size(), 6u);
    for (const json& g : cases) {
        SCOPED_TRACE(g.at("name").get<std::string>());
        std::string needle;
        for (std::size_t i = 0; i < g.at("t").size(); ++i) {
            needle += fmt::format("{},{}\n", g.at("t")[i].get<std::string>(),
                                  g.at("z_needle")[i].get<std::string>());
        }
        const ReplayResult result = replay(options(scene_text(g.at("params")), needle));
        EXPECT_EQ(result.samples, g.at("t").size());
        EXPECT_EQ(result.events, folder_ / "out.events.csv");
        expect_samples(g, fields(folder_ / "out.csv"));
        expect_events(g.at("events"), fields(folder_ / "out.events.csv"));
    }
}

TEST_F(Replay, ColumnsAndDigits) {
    replay(options("[tissue]\n", "0,0\n0.5,0.03\n1,0.04\n"));
    const auto lines = fields(folder_ / "out.csv");
    EXPECT_EQ(lines[0], (std::vector<std::string>{"time_s", "position_needle_m", "position_tissue_m",
                                                  "velocity_tissue_m_per_s", "tissue_phase", "force_tissue_N",
                                                  "force_fixture_N", "force_total_N"}));
    ASSERT_EQ(lines.size(), 4u);
    EXPECT_EQ(lines[1][4], "free");
    // 0.06 m/s is 0.3 N on touch, above the puncture force: pierced at once.
    EXPECT_EQ(lines[2][4], "penetrated");
    EXPECT_EQ(lines[2][1], "0.029999999999999999");
}

TEST_F(Replay, EveryTransitionOfALongStepIsListed) {
    // A surface that swings against a needle held in its way: contact and release in every swing.
    ReplayOptions o = options(
        "[tissue]\nmass_kg = 1e-6\nstiffness_N_per_m = 1e6\ndamping_Ns_per_m = 0.0\ndrag_Ns_per_m = 0.0\n"
        "puncture_force_N = 1e5\nrest_position_m = 0.0\n",
        "0,-0.002\n0.001,0.001\n0.0011116,-4.4e-6\n0.0031116,-3e-6\n");
    const ReplayResult result = replay(o);
    EXPECT_GT(result.transitions, 300u);
    EXPECT_EQ(fields(result.events).size(), result.transitions + 1);
}

TEST_F(Replay, EventsOfAllElementsInTheOrderOfTime) {
    ReplayOptions o = options("[tissue]\n[fixture]\n[vessel]\n", "0,0\n2,0.15\n4,0\n6,0\n");
    o.events = folder_ / "what-happened.csv";
    const ReplayResult result = replay(o);
    EXPECT_EQ(result.events, o.events);
    double before_s = 0;
    std::vector<std::string> elements;
    const auto lines = fields(o.events);
    for (std::size_t i = 1; i < lines.size(); ++i) {
        EXPECT_GE(std::stod(lines[i][0]), before_s);
        before_s = std::stod(lines[i][0]);
        if (elements.empty() || elements.back() != lines[i][1]) elements.push_back(lines[i][1]);
    }
    const std::vector<std::string> in(elements.begin(), elements.begin() + 4);
    EXPECT_EQ(in, (std::vector<std::string>{"tissue", "vessel.near", "vessel.far", "fixture"}));
}

TEST_F(Replay, WithoutTissueThereIsNoSurface) {
    replay(options("[fixture]\n", "0,0.1\n1,0.124\n"));
    const auto lines = fields(folder_ / "out.csv");
    EXPECT_EQ(lines[2][2], "nan");
    EXPECT_EQ(lines[2][4], "none");
    EXPECT_NEAR(std::stod(lines[2][7]), -3, 1e-9);
}

TEST_F(Replay, ReplayedTwiceGivesTheSameBytes) {
    const ReplayOptions o = options("[tissue]\n[fixture]\n", "0,0\n0.7,0.15\n1.9,0.01\n");
    replay(o);
    const std::string first = read_text(o.out);
    replay(o);
    EXPECT_EQ(read_text(o.out), first);
}

TEST_F(Replay, EverySolverRunsTheSameScene) {
    std::string needle;
    for (int i = 0; i <= 3000; ++i)
        needle += fmt::format("{},{}\n", i * 1e-3, 0.05 - 0.05 * std::cos(2.0943951 * i * 1e-3));
    const ReplayOptions exact = options("[tissue]\n[fixture]\nposition_m = 0.09\n", needle);
    const ReplayResult reference = replay(exact);
    const auto expected = fields(exact.out);
    for (const char* solver : {"semi_implicit_euler", "rk4", "implicit_midpoint"}) {
        ReplayOptions o = exact;
        o.solver = solver;
        o.solver_step_s = 1e-4;
        EXPECT_EQ(replay(o).transitions, reference.transitions) << solver;
        const auto lines = fields(o.out);
        ASSERT_EQ(lines.size(), expected.size());
        for (std::size_t i = 1; i < lines.size(); ++i) {
            ASSERT_NEAR(std::stod(lines[i][2]), std::stod(expected[i][2]), 3e-5)
                << solver << " " << lines[i][0];
        }
    }
}

TEST_F(Replay, RefusesByName) {
    const std::string good = "0,0\n1,0.01\n";
    EXPECT_THAT(refused(options("[tissue]\n", "0,0.03\n1,0.04\n"), ExitCode::kData),
                AllOf(HasSubstr("needle.csv:2:"), HasSubstr("inside 'tissue'")));
    EXPECT_THAT(refused(options("[tissue]\nmass = 1\n", good), ExitCode::kUsage),
                AllOf(HasSubstr("scene.toml:2:"), HasSubstr("'tissue.mass'")));
    EXPECT_THAT(refused(options("[tissue]\n", "0,0\n1,?\n"), ExitCode::kData), HasSubstr("needle.csv:3:"));
    ReplayOptions o = options("[tissue]\n", good);
    o.solver = "euler";
    EXPECT_THAT(refused(o, ExitCode::kUsage), HasSubstr("semi_implicit_euler"));
    o = options("[tissue]\nmass_kg = 1e-12\n", good);
    o.solver = "rk4";
    EXPECT_THAT(refused(o, ExitCode::kUsage), HasSubstr("unstable"));
    o = options("[tissue]\n", good);
    o.events = o.needle;
    EXPECT_THAT(refused(o, ExitCode::kUsage), HasSubstr("named twice"));
    EXPECT_EQ(fields(o.needle).size(), 3u);  // untouched
}

TEST_F(Replay, StoppedItKeepsWhatWasDone) {
    const std::atomic<bool> stop{true};
    ReplayOptions o = options("[tissue]\n", "0,0\n1,0.01\n");
    o.stop = &stop;
    const ReplayResult result = replay(o);
    EXPECT_FALSE(result.complete);
    EXPECT_EQ(result.samples, 0u);
    EXPECT_EQ(fields(o.out).size(), 1u);  // the header
}

}  // namespace
}  // namespace thimble
