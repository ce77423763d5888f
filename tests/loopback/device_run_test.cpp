// A trial on the fingers with twelve drives behind cannelloni: the emulator is the other end of the wire.
#include <csignal>
#include <cstdlib>
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/emulator/emulated_drives.hpp"
#include "tests/devices/mock_haply.hpp"
#include "tests/loopback/lone_node.hpp"
#include "tests/loopback/played_view.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

class EmulatorRun {
  public:
    explicit EmulatorRun(const std::vector<std::string>& more = {})
        : child_(built_programs() / "thimble-drive-emulator", arguments(more), folder_ / "words") {}

    // A machine that stalls for a second is no lost heartbeat.
    std::string tables() const {
        return "[cutaneous]\ndevice = \"drives\"\n[cutaneous.drives]\nbus = \"cannelloni:127.0.0.1:" +
               std::to_string(ports_.base()) + "\"\nlisten_port = " + std::to_string(ports_.base() + 1) +
               "\nsilent_after_s = 3\n";
    }
    std::string end() {
        child_.signal(SIGTERM);
        child_.wait(kPatience);
        return read_text(folder_ / "words");
    }

  private:
    std::vector<std::string> arguments(const std::vector<std::string>& more) const {
        return words_in(fmt::format("--listen {} --to 127.0.0.1:{}", ports_.base(), ports_.base() + 1), more);
    }

    Folder folder_;
    PortBlock ports_;
    Child child_;
};

SessionFile on_the_fingers(const EmulatorRun& emulator, const std::string& modality) {
    SessionFile session;
    session.modalities = "[\"" + modality + "\"]";
    session.more = emulator.tables();
    return session;
}

TEST(DriveRun, ATrialIsFeltThroughTwelveDrives) {
    EmulatorRun emulator;
    SessionFile session = on_the_fingers(emulator, "CF");
    session.contact_hold_s = 2;  // a machine that stalls for a second in it still presses
    RealRun run(session);
    ASSERT_EQ(run.end(), 0) << run.words() << emulator.end();
    EXPECT_EQ(run.rows().at(0).reason, EndReason::kCompleted);
    const auto drives = run.report("thimble-cutaneous").at("drives");
    EXPECT_GT(drives.at("cycles"), 100);
    EXPECT_EQ(drives.at("datagrams_malformed"), 0);
    EXPECT_EQ(drives.at("fault"), "");
    const std::string words = emulator.end();
    const auto force = words.find("strongest force ");
    ASSERT_NE(force, std::string::npos) << "it lives until it is told to end: " << words;
    EXPECT_GT(std::stod(words.substr(force + 16)), 0.3);
}

TEST(DriveRun, AFaultEndsTheTrialRecordedAndIsWhatTheRunEndsWith) {
    EmulatorRun emulator({"--fault-when-pressed", "emcy 9 0x4210"});
    SessionFile session = on_the_fingers(emulator, "CCF");
    session.contact_hold_s = kEndlessHold_s;
    RealRun run(session);
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("drive 9 (other hand, index, cable 2): EMCY 0x4210 (too hot)"));
    ASSERT_EQ(run.only_reason(), EndReason::kDeviceFault);
    EXPECT_EQ(run.rows()[0].lost_peer, Role::kCutaneous);
    EXPECT_THAT(run.first_trial_end(), HasSubstr("device_fault_cutaneous"));
}

TEST(DriveRun, ADriveThatRefusesKeepsTheSessionFromStarting) {
    EmulatorRun emulator({"--fault", "refuse 3 0x6060"});
    RealRun run(on_the_fingers(emulator, "CF"));
    EXPECT_EQ(run.end(), 3) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("drive 3 (acting hand, index, cable 2): rejected 'mode 0x6060'"));
    EXPECT_TRUE(run.rows().empty());
}

