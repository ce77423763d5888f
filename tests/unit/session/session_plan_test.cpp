// Delays, modalities and numbers of trials: the same meaning for all commands, or a refusal that names the keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/settings/protocol.hpp"
#include "session/settings/system_settings.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

SystemSettings settings_of(const std::string& text) {
    return read_system_settings(ConfigFile::parse(text, "session.toml"));
}

std::string session_refusal(const std::string& text) {
    return refusal([&text] { settings_of(text); }, ExitCode::kUsage);
}

// For a report's provenance.
TEST(AllParameters, AreTheFilesAndTheDefaultsOfTheRest) {
    const TemporaryDirectory folder;
    const auto file = folder / "all.toml";
    write_text(file, "[operator]\ncriterion_N = 3.5\n[session]\nmodalities = ['HF', 'VF']\n");
    const std::string text = "\n" + all_parameters(file);
    for (const char* line :
         {"operator.criterion_N = 3.5", "session.modalities = [ 'HF', 'VF' ]", "session.seed = 1",
          "operator.reaction_visual_s = 0.24", "netem.force.loss = 0", "visual.picture_delayed = false"}) {
        EXPECT_THAT(text, HasSubstr(std::string("\n") + line + "\n"));
    }
    EXPECT_THAT("\n" + all_parameters({}), HasSubstr("\noperator.criterion_N = 2\n"));
    EXPECT_THAT("\n" + all_parameters(file, {{"operator.criterion_N", 3.25}}),
                AllOf(HasSubstr("\noperator.criterion_N = 3.25\n"), HasSubstr("\nsession.seed = 1\n")));
}

// A real handle has an energy limit where the file has none.
TEST(SystemSettings, TheWindowOfTheGuardAloneIsForARealHandle) {
    const std::string window = "[guard]\nenergy_window_s = 2\n";
    EXPECT_EQ(settings_of(window + "[handle]\ndevice = 'falcon'").master.guard.energy_limit_J, 0.5);
    EXPECT_EQ(settings_of(window + "[handle]\ndevice = 'force-dimension'").master.guard.energy_limit_J, 0.5);
    EXPECT_THAT(session_refusal(window), HasSubstr("has an effect with energy_limit_J only"));
    // A slow master would forget these between two samples.
    EXPECT_THAT(session_refusal("[guard]\nenergy_limit_J = 0.1\nenergy_window_s = 0.0195\n[master]\n"
                                "sample_period_s = 0.01\n"),
                HasSubstr("energy_window_s"));
    for (const char* node : {"cutaneous", "visual"})
        EXPECT_THAT(session_refusal(
                        fmt::format("[master]\nsample_period_s = 0.01\n[{}]\nstale_after_s = 0.005\n", node)),
                    HasSubstr(fmt::format("'{}.stale_after_s' lets each force go stale", node)));
}

// Each trial in which a hand is pressed needs both of its fingers: drawing the needle out presses the thumb.
TEST(SystemSettings, APressedHandHasTheDrivesOfBothFingers) {
    const auto session = [](const std::string& modalities, const std::string& drives) {
        return "[session]\nmodalities = [" + modalities +
               "]\n[cutaneous]\ndevice = 'drives'\n[cutaneous.drives]\nbus = 'can0'\n" + drives;
    };
    const std::string one_hand = "other_index = []\nother_thumb = []\n";
    EXPECT_NO_THROW(settings_of(session("'CF', 'CCF'", "")));
    EXPECT_NO_THROW(settings_of(session("'HF', 'CF', 'VF'", one_hand)));
    EXPECT_THAT(session_refusal(session("'CF', 'CCF'", one_hand)),
                AllOf(HasSubstr("cutaneous.drives.other_index"), HasSubstr("CCF presses this finger")));
    EXPECT_THAT(session_refusal(session("'CF'", "acting_thumb = []\n")),
                HasSubstr("cutaneous.drives.acting_thumb"));
    EXPECT_NO_THROW(settings_of(session("'VF'", "acting_thumb = []\n")));
}

// Keys of several types, lists of tables, and every session that comes with the program.
TEST(AllParameters, AreListedOfAnyFileThatIsRead) {
    const TemporaryDirectory folder;
    const auto file = folder / "rich.toml";
    write_text(file,
               "[session]\nsubject = 3\ndelays_s = ['50ms']\n[netem.needle]\nloss = 0.01\n"
               "[[netem.needle.outage]]\nstart_s = 1\nlength_s = 0.1\n"
               "[netem.force.loss]\nmodel = 'gilbert'\ngood_to_bad = 0.1\nbad_to_good = 0.5\n"
               "[[netem.force.timeline]]\nat_s = 2\nloss = 0.1\n");
    load_system_settings(file);
    EXPECT_THAT(all_parameters(file), AllOf(HasSubstr("netem.needle.loss = 0.01\n"),
                                            HasSubstr("netem.force.loss.good_to_bad = 0.1\n"),
                                            HasSubstr("session.delays_s = [ '50ms' ]\n")));
    for (const auto& shipped : std::filesystem::directory_iterator(THIMBLE_SOURCE_DIR "/deploy/sessions"))
        EXPECT_THAT(all_parameters(shipped.path()), HasSubstr("\nsession.seed = ")) << shipped.path();
}

