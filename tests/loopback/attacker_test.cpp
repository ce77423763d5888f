// Sessions under a lab key run. A program without the key, or with another one, moves nothing and is counted by name.
#include "tests/loopback/attacker.hpp"

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/network_settings.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/security/handshake.hpp"
#include "common/security/lab_key_file.hpp"
#include "tests/loopback/hostile_peer.hpp"
#include "tests/loopback/played_view.hpp"
#include "tests/loopback/real_run.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

// Until the run is over, with a pause in between, so that the trial is disturbed and not drowned.
void disturb_until_the_end(RealRun& run, const std::function<void(HostilePeer&)>& speak) {
    HostilePeer peer(run.base_port());
    const SessionTime end = wall_now() + 3 * kPatience;
    while (!run.launcher().poll() && wall_now() < end) {
        speak(peer);
        std::this_thread::sleep_for(std::chrono::milliseconds{5});
    }
}

class LabKeyTest : public testing::Test {
  protected:
    LabKeyTest() { create_lab_key(key_, system_random_bytes()); }

    Folder folder_;
    std::filesystem::path key_ = folder_ / "lab.key";
};

// For the table of docs/security.md: how many datagrams came, and what refused them.
void say_flood(const std::string& where, double seconds_s, const nlohmann::json& counters) {
    std::string text;
    for (const char* name : {"no_key", "forged", "replayed", "wrong_role", "handshake_refused", "unsealed"})
        if (counters.at(name) > 0)
            text += fmt::format(" {} {}", name, counters.at(name).get<std::uint64_t>());
    fmt::print("flood: {}, {:.1f} s: refused{}\n", where, seconds_s, text);
}

// A lone node in a running trial, commanded and overheard: slave_sim, whose needle moves, master and cutaneous, which press.
class Attack : public LabKeyTest, public testing::WithParamInterface<AttackTarget> {
  protected:
    void SetUp() override {
        ASSERT_TRUE(node_.ready()) << node_.words();
        ASSERT_TRUE(session_.start()) << node_.words();
        ASSERT_TRUE(session_.command([this] { return session_.answers() >= 50; }));
    }
    void expect_unmoved() {
        EXPECT_TRUE(session_.still_answers());
        EXPECT_EQ(session_.foreign(), 0U);
        EXPECT_EQ(session_.state(), NodeState::kRunning);
    }
    nlohmann::json security_at_the_end() {
        EXPECT_EQ(node_.terminate(), 0);
        return node_.report().at("security");
    }

    const AttackTarget target_ = GetParam();
    LoneNode node_{target_.program, under_lab_key(key_) + target_.config};
    OverheardSession session_{node_, target_, key_};
    Attacker attacker_{node_, target_};
};

// Replayed, changed, turned back to their sender, and under another role, to either port.
TEST_P(Attack, WhatWasOverheardIsOfNoUseInThisSession) {
    int rounds = 0;
    EXPECT_TRUE(session_.command([&] {
        attacker_.replay(session_.said());
        attacker_.replay_changed(session_.said());
        attacker_.replay(session_.heard());
        return ++rounds == 5;
    }));
    expect_unmoved();
    const auto counters = security_at_the_end();
    for (const char* name : {"forged", "replayed", "wrong_role", "no_key", "unsealed", "handshake_refused"})
        EXPECT_GT(counters.at(name), 0) << name;
    EXPECT_GE(counters.at("handshakes"), 1);
}

// A node that was started anew, before, while and after it has a session of its own.
TEST_P(Attack, WhatWasOverheardIsOfNoUseAfterARestart) {
    const Overheard said = session_.said();
    LoneNode restarted(target_.program, under_lab_key(key_) + target_.config);
    ASSERT_TRUE(restarted.ready()) << restarted.words();
    Attacker attacker(restarted, target_);
    attacker.replay(said);
    OverheardSession session(restarted, target_, key_);
    int rounds = 0;
    ASSERT_TRUE(session.start());
    EXPECT_TRUE(session.command([&] {
        attacker.replay(said);
        return ++rounds >= 5 && session.answers() > 0;
    }));
    EXPECT_TRUE(session.still_answers());
    EXPECT_EQ(session.foreign(), 0U);
    EXPECT_EQ(restarted.terminate(), 0);
    const auto counters = restarted.report().at("security");
    EXPECT_EQ(counters.at("replayed"), 0);  // none of them was ever under a key of this life
    EXPECT_GT(counters.at("no_key"), 0);
}

