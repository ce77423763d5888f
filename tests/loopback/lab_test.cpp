// `thimble run` in a laboratory of four network namespaces on one bridge (lab.sh). One of them is the network. In lock-step the run
// writes the bytes of virtual time. By the wall clock a cut wire ends a trial and not the session.
#include <filesystem>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/participant/dataset.hpp"
#include "session/participant/record_table.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kMachines =
    "[launch]\nmachine_netem = 'network'\nmachine_slave_sim = 'robot'\nmachine_cutaneous = 'display'\n"
    "machine_visual = 'display'\nlease_s = 5\n"
    "[network]\nhost_session = '10.77.0.1'\nhost_master = '10.77.0.1'\nhost_netem = '10.77.0.2'\n"
    "host_slave_sim = '10.77.0.3'\nhost_cutaneous = '10.77.0.4'\nhost_visual = '10.77.0.4'\n";
constexpr const char* kOpen = "[security]\nmode = 'none'\nallow_unprotected_network = true\n";

class Lab : public testing::Test {
  protected:
    void SetUp() override {
        const Outcome outcome = run_to_end("unshare", words({}));
        if (!fs::exists(folder_ / "built")) GTEST_SKIP() << "no network namespaces here: " << outcome.words;
    }

    // Without being root it takes a user namespace.
    std::vector<std::string> words(std::vector<std::string> command) const {
        command.insert(command.begin(), {THIMBLE_SOURCE_DIR "/tests/loopback/lab.sh", folder()});
        return words_in(std::string(geteuid() == 0 ? "" : "-Ur ") + "-nm --propagation private sh", command);
    }
    std::vector<std::string> launch(const std::string& session,
                                    const std::vector<std::string>& more = {}) const {
        std::vector<std::string> command{(built_programs() / "thimble").string(),
                                         "run",
                                         folder_.write("session.toml", session).string(),
                                         "--out",
                                         (folder_ / "out").string(),
                                         "--exec",
                                         "ip netns exec {host}",
                                         "--programs",
                                         built_programs().string(),
                                         "--base-port",
                                         std::to_string(ports_.base()),
                                         "--json"};
        command.insert(command.end(), more.begin(), more.end());
        return words(command);
    }
    std::string folder() const { return (folder_ / ".").string(); }
    std::string said() const { return read_text(folder_ / "words"); }

    Folder folder_;
    PortBlock ports_;
};

TEST_F(Lab, FourMachinesInLockStepWriteTheBytesOfOneProgram) {
    SessionFile session;
    session.modalities = R"(["CF", "VF"])";
    session.delays_s = "[0.05]";
    session.contact_hold_s = 0.3;
    session.more = kMachines + under_lab_key(folder_ / "lab.key");
    Child launcher("unshare", launch(session.text(), kLockStep), folder_ / "words");
    ASSERT_EQ(launcher.wait(3 * kPatience), 0) << said();
    const std::string trials = read_text(folder_ / "out/trials.csv");
    EXPECT_EQ(read_text(folder_ / "out/virtual.csv"), trials);
    EXPECT_THAT(trials, AllOf(HasSubstr("CF"), HasSubstr("VF")));
    EXPECT_THAT(read_text(folder_ / "out/nodes/thimble-slave-sim_50ms.json"), HasSubstr("\"robot\""));
    for (const char* log : {"thimble-slave-sim_50ms_trial01.mcap", "thimble-slave-sim_50ms_trial02.mcap",
                            "thimble-visual_50ms_trial02.mcap", "thimble-master_50ms_trial02.mcap"})
        EXPECT_TRUE(read_text(folder_ / "out/nodes" / log).ends_with("MCAP0\r\n")) << log;
    EXPECT_THAT(nodes_alive(ports_.base()), IsEmpty());
}

TEST_F(Lab, ACutWireEndsTheTrialAndNotTheSession) {
    constexpr std::uint32_t kSubject = 7;
    constexpr std::uintmax_t kInContact = 100'000;  // a second of samples: the needle presses on the fixture
    const Dataset dataset(folder_ / "out");
    Child launcher("unshare",
                   launch("[session]\nsubject = 7\nmodalities = ['CF']\nfixture_jitter_m = 0\n"
                          "[fixture]\nposition_m = 0.035\n[trial]\ncontact_hold_s = 2\npeer_wait_s = 20\n"
                          "[protocol]\nexperiments = [1]\ntrials_per_modality = 1\npractice_trials = 0\n"
                          "break_every = 0\nrepeat = 'at_once'\nrepeats_limit = 9\n" +
                          std::string(kMachines) + kOpen),
                   folder_ / "words");
    const auto recorded = [&] {
        std::error_code absent;
        for (const auto& file : fs::directory_iterator(dataset.source(kSubject) / "trajectories", absent)) {
            if (file.file_size(absent) > kInContact) return true;
        }
        return false;
    };
    ASSERT_TRUE(wait_until(recorded)) << said();
    static_cast<void>(folder_.write("cut", ""));
    ASSERT_EQ(launcher.wait(3 * kPatience), 0) << said();
    EXPECT_TRUE(fs::exists(folder_ / "mended"));
    const auto records = read_records(dataset.records(kSubject));
    // The wire is whole before the addresses on it are known again (ARP): a second trial may be lost.
    ASSERT_GE(records.size(), 2U) << said();
    for (std::size_t i = 0; i + 1 < records.size(); ++i)
        EXPECT_EQ(records[i].row.reason, EndReason::kPeerLost) << i;
    EXPECT_EQ(records.back().row.reason, EndReason::kCompleted);
    EXPECT_TRUE(records.back().row.metrics.beeped);
    EXPECT_EQ(records.back().repeat_of, records[records.size() - 2].number);
    // All nodes left the first trial alive and in order.
    for (const char* program : kNodePrograms) {
        const auto start = dataset.source(kSubject) / "nodes/start01";
        EXPECT_TRUE(fs::exists(start / (std::string(program) + "_0ms.json"))) << program;
    }
    EXPECT_THAT(nodes_alive(ports_.base()), IsEmpty());
}

}  // namespace
}  // namespace thimble