TEST(SessionPlan, TheNetworksDelayIsThatOfTheSession) {
    EXPECT_THAT(settings_of("[netem.force]\ndelay_s = 0.009\n").plan.delays, ElementsAre(milliseconds{9}));
    EXPECT_THAT(settings_of("[netem.force]\nprofile = 'paper50'\n").plan.delays,
                ElementsAre(milliseconds{50}));
    EXPECT_THAT(settings_of("[session]\ndelays_s = [0.02]\n[netem.force]\nprofile = 'paper50'\n").plan.delays,
                ElementsAre(milliseconds{20}));
    EXPECT_THAT(settings_of("[netem.force]\nloss = 0.1\n").plan.delays,
                ElementsAre(milliseconds{0}, milliseconds{50}));
}

// The network has to know the session's delays: jitter must fit the least of them.
TEST(SessionPlan, JitterFitsTheSessionsDelays) {
    const std::string jitter = "[netem.force]\njitter = 'uniform'\njitter_spread_s = 0.008\n";
    const SystemSettings settings = settings_of("[session]\ndelays_s = [0.05, 0.009]\n" + jitter);
    EXPECT_EQ(settings.netem.force.delay, milliseconds{9});
    EXPECT_EQ(settings.netem.needle.delay, milliseconds{0});
    EXPECT_THAT(session_refusal("[session]\ndelays_s = [0.05, 0.007]\n" + jitter),
                HasSubstr("jitter_spread_s"));
    EXPECT_EQ(
        settings_of("[session]\ndelays_s = [0.02]\n[netem.force]\nprofile = 'paper50'\n").netem.force.delay,
        milliseconds{50})
        << "a profile's jitter fits the profile's delay";
}

TEST(SessionPlan, AContradictionNamesBothKeysAndBothValues) {
    EXPECT_EQ(session_refusal("[session]\ndelays_s = [0.009]\n[netem.force]\ndelay_s = 0.009\n"),
              "nothing was refused");
    EXPECT_THAT(session_refusal("[session]\ndelays_s = [0.009, 0.03]\n[netem.force]\ndelay_s = 0.009\n"),
                AllOf(HasSubstr("session.toml:2"), HasSubstr("delays_s' is [0.009, 0.03]"),
                      HasSubstr("netem.force.delay_s is 0.009")));
    EXPECT_THAT(session_refusal("[session]\ndelays_s = [0.05]\n[protocol]\nexperiments = [1, 2]\n"),
                AllOf(HasSubstr("experiments"), HasSubstr("[0.05]"), HasSubstr("delays_s")));
    EXPECT_THAT(session_refusal("[netem.force]\ndelay_s = 0.02\n[protocol]\nexperiments = [1]\n"),
                HasSubstr("delay_s"));
    EXPECT_THAT(session_refusal("[session]\ndelays_s = [0.05, 0.05]\n"), HasSubstr("twice"));
    EXPECT_THAT(session_refusal("[session]\ndelays_s = [0.05, 0.05000001]\n"),
                HasSubstr("the same name in files, 50ms"));
    EXPECT_THAT(session_refusal("[session]\nmodalities = ['HF', 'HF']\n"), HasSubstr("twice"));
}