TEST(DriveRun, TheEmulatorNamesItsOptionForAnAddressThatItCannotUse) {
    const Outcome refused = run_to_end(built_programs() / "thimble-drive-emulator", {"--to", "::1:9000"});
    EXPECT_EQ(refused.code, 3) << refused.words;
    EXPECT_THAT(refused.words, HasSubstr("IPv4 address to --to"));
}

TEST(DriveRun, TheEmulatorRefusesAWrongFaultBeforeItStarts) {
    const Outcome refused =
        run_to_end(built_programs() / "thimble-drive-emulator", {"--fault-when-pressed", "emyc 9 0x4210"});
    EXPECT_EQ(refused.code, 2) << refused.words;
    EXPECT_THAT(refused.words, HasSubstr("--fault-when-pressed 'emyc 9 0x4210': unknown command"));
}

TEST(DriveRun, TheEmulatorRefusesTwoDrivesOfOneNode) {
    const Outcome refused =  // the wrong fault would end it, too
        run_to_end(built_programs() / "thimble-drive-emulator", {"--nodes", "3,1,3", "--fault", "none"});
    EXPECT_EQ(refused.code, 2) << refused.words;
    EXPECT_THAT(refused.words, HasSubstr("--nodes: 3 is given twice"));
}

// The drives are here, so that what the program leaves behind shows before any drive misses a heartbeat.
class DriveCheck : public testing::Test {
  protected:
    std::string file(const std::string& keys = "") {
        return folder.write(
            "device.toml",
            "[cutaneous.drives]\nbus = \"cannelloni:127.0.0.1:" + std::to_string(ports.base()) +
                "\"\nlisten_port = " + std::to_string(ports.base() + 1) +
                "\nsilent_after_s = 10\ntake_up_limit_s = 60\n" +
                "acting_thumb = []\nother_index = []\nother_thumb = []\n" + keys);
    }

    const std::filesystem::path program = built_programs() / "thimble-drive-check";
    Folder folder;
    PortBlock ports;
    UdpChannel channel{Endpoint{"127.0.0.1", ports.base()},
                       Endpoint{"127.0.0.1", static_cast<std::uint16_t>(ports.base() + 1)}};
    CannelloniBus bus{channel};
};

TEST_F(DriveCheck, InterruptedItLeavesNoDriveWithVoltage) {
    PlantParameters endless;
    endless.loose_m = 100;  // no cable gets taut
    EmulatedDrives drives({1, 2, 3}, endless, bus);
    const auto each = [&](auto holds) {
        drives.tick(wall_now());
        return holds(drives.drive(0)) && holds(drives.drive(1)) && holds(drives.drive(2));
    };
    Child check(program, {file()}, folder / "words");
    const auto enabled = [](const DriveEmulator& drive) {
        return drive.state() == DriveState::kOperationEnabled;
    };
    ASSERT_TRUE(wait_until([&] { return each(enabled); })) << check.last_lines();
    check.signal(SIGINT);
    ASSERT_TRUE(
        wait_until([&] { return !each(enabled) && check.poll().has_value(); }, std::chrono::seconds{9}));
    EXPECT_EQ(check.poll(), 1);
    EXPECT_TRUE(
        each([](const DriveEmulator& drive) { return drive.state() == DriveState::kSwitchOnDisabled; }));
}

TEST_F(DriveCheck, AsksForNoForceThatTheDeviceWouldNotGet) {
    for (const char* force_N : {"3", "0.015"}) {
        const Outcome refused = run_to_end(program.string(), {file(), "--force-N", force_N});
        EXPECT_EQ(refused.code, 2) << refused.words;
        EXPECT_NE(refused.words.find("--force-N"), std::string::npos) << refused.words;
    }
}

