// `thimble doctor` as users start it. Its findings depend on the machine. The test checks their form, and the facts that it has arranged.
#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"
#include "tests/unit/log/written_log.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// Without real-time scheduling, so that a test on a busy machine disturbs no other.
constexpr const char* kModest = "[runtime]\nrealtime_scheduling = false\n";

Outcome run_doctor(const std::filesystem::path& session, std::uint16_t base_port) {
    return run_thimble({"doctor", session.string(), "--json", "--seconds", "0.05", "--base-port",
                        std::to_string(base_port)});
}

nlohmann::json finding_of(const nlohmann::json& json, const std::string& name) {
    for (const auto& finding : json["findings"])
        if (finding["name"] == name) return finding;
    return {};
}

TEST(DoctorProgram, SaysInJsonWhetherASessionCanRun) {
    const Folder folder;
    const PortBlock ports;
    const Outcome outcome = run_doctor(folder.write("good.toml", kModest), ports.base());
    const auto json = nlohmann::json::parse(outcome.words, nullptr, false);
    ASSERT_TRUE(json.is_object()) << outcome.words;
    EXPECT_GE(json["findings"].size(), 10U);
    for (const char* name : {"session", "programs", "ports", "real time", "software"})
        EXPECT_NE(finding_of(json, name)["severity"], "fault") << outcome.words;
    EXPECT_GT(finding_of(json, "timer")["wake_ups"], 0) << outcome.words;
    // A machine under the load of other tests may be too late for any session.
    const bool late = finding_of(json, "timer")["severity"] == "fault";
    EXPECT_EQ(json["can_run"], !late) << outcome.words;
    EXPECT_EQ(outcome.code, late ? 4 : 0) << outcome.words;
}

TEST(DoctorProgram, ATakenPortIsNamedWithWhoHoldsIt) {
    const Folder folder;
    const PortBlock ports;
    const UdpChannel taken(Endpoint{"127.0.0.1", static_cast<std::uint16_t>(ports.base() + 3)},
                           {"127.0.0.1", 0});
    const Outcome outcome = run_doctor(folder.write("good.toml", kModest), ports.base());
    EXPECT_EQ(outcome.code, 3) << outcome.words;
    const auto json = nlohmann::json::parse(outcome.words, nullptr, false);
    ASSERT_TRUE(json.is_object()) << outcome.words;
    EXPECT_EQ(json["can_run"], false);
    EXPECT_THAT(finding_of(json, "ports")["says"].get<std::string>(), HasSubstr(std::to_string(getpid())));
    EXPECT_THAT(finding_of(json, "ports")["remedy"].get<std::string>(), HasSubstr("--base-port"));
}

TEST(DoctorProgram, AsksForThePortsOfTheConditionsThatRunTogether) {
    const Folder folder;
    const PortBlock ports;
    const std::string two =
        std::string(kModest) + "[session]\ndelays_s = [0.0, 0.05]\nparallel_conditions = 2\n";
    const auto expect_blocks = [&](int blocks, const std::string& table) {
        const Outcome outcome = run_doctor(folder.write("two.toml", two + table), ports.base());
        const int last = ports.base() + blocks * static_cast<int>(Port::kCount) - 1;
        EXPECT_THAT(outcome.words, HasSubstr(fmt::format("UDP ports {} to {} ", ports.base(), last)));
    };
    expect_blocks(2, "");
    expect_blocks(1, "[protocol]\n");
    expect_blocks(1, "[handle]\ndevice = 'pointer'\n");
}

// Where thimble run would refuse them: keys and protection.
TEST(DoctorProgram, AKeyThatIsNotThereAndAnUnprotectedNetworkAreFaults) {
    const Folder folder;
    const PortBlock ports;
    const auto expect_fault = [&](int code, const std::string& session, const std::string& says,
                                  const std::string& remedy) {
        const Outcome outcome = run_doctor(folder.write("s.toml", kModest + session), ports.base());
        EXPECT_EQ(outcome.code, code) << outcome.words;
        const auto json = nlohmann::json::parse(outcome.words, nullptr, false);
        ASSERT_TRUE(json.is_object()) << outcome.words;
        EXPECT_EQ(finding_of(json, "protection")["severity"], "fault");
        EXPECT_THAT(finding_of(json, "protection")["says"].get<std::string>(), HasSubstr(says));
        EXPECT_THAT(finding_of(json, "protection")["remedy"].get<std::string>(), HasSubstr(remedy));
    };
    const auto with_key = [](const std::filesystem::path& file) {
        return fmt::format("[security]\nmode = 'lab-key'\nkey_file = '{}'\n", file.string());
    };
    const auto key = folder / "lab.key";
    expect_fault(2, with_key(key), "cannot read the lab key",
                 fmt::format("thimble keygen '{}'", key.string()));
    EXPECT_FALSE(std::filesystem::exists(key));
    folder.write("lab.key", "no key\n");
    std::filesystem::permissions(key, std::filesystem::perms::owner_read);
    expect_fault(5, with_key(key), "holds no lab key", "ls -l '");
    expect_fault(2, "[network]\nhost_slave_sim = '192.0.2.1'\n", "192.0.2.1", "thimble keygen");
}