// The trace is beside the file, so there has to be one.
TEST(SessionPlan, ATraceOfDelaysAllowsNoOther) {
    const TemporaryDirectory folder;
    write_text(folder / "path.csv", "time_s,delay_s\n0,0.01\n5,0.02\n");
    const auto read = [&folder](const std::string& text) {
        write_text(folder / "session.toml", text);
        return load_system_settings(folder / "session.toml");
    };
    const std::string trace = "[netem.force]\ntrace = 'path.csv'\n";
    EXPECT_THAT(read(trace).plan.delays, ElementsAre(milliseconds{15})) << "the mean of its rows";
    EXPECT_THAT(read(trace + "trace_between = 'linear'\ntrace_end = 'hold'\n").plan.delays,
                ElementsAre(std::chrono::microseconds{17'500}));
    EXPECT_THAT(read(trace + "delay_s = 0.02\n").plan.delays, ElementsAre(milliseconds{20}));
    EXPECT_THROW(read(trace + "[session]\ndelays_s = [0.05]\n"), Error);
    EXPECT_EQ(with_force_delay(read(trace), milliseconds{15}).netem.force.delay, milliseconds{15});
    EXPECT_THAT(refusal([&] { with_force_delay(read(trace), milliseconds{50}); }, ExitCode::kUsage),
                AllOf(HasSubstr("a delay of 0.05 s"), HasSubstr("name 0.015 s alone")));
}

TEST(SessionPlan, AUsersTrialsAreDelaysTimesModalitiesTimesNumber) {
    const SystemSettings settings = settings_of(
        "[session]\ndelays_s = [0.009, 0.03]\nmodalities = ['HF', 'CF']\nseed = 7\n"
        "[protocol]\nsubjects = 2\ntrials_per_modality = 3\n");
    const auto trials = all_trials(session_protocols(settings));
    ASSERT_EQ(trials.size(), 2U * 2 * 2 * 3);
    for (const TrialConditions& trial : trials) {
        EXPECT_EQ(trial.experiment, 3U);
        EXPECT_EQ(trial.study_seed, 7U);
        EXPECT_TRUE(trial.modality == Modality::kHF || trial.modality == Modality::kCF);
    }
    EXPECT_EQ(trials.front().delay_s, 0.009);
    EXPECT_EQ(trials.back().delay_s, 0.03);
    // The same fixtures and orders at each delay: subjects are compared with themselves.
    EXPECT_EQ(trials.front().fixture_position_m, trials[12].fixture_position_m);
    EXPECT_EQ(trials.front().modality, trials[12].modality);
    EXPECT_EQ(all_trials(session_protocols(settings_of(""))).size(), 2U * 10 * 24);
}

TEST(SessionPlan, ThePapersSessionsAreThePapersExperiments) {
    const SystemSettings defaults = settings_of("");
    const std::vector<Protocol> papers{experiment_1(defaults, 16, 1), experiment_2(defaults, 16, 1),
                                       experiment_3(defaults, 10, 1)};
    for (std::size_t i = 0; i < papers.size(); ++i) {
        const auto file = find_session_file(std::string(kPaperSessions.at(i)));
        EXPECT_TRUE(is_paper_session(file));
        const auto protocols = session_protocols(load_system_settings(file));
        ASSERT_EQ(protocols.size(), 1U);
        EXPECT_TRUE(plans_paper_trials(protocols[0]));
        const auto paper = all_trials({papers[i]}), ours = all_trials(protocols);
        ASSERT_EQ(paper.size(), ours.size());
        for (std::size_t k = 0; k < paper.size(); ++k) {
            EXPECT_EQ(paper[k].modality, ours[k].modality);
            EXPECT_EQ(paper[k].delay_s, ours[k].delay_s);
            EXPECT_EQ(paper[k].fixture_position_m, ours[k].fixture_position_m);
            EXPECT_EQ(paper[k].removes_fixture, ours[k].removes_fixture);
        }
    }
    EXPECT_FALSE(plans_paper_trials(session_protocols(settings_of("[session]\ndelays_s = [0.009]\n"))[0]));
    EXPECT_FALSE(plans_paper_trials(
        session_protocols(settings_of("[session]\nmodalities = ['HF']\n[protocol]\n"))[0]));
}

TEST(SessionFiles, AFileComesBeforeANameAndAnUnknownNameListsThem) {
    const TemporaryDirectory folder;
    const auto copy = folder / "paper-experiment-3.toml";
    const std::string text = read_text(find_session_file("paper-experiment-3"));
    write_text(copy, text);
    EXPECT_EQ(find_session_file(copy.string()), copy);
    EXPECT_TRUE(is_paper_session(copy)) << "what it says counts, not where it lies";
    const auto with = [&](const std::string& more) {
        write_text(copy, text + more);
        return is_paper_session(copy);
    };
    EXPECT_TRUE(with("# a comment\n"));
    EXPECT_FALSE(with("[fixture]\nstiffness_N_per_m = 600\n"));
    EXPECT_FALSE(with("practice_trials = 4\n"));
    const auto changed = [&](const std::string& key, const std::string& value) {
        const auto at = text.find("\n" + key + " = ") + 1;
        write_text(copy, std::string(text).replace(at, text.find('\n', at) - at, key + " = " + value));
        return is_paper_session(copy);
    };
    EXPECT_TRUE(changed("order", "\"williams\""));
    EXPECT_FALSE(changed("delays_s", "[0.009]"));
    EXPECT_FALSE(changed("modalities", "[\"HF\", \"CF\"]"));
    EXPECT_FALSE(changed("subjects", "12"));
    EXPECT_FALSE(changed("trials_per_modality", "3"));
    EXPECT_EQ(shipped_name(find_session_file("delay50")), "delay50");
    EXPECT_FALSE(is_paper_session(find_session_file("delay50")));
    EXPECT_THAT(
        refusal([] { find_session_file("paper-experiment-4"); }, ExitCode::kUsage),
        AllOf(HasSubstr("paper-experiment-4"), HasSubstr("paper-experiment-3"), HasSubstr("delay50")));
    EXPECT_THROW(find_session_file("../sessions/delay50"), Error);
    EXPECT_THROW(find_session_file(""), Error);
}

}  // namespace
}  // namespace thimble
