// The reading examples of examples/analysis, by the programs they are for.
#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "session/observe/observers.hpp"
#include "session/records/trial_table.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/real_run.hpp"
#include "tests/loopback/workbench.hpp"
#include "tests/unit/log/written_log.hpp"
#include "thimble/log/log_export.hpp"

namespace thimble {
namespace {

using testing::Contains;
using testing::ContainsRegex;
using testing::HasSubstr;

const std::string kExamples = THIMBLE_SOURCE_DIR "/examples/analysis/";

// Debian's; looking is quicker than importing.
bool has_package(const std::string& name) {
    return std::filesystem::exists("/usr/lib/python3/dist-packages/" + name);
}

// Three subjects, two modalities, two trials each.
void write_trials(const std::filesystem::path& file) {
    TrialTable table(file);
    for (const std::uint32_t subject : {1U, 2U, 3U}) {
        for (const std::uint32_t trial : {1U, 2U, 3U, 4U}) {
            TrialRow row;
            row.conditions.subject = subject;
            row.conditions.trial = trial;
            row.conditions.modality = trial % 2 == 0 ? Modality::kHF : Modality::kVF;
            row.metrics.penetration_mean_m = trial % 2 == 0 ? 0.001 * subject : 0.004 + 0.001 * trial;
            row.reason = EndReason::kCompleted;
            table.append(row);
        }
    }
}

TEST(ReadingExamples, PandasReadsTheTrials) {
    if (!has_package("pandas")) GTEST_SKIP() << "there is no pandas (package python3-pandas)";
    const Folder folder;
    write_trials(folder / "trials.csv");
    const Outcome said = run_to_end("/usr/bin/python3", {kExamples + "trials.py", (folder / "").string()});
    EXPECT_EQ(said.code, 0) << said.words;
    EXPECT_THAT(said.words, ContainsRegex("HF +0.002 +0.001 +3"));
    EXPECT_THAT(said.words, ContainsRegex("VF +0.006 +0.000 +3"));
}

TEST(ReadingExamples, RReadsTheTrials) {
    if (!std::filesystem::exists("/usr/bin/Rscript")) GTEST_SKIP() << "there is no R (package r-base-core)";
    const Folder folder;
    write_trials(folder / "trials.csv");
    const Outcome said = run_to_end("/usr/bin/Rscript", {kExamples + "trials.R", (folder / "").string()});
    EXPECT_EQ(said.code, 0) << said.words;
    EXPECT_THAT(said.words, HasSubstr("Error: subject:modality"));
    EXPECT_THAT(said.words, ContainsRegex("modality +1 +2.4e-05 +2.4e-05 +48"));  // (2 / 0.5)^2 x 3
}

TEST(ReadingExamples, H5pyReadsALogWithItsUnits) {
    if (!has_package("h5py")) GTEST_SKIP() << "there is no h5py (package python3-h5py)";
    const Folder folder;
    WrittenLog log;
    NeedleCommand command;
    command.velocity_needle_m_per_s = 0.25;
    log.bodies = {Message{{7, {}, 0, 1, Role::kMaster}, command}};
    log.messages = {{1, 10}, {2, 20}};
    log.write(folder / "master.mcap");
    std::vector<std::unique_ptr<LoggedFile>> files;
    files.push_back(std::make_unique<LoggedFile>(folder / "master.mcap"));
    export_hdf5(files, folder / "log.h5", "");
    const Outcome said =
        run_to_end("/usr/bin/python3", {kExamples + "log_hdf5.py", (folder / "log.h5").string()});
    EXPECT_EQ(said.code, 0) << said.words;
    EXPECT_THAT(said.words, HasSubstr("velocity_needle_m_per_s  m/s  2 values, 0.25 to 0.25"));
    EXPECT_THAT(said.words, HasSubstr("log_time_ns  ns  2 values, 10 to 20"));
}

TEST(Ros2Export, SaysWhatALogOfOrdersCannotGive) {
    const Folder folder;
    WrittenLog orders;
    orders.program = "session";
    orders.topic = "/session/orders/master";
    orders.bodies = {Message{{7, {}, 0, 4, Role::kSession}, SessionControl{}}};
    orders.messages = {{1, 5}};
    orders.write(folder / "session.mcap");
    const Outcome said = run_thimble(
        {"log", "export", (folder / "session.mcap").string(), "--ros2", (folder / "ros2.mcap").string()});
    EXPECT_EQ(said.code, 0) << said.words;
    EXPECT_THAT(said.words, HasSubstr("/slave_sim/servo_*"));
    EXPECT_THAT(said.words, HasSubstr("set \"all\" in the session file"));
}

// As docs/network-profiles.md uses them.
TEST(NetworkExamples, AreRead) {
    const Folder folder;
    const std::string network = THIMBLE_SOURCE_DIR "/examples/network/";
    const Outcome good = run_thimble({"check", network + "mahimahi.toml"});
    EXPECT_EQ(good.code, 0) << good.words;
    const auto netem = [](const std::vector<std::string>& words) {
        const Outcome said = run_to_end(built_programs() / "thimble-netem", words);
        EXPECT_EQ(said.code, 0) << said.words;
        return said.words;
    };
    const std::string out = (folder / "path").string();
    EXPECT_THAT(netem({"import", network + "irtt.json", "--out", out + ".csv"}),
                HasSubstr("40 packets over 0.390 s, 2 of them lost"));
    EXPECT_THAT(netem({"fit", out + ".up.csv", "--down", out + ".down.csv", "--out", out + ".toml"}),
                HasSubstr("2 of 40 packets lost"));
    EXPECT_THAT(netem({"--profile", out + ".toml", "--print-tc", "eth0"}), HasSubstr("loss random 5%"));
    EXPECT_THAT(netem({"--profile", "delay 50ms 5ms distribution normal loss 1%", "--print-tc", "eth0"}),
                HasSubstr("delay 50ms 5ms distribution normal loss random 1%"));
}

// `thimble run --plotjuggler`: heard by Python, which is not Thimble's.
bool has_python() { return std::system("python3 -c 'import json, socket' > /dev/null 2>&1") == 0; }

// The output of hear_plotjuggler.py for a run with such a session.
nlohmann::json heard_of(SessionFile session) {
    const Folder folder;
    Child listener(
        "/bin/sh",
        {"-c", "exec python3 '" THIMBLE_SOURCE_DIR "/tests/loopback/observe/hear_plotjuggler.py' '" +
                   (folder / "port").string() + "' 50 " + std::to_string(session.parallel_conditions)},
        folder / "heard");
    if (!wait_until([&] { return std::filesystem::exists(folder / "port"); }))
        throw std::runtime_error(read_text(folder / "heard"));
    session.contact_hold_s = kEndlessHold_s;
    RealRun run(session, {"--plotjuggler", read_text(folder / "port")});
    EXPECT_EQ(listener.wait(kPatience), 0) << read_text(folder / "heard") << run.words();
    run.launcher().signal(SIGTERM);
    run.end();
    return nlohmann::json::parse(read_text(folder / "heard"));
}

TEST(PlotJuggler, APythonProgramHearsTheSession) {
    if (!has_python()) GTEST_SKIP() << "there is no python3 with its standard library (package python3)";
    const auto conditions = heard_of({});
    ASSERT_EQ(conditions.size(), 1U) << conditions;
    const auto heard = conditions.at("");  // alone it has no name
    for (const char* key :
         {"force_total_N", "position_surface_m", "network_delay_s", "tissue_phase", "trial"})
        EXPECT_THAT(heard["keys"], Contains(key));
    EXPECT_GT(heard["moved_m"], 0.01);
    EXPECT_LT(heard["per_second"], 250);  // twice the 100 Hz, for a loop that was late
    EXPECT_EQ(heard["times_go_up"], true);
    EXPECT_LT(heard["behind_s"], 60);  // a date, not a machine's own time
    EXPECT_GT(heard["behind_s"], -60);
    EXPECT_EQ(heard["last"]["modality"], "HF");
}

// Else both delays were drawn as one curve that jumps to and fro.
TEST(PlotJuggler, LanesSideBySideHaveNames) {
    if (!has_python()) GTEST_SKIP() << "there is no python3 with its standard library (package python3)";
    SessionFile session;
    session.delays_s = "[0.0, 0.0025]";
    session.parallel_conditions = 2;
    const auto conditions = heard_of(session);
    ASSERT_EQ(conditions.size(), 2U) << conditions;
    for (const char* condition : {"0ms", "2.5ms"}) {
        EXPECT_EQ(conditions.at(condition).at("times_go_up"), true) << condition;
    }
    EXPECT_LT(conditions["0ms"]["last"]["network_delay_s"], conditions["2.5ms"]["last"]["network_delay_s"]);
}

// examples/lsl/lsl.py with a pylsl that prints its arguments.
TEST(LabStreamingLayer, TheExampleMakesStreamsOfTheSameDatagrams) {
    if (!has_python()) GTEST_SKIP() << "there is no python3 with its standard library (package python3)";
    const Folder folder;
    const PortBlock ports;
    Child script("/bin/sh",
                 {"-c", "PYTHONPATH='" THIMBLE_SOURCE_DIR
                        "/tests/loopback/observe/fake_pylsl' exec python3 -B '" THIMBLE_SOURCE_DIR
                        "/examples/lsl/lsl.py' " +
                            std::to_string(ports.base())},
                 folder / "words");
    UdpChannel channel(std::nullopt, Endpoint{"127.0.0.1", ports.base()});
    const auto says = [&](const std::string& values, const std::string& expected) {
        const std::string one = fmt::format(R"({{"timestamp":1000.0,"thimble":{{{}}}}})", values);
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(one.data());
        return wait_until([&] {
            channel.send({bytes, one.size()});
            return read_text(folder / "words").find(expected) != std::string::npos;
        });
    };
    EXPECT_TRUE(says(R"("trial":1,"running":true,"force_total_N":-0.5,"position_needle_m":0.01)",
                     R"x(["sample", "Thimble Force", [-0.5, NaN, NaN, NaN], 1000])x"));
    EXPECT_TRUE(
        says(R"("50ms":{"trial":2,"force_total_N":-0.25})", R"x("Thimble 50ms Force", [-0.25, NaN)x"));
    const std::string words = read_text(folder / "words");
    EXPECT_THAT(words, HasSubstr(R"x(["stream", "Thimble Position", "Position", 3, 0.0, "double64")x"));
    const std::string event = R"x("Thimble Markers", ["{\"trial\": 1, \"running\": true}"], 1000])x";
    EXPECT_THAT(words, HasSubstr(event));
    EXPECT_EQ(words.find(event), words.rfind(event)) << "once, until something changes";
}

TEST(PlotJuggler, AnotherMachineIsRefusedByName) {
    const Folder folder;
    const auto session = folder.write("session.toml", SessionFile{}.text()).string();
    const Outcome refused =
        run_thimble({"run", session, "--out", (folder / "out").string(), "--plotjuggler", "192.0.2.1:9870"});
    EXPECT_EQ(refused.code, 2);
    EXPECT_THAT(refused.words, HasSubstr("--plotjuggler: '192.0.2.1' is not this machine alone"));
}

}  // namespace
}  // namespace thimble