TEST(DoctorProgram, OfAFileThatCannotBeReadTheRestIsOfTheDefaultSession) {
    const Folder folder;
    const PortBlock ports;
    const Outcome outcome = run_doctor(folder.write("bad.toml", "[session]\nbogus = 1\n"), ports.base());
    EXPECT_EQ(outcome.code, 2) << outcome.words;
    const auto json = nlohmann::json::parse(outcome.words, nullptr, false);
    ASSERT_TRUE(json.is_object()) << outcome.words;
    EXPECT_THAT(finding_of(json, "session")["says"].get<std::string>(), HasSubstr("session.bogus"));
    EXPECT_THAT(finding_of(json, "session")["says"].get<std::string>(),
                HasSubstr("the lines below are of the default session"));
}

// As of thimble check: the plug-in fails, not the file.
TEST(DoctorProgram, APlugInThatFailsIsNoUsageError) {
    const Folder folder;
    const PortBlock ports;
    const Outcome outcome =
        run_doctor(folder.write("s.toml", fmt::format("{}[session]\nmodalities = ['HF']\n[handle]\ndevice = "
                                                      "'force-dimension'\n[control]\nplugin = '{}/bad.so'\n"
                                                      "[control.plugin_settings]\nfault_number = 1\n",
                                                      kModest, THIMBLE_PLUGINS)),
                   ports.base());
    EXPECT_EQ(outcome.code, 1) << outcome.words;
    EXPECT_THAT(outcome.words, HasSubstr("bad.so: crashed in sample()"));
}

TEST(SwarmProgram, DrawnSessionsKeepTheSafetyRules) {
    const Folder folder;
    const Outcome swarm =
        run_thimble(words_in("swarm --seed 1 --cases 2 --out " + (folder / "swarm").string()));
    EXPECT_EQ(swarm.code, 0) << swarm.words;
    EXPECT_THAT(swarm.words, HasSubstr("2 cases from seed 1 on"));
}

// `thimble replay` as users start it: files in, files out, exit codes.
Outcome replay(const std::vector<std::string>& arguments) {
    return run_thimble(words_in("replay", arguments));
}

TEST(ReplayProgram, ANeedleThroughTheDefaultScene) {
    const Folder folder;
    const auto needle = folder.write("needle.csv", "time_s,position_needle_m\n0,0\n1,0.05\n3,0.13\n4,0\n");
    const Outcome outcome = replay({"--needle", needle.string(), "--out", (folder / "forces.csv").string()});
    EXPECT_EQ(outcome.code, 0) << outcome.words;
    EXPECT_THAT(outcome.words, HasSubstr("4 samples over 4 s"));
    EXPECT_THAT(read_text(folder / "forces.csv"), StartsWith("time_s,position_needle_m,position_tissue_m,"));
    const std::string events = read_text(folder / "forces.events.csv");
    EXPECT_THAT(events, StartsWith("time_s,element,phase\n"));
    EXPECT_THAT(events, HasSubstr(",tissue,penetrated\n"));
    EXPECT_THAT(events, HasSubstr(",fixture,touched\n"));
}

TEST(ReplayProgram, MistakesHaveTheirExitCodes) {
    const Folder folder;
    const auto good = folder.write("good.csv", "time_s,position_needle_m\n0,0\n1,0.01\n");
    const auto bad = folder.write("bad.csv", "time_s,position_needle_m\n0,0\n0,0.01\n");
    const auto scene = folder.write("scene.toml", "[tissue]\nmas_kg = 1\n");
    const std::string out = (folder / "out.csv").string();
    const Outcome data = replay({"--needle", bad.string(), "--out", out});
    EXPECT_EQ(data.code, 5);
    EXPECT_THAT(data.words, HasSubstr("bad.csv:3:"));
    const Outcome usage = replay({"--scene", scene.string(), "--needle", good.string(), "--out", out});
    EXPECT_EQ(usage.code, 2);
    EXPECT_THAT(usage.words, HasSubstr("scene.toml:2:"));
    EXPECT_EQ(replay({"--needle", good.string(), "--out", out, "--solver", "euler"}).code, 2);
    EXPECT_EQ(replay({"--out", out}).code, 2);
    EXPECT_EQ(replay({"--needle", good.string(), "--out", (good / "out.csv").string()}).code,
              2);  // no folder
    EXPECT_FALSE(std::filesystem::exists(out));
}