// Overheard before the relay and delivered at once, it would be there before its delay.
TEST_P(Attack, WhatTheRelayHasNotPassedOnIsRefused) {
    int rounds = 0;
    EXPECT_TRUE(session_.command([&] {
        session_.command_past_the_relay();
        return ++rounds == 200;
    }));
    expect_unmoved();
    EXPECT_GE(security_at_the_end().at("wrong_role"), 200);
}

// One key, two rigs: a middle man, who has no key, joins a session to a node of another rig.
TEST_P(Attack, ASessionOfAnotherRigIsNotObeyed) {
    LoneNode node(target_.program, under_lab_key(key_) + "rig = 'A'\n" + target_.config);
    ASSERT_TRUE(node.ready()) << node.words();
    OverheardSession other(node, target_, key_, "name B " + std::to_string(node.base_port()));
    EXPECT_FALSE(other.start(std::chrono::milliseconds{800}));
    EXPECT_TRUE(wait_until([&] {
        return node.words().find("wrong lab key or another rig: session") != std::string::npos ||
               other.start(std::chrono::milliseconds{100});
    })) << node.words();
    EXPECT_NE(other.state(), NodeState::kRunning);
    EXPECT_EQ(other.answers(), 0U);
    EXPECT_EQ(node.terminate(), 0);
    const auto counters = node.report().at("security");
    EXPECT_GT(counters.at("handshake_refused"), 0);
    EXPECT_EQ(counters.at("handshakes"), 0);
    EXPECT_EQ(counters.at("opened"), 0);
}

// Cheap and costly floods. They fill the kernel's buffers, and the trial may end as on any broken network. No output
// moves, and the next trial runs as usual.
TEST_P(Attack, AFloodMovesNothing) {
    const SessionTime begin = wall_now();
    EXPECT_TRUE(session_.command([&] {
        attacker_.flood(200);
        attacker_.flood_in_the_name_of(session_.commands(), 100);
        return wall_now() - begin > std::chrono::milliseconds{300} && attacker_.sent() > 1000;
    }));
    EXPECT_EQ(session_.foreign(), 0U);
    if (session_.state() != NodeState::kRunning) RecordProperty("trial_ended", 1);
    // Whether the flood ends the trial may show late. A node that hears of the next trial has read the flood.
    ASSERT_TRUE(session_.start()) << node_.words();
    expect_unmoved();
    const double seconds_s = to_seconds(wall_now() - begin);
    const auto counters = security_at_the_end();
    say_flood(fmt::format("{} datagrams to {} alone", attacker_.sent(), target_.program), seconds_s,
              counters);
    EXPECT_GT(counters.at("handshake_refused"), 0);
    EXPECT_GT(counters.at("wrong_role"), 0);
    EXPECT_GT(counters.at("forged"), 100) << "refused by their code, not by a name that was made up";
}

INSTANTIATE_TEST_SUITE_P(OnTheWire, Attack, testing::ValuesIn(kAttackTargets),
                         [](const auto& target) { return target.param.name; });

TEST_F(LabKeyTest, ARunUnderAKeyIsUndisturbedByWhoeverHasNone) {
    SessionFile file = SessionFile::unhurried();
    file.more = under_lab_key(key_);
    RealRun run(file, {"--monitor"});
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    PlayedView view(run.base_port(), PlayedView::Ports::kExperimenter,
                    {SecurityMode::kLabKey, false, key_.string(), ""});
    EXPECT_TRUE(wait_until([&] {
        view.listen(wall_now());
        return view.heard() > 0 || run.launcher().poll().has_value();
    }));
    EXPECT_GT(view.heard(), 0U);
    disturb_until_the_end(run, [](HostilePeer& peer) {
        peer.send_broken();
        peer.send_as_second_sender(1);
    });
    expect_end(run, 0, EndReason::kCompleted);
    for (const char* program : kNodePrograms) {
        const auto report = run.report(program);
        EXPECT_EQ(report.at("security").at("mode"), "lab-key") << program;
        EXPECT_GE(report.at("security").at("handshakes"), 1) << program;
        EXPECT_GT(report.at("security").at("unsealed"), 0) << program;
        EXPECT_EQ(report.at("refused").at("second_sender"), 0) << program;
    }
    const auto session = run.report("session");
    EXPECT_GE(session.at("security").at("handshakes"), kNodePrograms.size());
    EXPECT_GT(session.at("security").at("unsealed"), 0);
    EXPECT_THAT(read_text(run.out() / "report.html"), HasSubstr("Protection"));
}

