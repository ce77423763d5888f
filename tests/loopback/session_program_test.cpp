// A session file means the same to every command, or the command says why not.
#include <algorithm>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/records/trial_table.hpp"
#include "session/settings/protocol.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kHome = "[session]\ndelays_s = [0.009]\nmodalities = ['HF', 'CF']\n";
constexpr const char* kSmall = "[protocol]\nsubjects = 2\ntrials_per_modality = 1\n";

class SessionOfAUser : public testing::Test {
  protected:
    // thimble COMMAND SESSION --out OUT MORE
    Outcome use(const std::string& command, const std::string& text, const std::string& out,
                const std::vector<std::string>& more = {}) const {
        const std::string file = folder_.write("session.toml", text).string();
        return run_thimble(words_in(command + " " + file + " --out " + (folder_ / out).string(), more));
    }
    std::vector<TrialRow> study(const std::string& text, const std::string& out,
                                const std::vector<std::string>& more = {}) const {
        const Outcome outcome = use("study", text, out, more);
        EXPECT_EQ(outcome.code, 0) << outcome.words;
        return read_trial_table(folder_ / out / "trials.csv");
    }
    void expect_refused(const std::string& command, const std::string& text,
                        const std::vector<std::string>& more,
                        const testing::Matcher<std::string>& words) const {
        const Outcome outcome = use(command, text, "refused", more);
        EXPECT_EQ(outcome.code, 2) << outcome.words;
        EXPECT_THAT(outcome.words, words);
        EXPECT_FALSE(fs::exists(folder_ / "refused"));
    }

    const Folder folder_;
};

std::set<double> delays_in(const std::vector<TrialRow>& rows) {
    std::set<double> delays;
    for (const TrialRow& row : rows) delays.insert(row.conditions.delay_s);
    return delays;
}

TEST_F(SessionOfAUser, AStudyHasItsDelaysAndModalitiesOnly) {
    const auto rows = study(std::string(kHome) + kSmall, "home", {"--seed", "1"});
    ASSERT_EQ(rows.size(), 2U * 2);
    EXPECT_THAT(delays_in(rows), ElementsAre(0.009));
    for (const TrialRow& row : rows) {
        EXPECT_EQ(row.conditions.experiment, 3U);
        EXPECT_TRUE(row.conditions.modality == Modality::kHF || row.conditions.modality == Modality::kCF);
    }
    EXPECT_FALSE(fs::exists(folder_ / "home" / "control.csv"));
    const std::string report = read_text(folder_ / "home" / "report.html");
    EXPECT_EQ(use("compensators", std::string(kHome) + kSmall, "home").code, 2);
    EXPECT_EQ(read_text(folder_ / "home" / "report.html"), report);
    EXPECT_EQ(study(std::string(kHome) + kSmall, "one", {"--subjects", "1"}).size(), 2U);
}

TEST_F(SessionOfAUser, TheNetworksDelayAndLossHold) {
    const std::string delay = "[session]\nmodalities = ['HF']\n[netem.force]\ndelay_s = 0.009\n";
    const auto rows = study(delay + kSmall, "plain"), lossy = study(delay + "loss = 0.3\n" + kSmall, "lossy");
    EXPECT_THAT(delays_in(rows), ElementsAre(0.009));
    ASSERT_EQ(rows.size(), lossy.size());
    EXPECT_NE(rows[0].metrics.penetration_mean_m, lossy[0].metrics.penetration_mean_m);
    const auto named =
        study("[session]\nmodalities = ['HF']\ndelays_s = [0.009]\n" + std::string(kSmall), "named");
    EXPECT_EQ(whole_text(folder_ / "plain" / "trials.csv"), read_text(folder_ / "named" / "trials.csv"));
}

TEST_F(SessionOfAUser, AStudyThatWasInterruptedGoesOn) {
    const std::string text =
        "[session]\ndelays_s = [0.009, 0.03]\nmodalities = ['CF']\n" + std::string(kSmall);
    EXPECT_EQ(study(text, "whole").size(), 2U * 2);
    const fs::path table = folder_ / "whole" / "trials.csv";
    const std::string whole = read_text(table);
    std::size_t cut = 0;
    for (int line = 0; line < 4; ++line) cut = whole.find('\n', cut) + 1;  // into the second delay
    fs::resize_file(table, cut);
    study(text, "whole", {"--resume"});
    EXPECT_EQ(read_text(table), whole);
    for (const std::string& other : {std::string(kHome) + kSmall, text + "[trial]\ncontact_hold_s = 3\n"}) {
        const Outcome refused = use("study", other, "whole", {"--resume"});
        EXPECT_EQ(refused.code, 2) << refused.words;
        EXPECT_THAT(refused.words, HasSubstr("other settings"));
    }
    EXPECT_EQ(read_text(table), whole);
}