// `thimble stability` and `thimble sweep` as users start them.
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
    EXPECT_EQ(theory_at({"--press-N=-5"}).code, 2);
    EXPECT_EQ(of_hand("stability", {"--contact-stiffness-N-per-m", "0"}).code, 2);
    EXPECT_EQ(of_hand("stability", {}).code, 2);
}

TEST(CompensatorsProgram, GoesOnWithResumeAndTakesListsWithCommas) {
    const Folder folder;
    const auto compare = [&](const char* out, const std::vector<std::string>& more) {
        std::vector<std::string> words{"compensators", "--subjects", "1",
                                       "--only",       "CF,VF",      "--delays-s",
                                       "0,0.01",       "--out",      (folder / out).string()};
        words.insert(words.end(), more.begin(), more.end());
        return run_thimble(words);
    };
    ASSERT_EQ(compare("whole", {}).code, 0);
    const std::string table = read_text(folder / "whole/compensator_trials.csv");
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 1 + 2 * 2);
    // No network of these delays has jitter.
    EXPECT_FALSE(
        nlohmann::json::parse(read_text(folder / "whole/summary.json"))["provenance"].contains("jitter"));
    std::filesystem::create_directory(folder / "half");
    std::filesystem::copy(folder / "whole/compensators.txt", folder / "half/compensators.txt");
    folder.write("half/compensator_trials.csv", table.substr(0, table.size() * 2 / 3));
    EXPECT_EQ(compare("half", {}).code, 2);
    EXPECT_EQ(compare("half", {"--resume", "--overwrite"}).code, 2);
    const Outcome other = compare("half", {"--resume", "--seed", "7"});
    EXPECT_EQ(other.code, 2);
    EXPECT_THAT(other.words, HasSubstr("holds a comparison with other settings"));
    EXPECT_EQ(compare("half", {"--resume"}).code, 0);
    EXPECT_EQ(read_text(folder / "half/compensator_trials.csv"), table);
}

TEST(CompensatorsProgram, InterruptedItKeepsItsTrialsAndNoPageOfAnEarlierComparison) {
    const Folder folder;
    std::filesystem::create_directory(folder / "out");
    for (const char* file : {"report.html", "summary.json", "compensators.csv", "own.csv"})
        folder.write(fmt::format("out/{}", file), "of an earlier one\n");
    folder.write("out/compensator_trials.csv", "");
    Child child(built_programs() / "thimble",
                words_in("compensators --subjects 1000 --overwrite --out " + (folder / "out").string()),
                folder / "words");
    const auto table = folder / "out/compensator_trials.csv";
    const auto lines = [&] {
        const std::string text = read_text(table);
        return std::count(text.begin(), text.end(), '\n');
    };
    EXPECT_TRUE(wait_until([&] { return lines() > 1; }));
    child.signal(SIGINT);
    EXPECT_EQ(child.wait(kPatience), 1);
    EXPECT_THAT(read_text(folder / "words"),
                HasSubstr(fmt::format("{} trials are done and saved; continue with --resume", lines() - 1)));
    for (const char* page : {"report.html", "summary.json", "compensators.csv"})
        EXPECT_FALSE(std::filesystem::exists(folder / "out" / page)) << page;
    EXPECT_TRUE(std::filesystem::exists(folder / "out/own.csv"));
}

// Of a receiver that was killed, as of one that began late.
TEST(LogCheck, SaysWhatCameWithoutTheReceiversLog) {
    const Folder folder;
    const std::string sent = (folder / "sent.mcap").string(), received = (folder / "received.mcap").string();
    WrittenLog{.messages = {{1, 10}, {2, 20}, {3, 30}}}.write(sent);
    WrittenLog{.program = "thimble-slave-sim", .direction = "received", .messages = {{1, 11}}}.write(
        received);
    EXPECT_THAT(run_thimble({"log", "check", sent, received}).words,
                HasSubstr("3 sent = 1 received + 0 lost + 2 before or after the receiver's log;"));
}

