// Commands and reports between two threads: newest wins, a silent side costs the force, not the hand.
#include "master/devices/falcon/falcon_exchange.hpp"

#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "tests/unit/handles/falcon_emulator.hpp"

namespace thimble {
namespace {

class FalconExchangeTest : public testing::Test {
  protected:
    FalconExchangeTest() {
        device.running = true;
        link.control(3, 0x0002);
    }
    FalconEmulator device;
    EmulatedFalconLink link{device};
    FalconMailbox mailbox;
    std::optional<FalconExchange> exchange{std::in_place, link, mailbox};
};

TEST_F(FalconExchangeTest, BringsMotorsThereAndEncodersBack) {
    EXPECT_FALSE(mailbox.latest().any);
    device.report = {{-1447, 32767, -32768}, 0xf, 5};
    mailbox.command({4095, -4095, 7});
    ASSERT_TRUE(exchange->turn());
    EXPECT_EQ(device.commanded.motors, (FalconTriple{4095, -4095, 7}));
    EXPECT_EQ(device.commanded.lights, kFalconRed);
    const auto latest = mailbox.latest();
    ASSERT_TRUE(latest.any);
    EXPECT_EQ(latest.report.encoders, device.report.encoders);
    EXPECT_EQ(latest.report.buttons, 0xf);
    EXPECT_EQ(latest.report.homed_legs, 5);
    exchange->turn();
    EXPECT_EQ(mailbox.latest().count, static_cast<std::uint8_t>(latest.count + 1));
}

TEST_F(FalconExchangeTest, AForceThatNobodyRenewsEnds) {
    mailbox.command({100, 0, 0});
    for (int i = 0; i <= FalconExchange::kUnattendedReads; ++i) {
        exchange->turn();
        EXPECT_EQ(device.commanded.motors[0], 100) << i;
    }
    EXPECT_FALSE(mailbox.take_withheld());
    exchange->turn();
    EXPECT_EQ(device.commanded.motors[0], 0);
    EXPECT_TRUE(mailbox.take_withheld()) << "the handle must not think that the force acts";
    mailbox.command({3, 0, 0});
    exchange->turn();
    EXPECT_EQ(device.commanded.motors[0], 3);
    EXPECT_FALSE(mailbox.take_withheld());
}

// By the time that the exchanges take, not by their number.
TEST_F(FalconExchangeTest, AForceThatNobodyRenewsEndsAsSoonWithSlowAnswers) {
    device.reads_before_report = FalconExchange::kReads - 1;
    mailbox.command({100, 0, 0});
    for (int reads = 0; reads <= FalconExchange::kUnattendedReads; reads += FalconExchange::kReads) {
        exchange->turn();
        EXPECT_EQ(device.commanded.motors[0], 100) << reads;
        EXPECT_FALSE(mailbox.silent()) << "the fifth read brings it";
    }
    exchange->turn();
    EXPECT_EQ(device.commanded.motors[0], 0);
    ++device.reads_before_report;
    exchange->turn();
    EXPECT_TRUE(mailbox.silent());
}

// From the second tick on: the first still answers the last report.
TEST_F(FalconExchangeTest, WhatIsNotAnsweredCostsTheForceUntilItIs) {
    for (bool FalconEmulator::*fault :
         {&FalconEmulator::silent, &FalconEmulator::short_reports, &FalconEmulator::garbled_reports}) {
        mailbox.command({100, 100, 100});
        exchange->turn();
        EXPECT_EQ(device.commanded.motors[0], 100);
        device.*fault = true;
        mailbox.command({101, 100, 100});
        exchange->turn();
        EXPECT_TRUE(mailbox.silent());
        mailbox.command({102, 100, 100});
        exchange->turn();
        EXPECT_EQ(device.commanded.motors, FalconTriple{});
        device.*fault = false;
        exchange->turn();
        EXPECT_EQ(device.commanded.motors, FalconTriple{}) << "asked before it had answered";
        EXPECT_FALSE(mailbox.silent());
        mailbox.command({102, 100, 100});
        exchange->turn();
        EXPECT_EQ(device.commanded.motors, FalconTriple{}) << "commanded before the handle knew";
        EXPECT_TRUE(mailbox.take_withheld());
        mailbox.command({103, 100, 100});
        exchange->turn();
        EXPECT_EQ(device.commanded.motors[0], 103);
    }
}

TEST_F(FalconExchangeTest, AReportInTwoPacketsIsOneReport) {
    device.packet_bytes = 9;
    mailbox.command({100, 0, 0});
    exchange->turn();
    EXPECT_TRUE(mailbox.latest().any);
    EXPECT_FALSE(mailbox.silent());
}

TEST_F(FalconExchangeTest, TheLightSaysHowFarHomingIs) {
    const auto light_after = [&](std::uint8_t homed_legs) {
        device.report.homed_legs = homed_legs;
        exchange->turn();
        exchange->turn();
        return device.commanded.lights;
    };
    EXPECT_EQ(light_after(0), kFalconRed);
    EXPECT_EQ(light_after(4), kFalconBlue);
    EXPECT_EQ(light_after(7), kFalconGreen);
    EXPECT_TRUE(device.commanded.homing);
    EXPECT_EQ(light_after(0), kFalconRed);
}

TEST_F(FalconExchangeTest, EndsWithoutForce) {
    mailbox.command({100, 100, 100});
    exchange->turn();
    exchange.reset();
    EXPECT_EQ(device.commanded.motors, FalconTriple{});
}

// A fault of the USB that passes: the device has power, and its last force.
TEST_F(FalconExchangeTest, EndsWithoutForceAlsoAfterAFailedRead) {
    mailbox.command({100, 100, 100});
    exchange->turn();
    device.failing_reads = true;
    EXPECT_FALSE(exchange->turn());
    EXPECT_EQ(device.commanded.motors[0], 100);
    exchange.reset();
    EXPECT_EQ(device.commanded.motors, FalconTriple{});
}

TEST_F(FalconExchangeTest, AnUnpluggedDeviceIsLostForThatReason) {
    device.unplugged = true;
    EXPECT_FALSE(exchange->turn());
    mailbox.lose(FalconLoss::kGuardianEnded);
    EXPECT_EQ(mailbox.loss(), FalconLoss::kUnplugged);
}

// The reader always gets one report, never parts of two.
TEST_F(FalconExchangeTest, NothingIsTornBetweenThreads) {
    device.report = {{-1, -1, -1}, 0xf, 7};
    std::thread turning([&] {
        while (!mailbox.asked_to_end()) exchange->turn();
    });
    for (std::int16_t i = 0; i < 20000; ++i) {
        const auto value = static_cast<std::int16_t>(i % 2 == 0 ? -1 : 0x5555);
        mailbox.command({value, value, value});
        const auto latest = mailbox.latest();
        if (!latest.any) continue;
        EXPECT_EQ(latest.report.encoders, device.report.encoders);
    }
    mailbox.ask_to_end();
    turning.join();
    EXPECT_EQ(device.commands, mailbox.turns());
}

}  // namespace
}  // namespace thimble