TEST_F(SessionOfAUser, ThePapersExperimentIsASession) {
    const auto run = [this](std::vector<std::string> words, const std::string& out) {
        words.insert(words.end(), {"--subjects", "1", "--seed", "4", "--out", (folder_ / out).string()});
        const Outcome outcome = run_thimble(words);
        EXPECT_EQ(outcome.code, 0) << outcome.words;
    };
    run({"study", "--experiment", "3"}, "short");
    run({"study", "paper-experiment-3"}, "named");
    run({"study"}, "neither");
    for (const char* file : {"trials.csv", "control.csv", "subjects.csv", "claims.json", "report.html"}) {
        const std::string expected = read_text(folder_ / "short" / file);
        EXPECT_FALSE(expected.empty()) << file;
        EXPECT_EQ(read_text(folder_ / "named" / file), expected) << file;
        EXPECT_EQ(read_text(folder_ / "neither" / file), expected) << file;
    }
}

TEST_F(SessionOfAUser, WhatAStudyCannotObeyIsRefusedByName) {
    expect_refused("study", "[session]\ndelays_s = [0.009]\n[netem.force]\ndelay_s = 0.05\n", {},
                   AllOf(HasSubstr("delays_s' is [0.009]"), HasSubstr("netem.force.delay_s is 0.05")));
    expect_refused("study", "[session]\nsubject = 'human'\n[protocol]\n", {}, HasSubstr("subject"));
    expect_refused("study", "[handle]\ndevice = 'pointer'\n", {}, HasSubstr("[handle] device"));
    expect_refused("study", kHome, {"--experiment", "3"}, HasSubstr("--experiment"));
    for (const std::vector<std::string>& many : {std::vector<std::string>{"--seeds", "2"},
                                                 {"--draws", "2"},
                                                 {"--vary", "handle.friction_N=0.5:1:2"}})
        expect_refused("study", kHome, many, AllOf(HasSubstr(many[0]), HasSubstr("paper-experiment")));
    expect_refused("run", "[session]\ndelays_s = [0.0, 0.02]\n", {"--attach"},
                   AllOf(HasSubstr("delays_s"), HasSubstr("thimble-netem")));
    for (const char* person : {"--age=31", "--sex=F", "--handedness=left", "--haptic-experience=none"})
        expect_refused("run", "", {person}, HasSubstr("--haptic-experience need"));
    for (const char* person : {"--age=31", "--consent"})
        expect_refused("run", kSmall, {person}, HasSubstr("[session] subject names a virtual one"));
    expect_refused("study", std::string(kHome) + kSmall, {"--compensators", "plugin"},
                   HasSubstr("names no plug-in"));
    expect_refused("study", "[session]\nmodalities = ['CF']\n", {"--compensators", "wave"},
                   HasSubstr("has no trials with HF"));
    for (const char* command : {"compensators", "power"})
        expect_refused(command, "[netem.force]\nprofile = 'leo'\n", {"--delays-s", "0.018,0.2"},
                       AllOf(HasSubstr("a delay of 0.2 s"), HasSubstr("name 0.018 s alone")));
    expect_refused("compensators", "[protocol]\nexperiments = [1]\n", {}, HasSubstr("experiments"));
    expect_refused("sweep", "[protocol]\n", {"--operator", "virtual"}, HasSubstr("[protocol]"));
    const Outcome unknown = run_thimble({"study", "paper-experiment-4"});
    EXPECT_EQ(unknown.code, 2);
    EXPECT_THAT(unknown.words, AllOf(HasSubstr("paper-experiment-3"), HasSubstr("delay50")));
}

TEST_F(SessionOfAUser, ThePapersTrialsTakeASessionsOperator) {
    const std::vector<std::string> papers{"--experiment", "2", "--subjects", "4", "--no-control"};
    const auto rows = study("[operator]\ncriterion_N = 3\n", "other", papers);
    EXPECT_EQ(rows.size(), 4U * kRemovals);
    EXPECT_THAT(delays_in(rows), ElementsAre(0.0));
    EXPECT_TRUE(fs::exists(folder_ / "other" / "claims.json"));
    const Outcome fit =
        run_thimble({"fit", (folder_ / "other").string(), "--out", (folder_ / "fit").string()});
    EXPECT_EQ(fit.code, 2);
    EXPECT_THAT(fit.words, HasSubstr("--session")) << "its session is none of the paper's";
    study("", "usual", papers);
    EXPECT_NE(read_text(folder_ / "other" / "trials.csv"), read_text(folder_ / "usual" / "trials.csv"));
    expect_refused("study", kSmall, {"--experiment", "2"}, HasSubstr("[protocol]"));
}