TEST_F(DriveCheck, InterruptedWhileItPressesItFailsAndMeasuresNothing) {
    EmulatedDrives drives({1, 2, 3}, PlantParameters{}, bus);
    Child check(program, {file("cycle_s = 0.02\n"), "--seconds", "60"}, folder / "words");
    ASSERT_TRUE(wait_until([&] {
        drives.tick(wall_now());
        return drives.force_N(0) > 0.3;
    })) << check.last_lines();
    check.signal(SIGINT);
    EXPECT_EQ(check.wait(kPatience), 1);
    const std::string words = read_text(folder / "words");
    EXPECT_THAT(words, HasSubstr("interrupted while a finger was pressed"));
    EXPECT_THAT(words, testing::Not(HasSubstr("measured")));
}

TEST_F(DriveCheck, RefusesAKeyThatNobodyReads) {
    const Outcome refused = run_to_end(program, {file("pretention_N = 0.1\n")});
    EXPECT_EQ(refused.code, 2) << refused.words;
    EXPECT_THAT(refused.words, HasSubstr("pretention_N"));
}

SessionFile session_of_device(const std::string& device, const std::string& keys) {
    SessionFile file;
    file.contact_hold_s = 0.3;
    file.more = "[handle]\ndevice = \"" + device + "\"\n" + keys;
    return file;
}

// The words of an emulated device. `pushed` is among them once it has pushed with all its force.
struct DeviceLog {
    std::function<std::string()> text;
    const char* pushed;
};

// The scripted hand stays in until the trial has beeped and the device has pushed.
void withdraw_after_the_beep(RealRun& run, const DeviceLog& log, const std::function<void()>& come_out) {
    PlayedView view(run.base_port());
    EXPECT_TRUE(wait_until([&] {
        view.listen(wall_now());
        const bool felt = view.monitor().beeped && log.text().find(log.pushed) != std::string::npos;
        return felt || run.launcher().poll();
    })) << run.words();
    come_out();
}

void expect_a_persons_trial(RealRun& run, const DeviceLog& log) {
    EXPECT_EQ(run.end(), 0) << run.words();
    ASSERT_EQ(run.only_reason(), EndReason::kCompleted);
    EXPECT_GT(run.rows()[0].metrics.penetration_max_m, 0.02);
    EXPECT_THAT(log.text(), HasSubstr(log.pushed));
}

// A trial with a real handle's driver in the real master: Force Dimension's, with a library of our own behind it that plays a hand.
class HandleRun : public testing::Test {
  protected:
    // The hand goes in within 1000 reads, `press` metres deep, and out again within 1000 more.
    SessionFile session(const std::string& script) {
        const auto path = folder_.write("script", "log " + (folder_ / "log").string() + '\n' + script);
        setenv("THIMBLE_FAKE_DHD", path.c_str(), 1);
        return session_of_device("force-dimension",
                                 "force_dimension.library = \"" THIMBLE_FAKE_DHD_FILE "\"\n");
    }
    std::string device_log() const { return read_text(folder_ / "log"); }

    Folder folder_;
};

TEST_F(HandleRun, APersonsTrialEndsWhenTheNeedleIsWithdrawn) {
    // The fixture is hard: the device's limit is reached, and pushes out along its x.
    const DeviceLog log{[this] { return device_log(); }, "force 12.000 0.000 0.000"};
    RealRun run(session("press 0.02\nback " + (folder_ / "back").string() + '\n'), {"--monitor"});
    withdraw_after_the_beep(run, log, [this] { folder_.write("back", ""); });
    expect_a_persons_trial(run, log);
    EXPECT_EQ(run.report("thimble-master")["handle"]["device"], "omega.3, serial 1001, SDK 3.17.0.0");
    EXPECT_THAT(device_log(), testing::EndsWith("stop\nclose\n"));
}

