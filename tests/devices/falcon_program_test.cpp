// thimble-master with a Falcon under the real libusb: what it says before it is ready, and when it gives up.
#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/wall_clock.hpp"
#include "master/devices/falcon/falcon_exchange.hpp"
#include "tests/devices/mock_falcon.hpp"
#include "tests/loopback/lone_node.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

class FalconProgram : public OnABed<MockBed> {
  protected:
    void SetUp() override {
        OnABed::SetUp();
        if (!bed_) return;
        falcon_.emplace(*bed_, 2, "F1");
        falcon_->with([](FalconEmulator& device) {
            device.running = true;
            device.report.homed_legs = 0;
        });
    }
    static std::string tables(const std::string& more) { return "[handle]\ndevice = \"falcon\"\n" + more; }
    void home(std::uint8_t legs) {
        falcon_->with([legs](FalconEmulator& device) { device.report.homed_legs = legs; });
    }

    std::optional<MockFalcon> falcon_;
};

TEST_F(FalconProgram, WaitsForItsUserToHomeIt) {
    LoneNode node("thimble-master", tables(""));
    const auto says = [&](const char* words) {
        return wait_until([&] { return node.words().find(words) != std::string::npos; });
    };
    ASSERT_TRUE(says("Novint Falcon, serial F1: 0 of 3 legs homed; pull the grip all the way out"))
        << node.words();
    EXPECT_THAT(node.words(), testing::Not(HasSubstr("ready")));
    home(4);
    ASSERT_TRUE(says("1 of 3 legs homed")) << node.words();
    home(7);
    ASSERT_TRUE(says("ready, ports from")) << node.words();
    EXPECT_EQ(node.terminate(), 0) << node.words();
}

// Between trials, when thimble-master ticks on heartbeats only; each stop is released, which says who had stopped.
TEST_F(FalconProgram, HearsEveryShortPressOfAButtonBetweenTrials) {
    home(7);
    LoneNode node("thimble-master", tables("[security]\nmode = 'user-key'\n"));  // as thimble stop has it
    ASSERT_TRUE(node.ready()) << node.words();
    const std::string port = std::to_string(node.base_port());
    const auto press = [&](std::uint8_t buttons) {
        falcon_->with([buttons](FalconEmulator& device) { device.report.buttons = buttons; });
    };
    const auto exchanges = [&] {
        return falcon_->with([](FalconEmulator& device) { return device.commands; });
    };
    for (int i = 0; i < 4; ++i) {
        wall_sleep(std::chrono::milliseconds{26 * i});
        press(kFalconPlus);
        const auto before = exchanges();
        EXPECT_TRUE(wait_until([&] { return exchanges() >= before + 20; }));  // 20 ms of the emulated USB
        press(0);
        Outcome released;
        EXPECT_TRUE(wait_until([&] {
            released = run_thimble({"stop", "--release", "--parallel-conditions", "1", "--base-port", port});
            return released.words.find("the stop button at the handle") != std::string::npos;
        })) << "press "
            << i << ": " << released.words;
    }
    EXPECT_EQ(node.terminate(), 0) << node.words();
}

// A master in a trial with a force at the handle. The count of commands tells the time of the emulated USB.
TEST_F(FalconProgram, AMasterThatIsKilledOrStoppedLeavesNoForce) {
    falcon_->with([](FalconEmulator& device) { device.put_hand_at({0, 0, 0.115}); });
    home(7);
    const auto counted = [&](std::uint64_t FalconEmulator::*which) {
        return falcon_->with([which](FalconEmulator& device) { return device.*which; });
    };
    const auto pushes = [&] {
        return falcon_->with(
            [](FalconEmulator& device) { return device.commanded.motors != FalconTriple{}; });
    };
    for (const int number : {SIGKILL, SIGSTOP}) {
        LoneNode node("thimble-master", tables(""));
        ASSERT_TRUE(node.ready()) << node.words();
        PlayedSession session(node, Role::kMaster, Modality::kHF);
        OutboundFlow slave(Role::kSlaveSim, 7, {node.peers().outlet(Port::kMasterForce)});
        const auto push = [&](SessionTime now) {
            slave.send(now, kPlayedTrial, ForceFeedback{.force_total_N = -2, .echo_time = now});
        };
        ASSERT_TRUE(session.play(push, pushes)) << node.words();
        const auto before = counted(&FalconEmulator::commands_with_force);
        node.process().signal(number);
        EXPECT_TRUE(wait_until([&] { return !pushes(); })) << number;
        EXPECT_LT(counted(&FalconEmulator::commands_with_force) - before,
                  3 * FalconExchange::kUnattendedReads);
        node.process().signal(SIGCONT);
        if (number == SIGSTOP) node.terminate();
        const auto ended = [&] {
            const auto commands = counted(&FalconEmulator::commands);
            wall_sleep(std::chrono::milliseconds{100});
            return counted(&FalconEmulator::commands) == commands;
        };
        EXPECT_TRUE(wait_until(ended)) << "the guardian of a master that has ended";
        EXPECT_FALSE(pushes());
    }
}

TEST_F(FalconProgram, GivesUpAfterItsLimitAndWhenItIsToldTo) {
    LoneNode late("thimble-master", tables("falcon.homing_limit_s = 0.2\n"));
    EXPECT_EQ(late.process().wait(kPatience).value_or(-1), 1);
    EXPECT_THAT(late.words(), HasSubstr("0 of 3 legs homed"));
    EXPECT_THAT(late.words(), HasSubstr("(waited for 0.2 s, [handle.falcon] homing_limit_s)"));
    LoneNode patient("thimble-master", tables(""));
    ASSERT_TRUE(wait_until([&] { return patient.words().find("legs homed") != std::string::npos; }));
    EXPECT_EQ(patient.terminate(), 1);
    EXPECT_THAT(patient.words(), HasSubstr("interrupted; Novint Falcon, serial F1: 0 of 3"));
}

TEST_F(FalconProgram, ARunShowsWhatItWaitsForAndGoesOn) {
    SessionFile file;
    file.modalities = "[\"CF\"]";
    file.contact_hold_s = kEndlessHold_s;
    file.more = tables("");
    falcon_->with([](FalconEmulator& device) { device.put_hand_at({0, 0, 0.125}); });
    RealRun run(file);
    ASSERT_TRUE(wait_until([&] { return run.words().find("0 of 3 legs homed") != std::string::npos; }))
        << run.words();
    home(7);
    EXPECT_TRUE(run.reaches_trial()) << run.words();
    run.launcher().signal(SIGINT);
    expect_end(run, 1, EndReason::kInterrupted);
}

}  // namespace
}  // namespace thimble