// Many studies ask how the paper's claims depend on a rig: its trials, other parameters.
TEST_F(SessionOfAUser, ClaimsAreCountedForThePapersTrialsWithAnotherRig) {
    const Outcome outcome = use(
        "study", "[session]\ndelays_s = [0.0]\n[protocol]\nexperiments = [1]\n[handle]\nfriction_N = 0.3\n",
        "seeds", {"--seeds", "2", "--subjects", "1"});
    EXPECT_EQ(outcome.code, 0) << outcome.words;
    const std::string claims = read_text(folder_ / "seeds" / "claims.json");
    const Outcome study_there = use("study", kSmall, "seeds");
    EXPECT_EQ(study_there.code, 2);
    EXPECT_THAT(study_there.words, HasSubstr("report.html: exists already"));
    EXPECT_EQ(read_text(folder_ / "seeds" / "claims.json"), claims);
}

TEST_F(SessionOfAUser, CompensatorsAndMapsHaveItsDelaysToo) {
    const std::string file = folder_.write("home.toml", std::string(kHome) + kSmall).string();
    const Outcome compared = run_thimble({"compensators", file});
    EXPECT_EQ(compared.code, 0) << compared.words;
    EXPECT_THAT(compared.words,
                AllOf(testing::ContainsRegex("\nCF +9 ms +2/2"), testing::ContainsRegex("\nwave +9 ms +./2"),
                      Not(HasSubstr("50 ms")), Not(HasSubstr("\nVF"))));
    const Outcome map =
        use("sweep", kHome, "map", {"--operator", "virtual", "--contact-stiffness-N-per-m", "9000"});
    EXPECT_EQ(map.code, 0) << map.words;
    const std::string rows = read_text(folder_ / "map" / "map.csv");
    EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 1 + 2) << "HF and CF at 9 ms\n" << rows;
    EXPECT_THAT(rows, HasSubstr(",0.009,"));
    // The cells say loss 0.
    use("sweep", std::string(kHome) + "[netem.force]\nloss = 0.5\n", "lossy",
        {"--operator", "virtual", "--contact-stiffness-N-per-m", "9000"});
    EXPECT_EQ(read_text(folder_ / "lossy" / "map.csv"), rows);
}

TEST_F(SessionOfAUser, CheckSaysWhichTrialsAreMeant) {
    const auto check = [this](const std::string& text) {
        return run_thimble({"check", folder_.write("checked.toml", text).string()}).words;
    };
    EXPECT_THAT(check(std::string(kHome) + kSmall),
                AllOf(HasSubstr("9 ms; modalities HF, CF"),
                      HasSubstr("thimble run: a session of 6 trials (4 of them for practice)"),
                      HasSubstr("thimble study: 4 trials with 2 virtual subjects")));
    EXPECT_THAT(check("[session]\ndelays_s = [0.0, 0.1]\n" + std::string(kSmall)),
                HasSubstr("thimble run: does not accept this session: [session] delays_s"));
    const auto refused = [](const char* why) {
        return HasSubstr(std::string("thimble run: does not accept this session: ") + why);
    };
    EXPECT_THAT(check("[session]\nsubject = 3\n" + std::string(kSmall)), refused("participant P03"));
    EXPECT_THAT(check(std::string(kSmall) + "[handle]\ndevice = 'pointer'\n"),
                refused("a virtual subject holds only the simulated handle"));
    EXPECT_THAT(check("[launch]\nmachine_master = 'lab2'\n"), refused("[network].host_session is 127.0.0.1"));
    EXPECT_THAT(check("[handle]\ndevice = 'ros2'\n[launch]\nmachine_visual = 'lab2'\n"),
                testing::AnyOf(refused("[handle] device = \"ros2\" works on one machine only"),
                               HasSubstr("thimble-ros2-master, which is missing")));
    EXPECT_THAT(check("[handle]\ndevice = 'pointer'\n"),
                HasSubstr("thimble study: does not accept this session: [handle] device"));
    EXPECT_THAT(run_thimble({"check", "paper-experiment-1"}).words, HasSubstr("384 trials with 16"));
    const std::string falcon =
        "[handle]\ndevice = 'falcon'\n[session]\nmodalities = ['HF']\ndelays_s = [0.05]\n";
    EXPECT_THAT(check(falcon), HasSubstr("write energy_limit_J = "));
    EXPECT_THAT(check(falcon + "[guard]\nenergy_limit_J = 9\n"), Not(HasSubstr("energy_limit_J")));
}

// They may serve another session meanwhile: thimble doctor asks them.
TEST_F(SessionOfAUser, CheckAsksNoServiceOfADevice) {
    const std::string file =
        folder_
            .write("haply.toml",
                   "[session]\nsubject = 'human'\n[protocol]\n[handle]\ndevice = 'haply'\nhaply.port = 1\n"
                   "[cutaneous]\ndevice = 'touchdiver'\ntouchdiver.port = 1\n")
            .string();
    const Outcome outcome = run_thimble({"check", file});
    EXPECT_EQ(outcome.code, 0) << outcome.words;
    EXPECT_THAT(outcome.words,
                AllOf(HasSubstr("haply.toml: no errors"), Not(HasSubstr("Haply Inverse Service")),
                      Not(HasSubstr("nobody listens"))));
}

}  // namespace
}  // namespace thimble