// Their trials would be run, and shown, twice.
TEST(Lists, HoldEachValueOnce) {
    const Folder folder;
    for (const char* typed : {"compensators --delays-s 0.05,50ms", "power --delays-s 0,0.05,0.05",
                              "sweep --delay-s 0,0.1,0", "sweep --gain 0.1,1,0.1", "sweep --jitter-s 0,0",
                              "sweep --loss 0,0", "sweep --hand A,D,A", "sweep --compensators none,none"}) {
        const Outcome outcome = run_thimble(words_in(typed, {"--out", (folder / "out").string()}));
        EXPECT_EQ(outcome.code, 2) << typed << outcome.words;
        EXPECT_THAT(outcome.words, HasSubstr("is given twice: leave one out")) << typed;
        EXPECT_FALSE(std::filesystem::exists(folder / "out")) << typed;
    }
}

// Each way to mistake one for the other, at each kind of reader and writer.
TEST(FilesAndFolders, AreToldApart) {
    const Folder folder;
    const std::string file = folder.write("file", "hi\n").string(), dir = (folder / "folder").string();
    std::filesystem::create_directory(dir);
    const auto expect_a_folder = [&](const std::vector<std::string>& words) {
        const Outcome outcome = run_thimble(words);
        EXPECT_EQ(outcome.code, 2) << outcome.words;
        EXPECT_THAT(outcome.words, HasSubstr(file + ": is a file; name a folder")) << words[0];
    };
    for (const char* command : {"study -n 1", "study -n 1 --seeds 2", "study -n 1 --overwrite",
                                "study -n 1 --resume", "compensators --subjects 1 --only CF --delays-s 0",
                                "sweep --hand B --delay-s 0:0.1:2 --gain 0.1:1:2", "run delay50"}) {
        for (const char* in_it : {"", "/x"}) expect_a_folder(words_in(command, {"--out", file + in_it}));
    }
    expect_a_folder({"keygen", file + "/lab.key"});
    for (const std::vector<std::string>& words : {std::vector<std::string>{"study", dir},
                                                  {"run", dir},
                                                  {"check", dir},
                                                  {"compensators", dir},
                                                  {"sweep", dir, "--operator", "virtual"},
                                                  {"keygen", dir}}) {
        const Outcome outcome = run_thimble(words);
        EXPECT_EQ(outcome.code, 2) << outcome.words;
        EXPECT_THAT(outcome.words, HasSubstr(dir + ": is a folder; name a file")) << words[0];
    }
    EXPECT_EQ(read_text(file), "hi\n");
}

TEST(StabilityProgram, AnInterruptedMapGoesOnToTheSameBytes) {
    const Folder folder;
    const auto sweep = [&](const std::string& out, const std::string& delays, const std::string& jobs,
                           const std::vector<std::string>& how = {}) {
        std::vector<std::string> words{"--delay-s",   delays,  "--contact-stiffness-N-per-m",
                                       "100:20000:4", "--out", (folder / out).string(),
                                       "--jobs",      jobs};
        words.insert(words.end(), how.begin(), how.end());
        return of_hand("sweep", words);
    };
    const Outcome whole = sweep("whole", "0:0.1:3", "1");
    ASSERT_EQ(whole.code, 0) << whole.words;
    const std::string table = read_text(folder / "whole/map.csv");
    EXPECT_THAT(table, StartsWith("hand,operator,remedy,"));
    std::filesystem::create_directory(folder / "half");
    std::filesystem::copy(folder / "whole/map.txt", folder / "half/map.txt");
    folder.write("half/map.csv", table.substr(0, table.size() * 2 / 3));
    const Outcome refused = sweep("half", "0:0.1:3", "2");
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.words, HasSubstr("--resume"));
    EXPECT_EQ(sweep("half", "0:0.1:3", "2", {"--resume"}).code, 0);
    EXPECT_EQ(read_text(folder / "half/map.csv"), table);
    const Outcome other = sweep("half", "0:0.2:3", "2", {"--resume"});
    EXPECT_EQ(other.code, 2);
    EXPECT_THAT(other.words, HasSubstr("holds a map with other settings"));
    EXPECT_EQ(sweep("bad", "0.1:0:3", "1").code, 2);
    EXPECT_EQ(sweep("bad", "0,0.1,", "1").code, 2);
    EXPECT_EQ(sweep("bad", "-1", "1").code, 2);
}

}  // namespace
}  // namespace thimble
