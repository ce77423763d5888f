// A program of the user in the place of a node: examples/lock_step/slave.py, as it is and with faults.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/records/trial_table.hpp"
#include "tests/loopback/programs.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* kOwnSession =
    "[session]\nmodalities = ['CF']\ndelays_s = [0.05]\n[trial]\ncontact_hold_s = 0.3\n"
    "[launch]\nprogram_slave_sim = 'slave.py'\n";

class OwnProgram : public testing::Test {
  protected:
    OwnProgram() {
        folder_.write("session.toml", kOwnSession);
        write("lock_step.py", read_text(kExample / "lock_step.py"));
        write("slave.py", read_text(kExample / "slave.py"));
    }
    void write(const char* name, const std::string& text) const {
        fs::permissions(folder_.write(name, text), fs::perms::owner_all);
    }
    // The slave, or the file that it imports, does something else at this place.
    void change(const std::string& old, const std::string& changed) const {
        const bool own = read_text(folder_ / "slave.py").find(old) != std::string::npos;
        const char* const name = own ? "slave.py" : "lock_step.py";
        std::string text = read_text(folder_ / name);
        const std::size_t at = text.find(old);
        ASSERT_NE(at, std::string::npos) << old;
        write(name, text.replace(at, old.size(), changed));
    }
    // The slave does this first with its 200th command.
    void change_within_trial(const std::string& statement) const {
        change("        depth_m, beyond_m",
               fmt::format("        number == 200 and {}\n        depth_m, beyond_m", statement));
    }
    Outcome run(const std::string& more) const {
        return run_thimble(words_in(fmt::format("run {} --base-port {} {}",
                                                (folder_ / "session.toml").string(), ports_.base(), more)));
    }
    std::string lock_step(const std::string& out) const {
        return fmt::format("--clock lock-step --out {}", (folder_ / out).string());
    }
    void expect_end(int code, const std::string& words) const {
        const Outcome outcome = run(lock_step("out"));
        EXPECT_EQ(outcome.code, code);
        EXPECT_THAT(outcome.words, HasSubstr(words));
        EXPECT_THAT(nodes_alive(ports_.base()), testing::IsEmpty());
    }
    // It waits for as long as a machine that stands still for a moment needs.
    void expect_lost(Role lost, const std::string& words) const {
        const Outcome outcome = run(lock_step("out") + " --answer-limit-s 5");
        EXPECT_EQ(outcome.code, 3);
        EXPECT_THAT(outcome.words, HasSubstr(words));
        const auto rows = read_trial_table(folder_ / "out" / "trials.csv");
        ASSERT_EQ(rows.size(), 1U);
        EXPECT_EQ(rows[0].reason, EndReason::kPeerLost);
        EXPECT_EQ(rows[0].lost_peer, lost);
        EXPECT_THAT(nodes_alive(ports_.base()), testing::IsEmpty());
        EXPECT_THAT(node_pids(ports_.base(), "slave.py"), testing::IsEmpty());
    }
    void expect_refused(const std::string& more, const std::string& words) const {
        const Outcome outcome = run(more);
        EXPECT_EQ(outcome.code, 2) << more;
        EXPECT_THAT(outcome.words, HasSubstr(words));
    }

    const fs::path kExample = THIMBLE_SOURCE_DIR "/examples/lock_step";
    const Folder folder_;
    const PortBlock ports_;
};

TEST_F(OwnProgram, ASlaveInPythonGivesTheSameBytesEachTime) {
    for (const char* out : {"one", "other"}) {
        const Outcome outcome = run(lock_step(out));
        ASSERT_EQ(outcome.code, 0) << outcome.words;
    }
    const std::string trajectory = "trajectories/trial01_CF_50ms.csv";
    EXPECT_EQ(whole_text(folder_ / "one" / trajectory), read_text(folder_ / "other" / trajectory));
    EXPECT_EQ(whole_text(folder_ / "one/trials.csv"), read_text(folder_ / "other/trials.csv"));
    const auto rows = read_trial_table(folder_ / "one/trials.csv");
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].reason, EndReason::kCompleted);
    EXPECT_GT(rows[0].metrics.penetration_max_m, 0.0005);
    EXPECT_FALSE(fs::exists(folder_ / "one/virtual.csv")) << "virtual time has no such slave";
    EXPECT_THAT(read_text(folder_ / "one/summary.json"), HasSubstr("slave.py"));
}

TEST_F(OwnProgram, ThatSpeaksAnotherVersionIsNamed) {
    change("LOCK_STEP.pack(VERSION", "LOCK_STEP.pack(7");
    expect_end(3,
               "slave_sim sends a lock-step message of 96 bytes and version 7, but this program uses "
               "version 2");
}

// By netem, and by the session, which is in the conductor itself.
TEST_F(OwnProgram, WhoseDatagramIsLostEndsTheRunWithTheFlowsName) {
    const std::string counted = "self.sent[place] += 1", missing = " announced datagram did not come";
    const auto lose_at = [](int place) {
        return fmt::format("self.sent[place] += 1 + (place == {} and self.numbers[place] == 200)", place);
    };
    change(counted, lose_at(19));
    expect_lost(Role::kNetem, "of 'force for master' from slave_sim to netem: 1" + missing);
    fs::remove_all(folder_ / "out");
    change(lose_at(19), lose_at(5));
    expect_lost(Role::kSlaveSim, "of 'record' from slave_sim to session: 1" + missing);
}

TEST_F(OwnProgram, ThatEndsIsShownWithItsLastWords) {
    change_within_trial("sys.exit('the needle is bent')");
    expect_lost(Role::kSlaveSim, "slave.py ended with code 1: the needle is bent");
}

TEST_F(OwnProgram, WithoutAnEndForWavesSaysSo) {
    std::string session = std::string(kOwnSession) + "[control]\ncompensator = 'wave'\n";
    folder_.write("session.toml", session.replace(session.find("CF"), 2, "HF"));
    expect_lost(Role::kSlaveSim, "slave.py ended with code 1: lock_step.py reads no waves");
}

// It would hold the session's clock for ever.
TEST_F(OwnProgram, ThatIsAlwaysDueIsNamed) {
    change("else node.tick(time_ns, counts)", "else node.tick(time_ns, counts) * 0");
    expect_end(3, "lock-step: slave_sim has asked 1001 times in a row for its next event");
}

TEST_F(OwnProgram, ThatCannotBeStartedIsNamed) {
    change("#!/usr/bin/env python3", "#!/no/such/interpreter");
    expect_end(1, "slave.py: No such file or directory; does its first line name a program that runs it");
}

TEST_F(OwnProgram, IsRefusedWhereThimbleHasItsOwnAlone) {
    expect_refused("--clock virtual", "[launch] program_slave_sim");
    expect_refused("--print systemd", "[launch] program_slave_sim");
    expect_refused("--attach", "[launch] program_slave_sim names a program of yours, and --attach does not");
}

TEST_F(OwnProgram, IsAmongTheProgramsThatAreChecked) {
    const Outcome outcome = run("--check --out " + (folder_ / "out").string());
    EXPECT_EQ(outcome.code, 0) << outcome.words;
    EXPECT_THAT(outcome.words, HasSubstr("slave.py on this machine: good"));
}

}  // namespace
}  // namespace thimble