// Order only: how fast it was, and what became of the deadlines, it prints for docs/security.md.
TEST_F(LabKeyTest, ARunUnderAFloodEndsAsWithout) {
    SessionFile file = SessionFile::unhurried();
    file.more = under_lab_key(key_);
    RealRun run(file);
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    HandshakeBytes made_up{};
    const std::span header = std::span(made_up).first<kSealHeaderBytes>();
    const NetworkSettings network = network_at(run.base_port());
    UdpChannel forces(std::nullopt, network.at(Port::kMasterForce)),
        control(std::nullopt, network.at(Port::kMasterControl)),
        needle(std::nullopt, network.at(Port::kNetemNeedle));
    const SessionTime begin = wall_now();
    for (std::uint32_t burst = 1; !run.launcher().poll() && burst < 20'000; ++burst) {
        for (std::uint32_t i = 0; i < 10; ++i) {
            write_seal_header({PacketKind::kHop, Port::kMasterForce, burst, i + 1}, header);
            forces.send(made_up);
            write_seal_header({PacketKind::kHello, Port::kMasterControl, 0, 0}, header);
            control.send(made_up);
            write_seal_header({PacketKind::kHop, Port::kNetemNeedle, burst, i + 1}, header);
            needle.send(made_up);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    const double seconds_s = to_seconds(wall_now() - begin);
    expect_end(run, 0, EndReason::kCompleted);
    for (const char* program : {"thimble-master", "thimble-netem", "thimble-slave-sim"}) {
        const auto report = run.report(program);
        say_flood(fmt::format("{} in a run, {} of {} deadlines missed", program,
                              report.at("deadlines_missed").get<std::uint64_t>(),
                              report.at("deadlines").get<std::uint64_t>()),
                  seconds_s, report.at("security"));
    }
    const auto master = run.report("thimble-master").at("security"),
               netem = run.report("thimble-netem").at("security"),
               slave = run.report("thimble-slave-sim").at("security");
    EXPECT_GT(master.at("no_key"), 100);
    EXPECT_GT(master.at("handshake_refused"), 100);
    EXPECT_GT(netem.at("no_key"), 100);
    EXPECT_EQ(slave.at("no_key"), 0) << "the relay passes on nothing that it was not sent";
    EXPECT_EQ(slave.at("forged"), 0);
}

// Nodes that are ready before their session begins: their start takes nothing of its peer_wait_s.
class StandingUnderKeys {
  public:
    StandingUnderKeys(const Folder& folder, const std::string& session,
                      const std::function<std::filesystem::path(const std::string& program)>& key_of)
        : folder_(folder), words_(fmt::format("{} --base-port {}", session, ports_.base())) {
        for (const std::string program : kNodePrograms) {
            setenv("THIMBLE_LAB_KEY_FILE", key_of(program).c_str(), 1);
            nodes_.push_back(std::make_unique<Child>(
                built_programs() / program, words_in(words_ + " --die-with-parent"), folder_ / program));
        }
        unsetenv("THIMBLE_LAB_KEY_FILE");
        for (const std::string program : kNodePrograms) EXPECT_TRUE(says(program, "ready"));
    }
    Outcome attach(const std::filesystem::path& key) const {
        setenv("THIMBLE_LAB_KEY_FILE", key.c_str(), 1);
        const Outcome run = run_thimble(
            words_in(fmt::format("run {} --attach --out {}", words_, (folder_ / "out").string())));
        unsetenv("THIMBLE_LAB_KEY_FILE");
        return run;
    }
    // Sooner or later.
    bool says(const std::string& program, const std::string& words) const {
        return wait_until([&] { return read_text(folder_ / program).find(words) != std::string::npos; });
    }

  private:
    const Folder& folder_;
    PortBlock ports_;
    std::string words_;
    std::vector<std::unique_ptr<Child>> nodes_;
};

TEST_F(LabKeyTest, ANodeWithAnotherKeyIsNamed) {
    const auto other_key = folder_ / "other.key";
    create_lab_key(other_key, system_random_bytes());
    SessionFile file;
    file.peer_wait_s = 2;  // it passes
    file.more = "[security]\nmode = 'lab-key'\n";
    const auto session = folder_.write("session.toml", file.text()).string();
    const StandingUnderKeys nodes(folder_, session, [&](const std::string& program) {
        return program == "thimble-cutaneous" ? other_key : key_;
    });
    const Outcome run = nodes.attach(key_);
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.words, testing::ContainsRegex("no answer from .*cutaneous.* within"));
    EXPECT_THAT(run.words, HasSubstr("wrong lab key or another rig: cutaneous"));
    EXPECT_TRUE(nodes.says("thimble-cutaneous", "wrong lab key or another rig: session"));
}

TEST_F(LabKeyTest, IsMadeByKeygenOnce) {
    const auto keygen = [this] { return run_thimble({"keygen", (folder_ / "new.key").string()}); };
    EXPECT_EQ(keygen().code, 0);
    EXPECT_NO_THROW(read_lab_key(folder_ / "new.key"));
    EXPECT_EQ(keygen().code, 2);
}

TEST_F(LabKeyTest, IsMadeWhereItIsAskedForBesideAServicesCredential) {
    setenv("CREDENTIALS_DIRECTORY", key_.parent_path().c_str(), 1);
    const Outcome outcome = run_thimble({"keygen", (folder_ / "new.key").string()});
    unsetenv("CREDENTIALS_DIRECTORY");
    EXPECT_EQ(outcome.code, 0) << outcome.words;
    EXPECT_NO_THROW(read_lab_key(folder_ / "new.key"));
}

TEST_F(LabKeyTest, MachinesWithoutOneAreRefused) {
    const auto file = folder_.write("open.toml", "[network]\nhost_slave_sim = '192.0.2.1'\n");
    for (const char* program : {"thimble-master", "thimble-netem"}) {
        const Outcome outcome = run_to_end(built_programs() / program, {file.string()});
        EXPECT_EQ(outcome.code, 2) << outcome.words;
        EXPECT_THAT(outcome.words, HasSubstr("thimble keygen"));
    }
    const Outcome run = run_thimble({"run", file.string(), "--out", (folder_ / "out").string()});
    EXPECT_EQ(run.code, 2) << run.words;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

// A session file that says nothing, and a local user who speaks at every port.
TEST(UserKey, SealsARunThatAsksForNothing) {
    RealRun run(SessionFile::unhurried());
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    disturb_until_the_end(run, [](HostilePeer& peer) { peer.send_as_second_sender(1); });
    expect_end(run, 0, EndReason::kCompleted);
    EXPECT_THAT(run.words(), testing::Not(HasSubstr("not protected")));
    for (const char* program : kNodePrograms) {
        const auto report = run.report(program);
        EXPECT_EQ(report.at("security").at("mode"), "user-key") << program;
        EXPECT_GT(report.at("security").at("unsealed"), 0) << program;
        EXPECT_EQ(report.at("refused").at("second_sender"), 0) << program;
    }
    EXPECT_EQ(run.report("session").at("security").at("mode"), "user-key");
    EXPECT_TRUE(std::filesystem::exists(user_key_file()));
}

TEST(UserKey, ThatCannotBeMadeLeavesNoFolderBehind) {
    const PortBlock ports;
    const Folder folder;
    const auto out = folder / "out";
    const std::string before = std::getenv("XDG_STATE_HOME");
    setenv("XDG_STATE_HOME", "/proc/nowhere", 1);  // where root cannot write either
    const Outcome run = run_thimble({"run", folder.write("session.toml", SessionFile{}.text()).string(),
                                     "--out", out.string(), "--base-port", std::to_string(ports.base())});
    setenv("XDG_STATE_HOME", before.c_str(), 1);
    EXPECT_EQ(run.code, 2) << run.words;
    EXPECT_THAT(run.words, HasSubstr("set XDG_STATE_HOME"));
    EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(UserKey, ARealHandleIsRefusedOnAnOpenNetwork) {
    LoneNode real("thimble-master",
                  "[handle]\ndevice = 'force-dimension'\n[network]\nhost_netem = '192.0.2.1'\n"
                  "[security]\nmode = 'none'\nallow_unprotected_network = true\n");
    EXPECT_EQ(real.process().wait(kPatience), 2);
    EXPECT_THAT(real.words(), HasSubstr("a real handle or robot accepts no commands"));
}

// A trial among hostile datagrams goes on; each is counted by its name.
TEST(HostileRun, BrokenDatagramsStrangersAndSecondSendersAtEveryPort) {
    SessionFile file = SessionFile::unhurried();
    file.more = kUnprotectedTable;
    RealRun run(file);
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    disturb_until_the_end(run, [](HostilePeer& peer) {
        peer.send_broken();
        peer.send_as_second_sender(1);
        peer.send_from_strangers();
    });
    expect_end(run, 0, EndReason::kCompleted, "datagrams are not protected");
    EXPECT_TRUE(run.rows().at(0).metrics.beeped);
    EXPECT_LT(run.rows().at(0).metrics.penetration_max_m,
              0.02);  // a needle at 0.2 m would have been far beyond
    for (const char* program : kNodePrograms) {
        const auto refused = run.report(program).at("refused");
        for (const char* name : {"too_short", "malformed", "foreign_format", "not_finite", "out_of_range",
                                 "too_long", "second_sender", "foreign_source"}) {
            EXPECT_GT(refused.at(name), 0) << program << ' ' << name;
        }
    }
}

}  // namespace
}  // namespace thimble