TEST_F(HandleRun, AnUnpluggedHandleEndsTheTrialInItsOwnWords) {
    SessionFile file = session("press 0.02\nunplugged_after 600\n");
    file.delays_s = "[0.0, 0.05]";
    file.parallel_conditions = 2;  // but there is one device: the second delay would come after the first
    RealRun run(file);
    EXPECT_EQ(run.first_trial_end(), "# ended: device_fault_master");
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("the device of master failed: omega.3, serial 1001"));
    EXPECT_THAT(run.words(), HasSubstr("communication error (error 2); is it still plugged in"));
    ASSERT_EQ(run.rows().size(), 1U);
    EXPECT_EQ(outcome_text(run.rows()[0].reason, run.rows()[0].lost_peer), "device_fault_master");
    EXPECT_FALSE(read_trajectory(run.trajectory_path(run.rows()[0].conditions)).samples.empty());
    EXPECT_THAT(read_text(run.out() / "report.html"), HasSubstr("communication error"));
}

// A device that a thread of the master talks to. `tell` gives the hand a word, "go" or "back".
void hold_a_persons_trial(RealRun& run, const DeviceLog& log, const std::function<void(const char*)>& tell) {
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    tell("go");
    withdraw_after_the_beep(run, log, [&] { tell("back"); });
    run.end();
}

// A machine that stands still for 0.2 s makes such a device silent, and the master gives it up, as it should.
// `pauses`: the emulator's own record of its silence.
bool was_rightly_lost(RealRun& run, const std::string& pauses) {
    if (run.words().find("device_fault_master") == std::string::npos) return false;
    EXPECT_FALSE(pauses.empty()) << "the device was never silent: " << run.words();
    EXPECT_EQ(run.end(), 1) << run.words();
    return true;
}

constexpr const char* kMachineStoodStill = "this machine stood still, so the device was rightly lost";

TEST(HaplyRun, APersonsTrialIsFeltThroughTheService) {
    MockHaply service({"press=0.02"});
    const DeviceLog log{[&] { return service.log(); }, "values 049D 0.00 0.00 3.00\n"};
    RealRun run(session_of_device("haply", "haply.port = " + std::to_string(service.port()) + "\n"),
                {"--monitor"});
    hold_a_persons_trial(run, log, [&](const char* word) { service.make(word); });
    if (was_rightly_lost(run, service.pauses())) GTEST_SKIP() << kMachineStoodStill;
    expect_a_persons_trial(run, log);
    EXPECT_EQ(run.report("thimble-master")["handle"]["device"], "Haply Inverse3 049D");
    EXPECT_TRUE(service.ends_with("values 049D 0.00 0.00 0.00\nclosed\n")) << service.log();
}

TEST(HaplyRun, WithoutTheServiceTheRunSaysWhatToStart) {
    RealRun run(session_of_device("haply", "haply.port = 1\n"));
    EXPECT_NE(run.end(), 0);
    EXPECT_THAT(run.words(), HasSubstr("no Haply Inverse Service at ws://localhost:1: Connection refused"));
}

TEST(HaplyRun, LockStepRefusesARealHandle) {
    RealRun run(session_of_device("haply", ""), kLockStep);
    EXPECT_EQ(run.end(), 2) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("device"));
}

TEST_F(HandleRun, APersonsTrialIsFeltThroughTheTouch) {
    std::string script = "press 0.02\n";
    for (const char* name : {"log", "go", "back", "pauses"})
        script += fmt::format("{} {}\n", name, (folder_ / name).string());
    setenv("THIMBLE_FAKE_HD", folder_.write("hd", script).c_str(), 1);
    const DeviceLog log{[this] { return device_log(); }, "force 0.00 0.00 3.30\n"};
    RealRun run(session_of_device("touch", "touch.library = \"" THIMBLE_FAKE_HD_FILE "\"\n"), {"--monitor"});
    hold_a_persons_trial(run, log, [this](const char* word) { folder_.write(word, ""); });
    if (was_rightly_lost(run, read_text(folder_ / "pauses"))) GTEST_SKIP() << kMachineStoodStill;
    expect_a_persons_trial(run, log);
    EXPECT_EQ(run.report("thimble-master")["handle"]["device"], "Touch, serial T1");
    EXPECT_THAT(device_log(), testing::EndsWith("force 0.00 0.00 0.00\nstop\ndisable\ndisable device\n"));
}

}  // namespace
}  // namespace thimble
