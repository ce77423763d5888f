// The reading examples of examples/analysis, by the programs they are for.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/records/trial_table.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"
#include "tests/unit/log/written_log.hpp"
#include "thimble/log/log_export.hpp"

namespace thimble {
namespace {

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
    if (!has_package("pandas")) GTEST_SKIP() << "there is no pandas (python3-pandas)";
    const Folder folder;
    write_trials(folder / "trials.csv");
    const Outcome said = run_to_end("/usr/bin/python3", {kExamples + "trials.py", (folder / "").string()});
    EXPECT_EQ(said.code, 0) << said.words;
    EXPECT_THAT(said.words, ContainsRegex("HF +0.002 +0.001 +3"));
    EXPECT_THAT(said.words, ContainsRegex("VF +0.006 +0.000 +3"));
}

TEST(ReadingExamples, RReadsTheTrials) {
    if (!std::filesystem::exists("/usr/bin/Rscript")) GTEST_SKIP() << "there is no R (r-base-core)";
    const Folder folder;
    write_trials(folder / "trials.csv");
    const Outcome said = run_to_end("/usr/bin/Rscript", {kExamples + "trials.R", (folder / "").string()});
    EXPECT_EQ(said.code, 0) << said.words;
    EXPECT_THAT(said.words, HasSubstr("Error: subject:modality"));
    EXPECT_THAT(said.words, ContainsRegex("modality +1 +2.4e-05 +2.4e-05 +48"));  // (2 / 0.5)^2 x 3
}

TEST(ReadingExamples, H5pyReadsALogWithItsUnits) {
    if (!has_package("h5py")) GTEST_SKIP() << "there is no h5py (python3-h5py)";
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

// As docs/interoperability.md has them.
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

}  // namespace
}  // namespace thimble
