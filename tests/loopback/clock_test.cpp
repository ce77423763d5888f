// thimble run by another clock than the wall's: the same trials, the same files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kEasy =
    "[session]\nmodalities = ['HF', 'CF']\ndelays_s = [0.0, 0.05]\n[trial]\ncontact_hold_s = 0.5\n";

class RunByClock : public testing::Test {
  protected:
    Outcome run(const std::string& text, const std::string& clock,
                const std::vector<std::string>& more = {}) {
        const std::string file = folder_.write("session.toml", text).string();
        out_ = folder_ / clock;
        return run_thimble(words_in("run " + file + " --clock " + clock + " --out " + out_.string(), more));
    }
    void expect_refused(const std::string& text, const std::string& clock, const std::string& words,
                        const std::vector<std::string>& more = {}) {
        const Outcome outcome = run(text, clock, more);
        EXPECT_EQ(outcome.code, 2) << words;
        EXPECT_THAT(outcome.words, HasSubstr(words));
        EXPECT_FALSE(fs::exists(out_));
    }

    const Folder folder_;
    fs::path out_;
};

TEST_F(RunByClock, VirtualTimeWritesTheFilesOfARun) {
    const Outcome outcome = run(kEasy, "virtual");
    ASSERT_EQ(outcome.code, 0) << outcome.words;
    for (const char* file : {"report.html", "findings.json", "trajectories/trial02_CF_50ms.csv"})
        EXPECT_TRUE(fs::exists(out_ / file)) << file;
    EXPECT_FALSE(fs::exists(out_ / "nodes"));
    const auto summary = nlohmann::json::parse(read_text(out_ / "summary.json"));
    EXPECT_EQ(summary.at("clock"), "virtual");
    EXPECT_GT(summary.at("simulated_s"), 10);
    EXPECT_GT(summary.at("wall_s"), 0);
    const std::string first = read_text(out_ / "trials.csv");
    ASSERT_EQ(run(kEasy, "virtual", {"--overwrite"}).code, 0);
    EXPECT_EQ(read_text(out_ / "trials.csv"), first);
}

TEST_F(RunByClock, RefusesWhateverLivesByTheWallClock) {
    const std::string easy = kEasy;
    expect_refused(easy, "virtual", "--attach", {"--attach"});
    expect_refused(easy, "virtual", "--strict-rt", {"--strict-rt"});
    expect_refused(easy, "virtual", "--monitor", {"--monitor"});
    expect_refused(easy + "[handle]\ndevice = 'pointer'\n", "virtual", "[handle] device");
    expect_refused(easy + "[cutaneous]\ndevice = 'board'\n", "virtual", "[cutaneous]");
    expect_refused(easy + "[launch]\nmachine_slave_sim = 'elsewhere'\n", "virtual", "[launch]");
    expect_refused(easy + "[protocol]\n", "virtual", "[protocol]");
}

}  // namespace
}  // namespace thimble
