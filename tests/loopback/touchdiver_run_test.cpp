// Trials that are felt through WEART TouchDIVERs: the real programs, and a middleware that knows the SDKs' messages only.
#include <cstdlib>
#include <sys/stat.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loopback/lone_node.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

constexpr const char* kMiddleware = THIMBLE_SOURCE_DIR "/tests/loopback/touchdiver_middleware.py";

class TouchDiverRun : public testing::Test {
  protected:
    void SetUp() override {
        if (std::system("python3 -c 'import json, select, socket' > /dev/null 2>&1") != 0)
            GTEST_SKIP() << "there is no python3 with its standard library (package python3)";
    }
    std::string tables() const {
        return "[cutaneous]\ndevice = \"touchdiver\"\n[cutaneous.touchdiver]\nport = " +
               std::to_string(ports_.base()) + "\n";
    }
    // A session with it as the fingertip device.
    SessionFile session(const std::string& modality) {
        SessionFile file;
        file.modalities = "[\"" + modality + "\"]";
        file.more = tables();
        return file;
    }
    void listen(const std::vector<std::string>& more = {}) {
        child_.emplace("python3",
                       words_in(std::string("-B ") + kMiddleware + ' ' + std::to_string(ports_.base()), more),
                       folder_ / "words");
        ASSERT_TRUE(wait_until([&] { return words().find("listening") != std::string::npos; })) << words();
    }
    std::string words() const { return read_text(folder_ / "words"); }
    // All it says, once its client is gone.
    std::string end() {
        EXPECT_EQ(child_->wait(kPatience), 0) << words();
        return words();
    }

    Folder folder_;
    PortBlock ports_;
    std::optional<Child> child_;
};

TEST_F(TouchDiverRun, ATrialIsFeltOnTheActingHandAndEndsSlack) {
    listen();
    RealRun run(session("CF"));
    ASSERT_EQ(run.end(), 0) << run.words() << words();
    EXPECT_EQ(run.only_reason(), EndReason::kCompleted);
    const std::string told = end();
    EXPECT_THAT(told, HasSubstr("LEFT INDEX 0.000"));
    const auto index = told.find("RIGHT INDEX ");
    ASSERT_NE(index, std::string::npos) << told;
    EXPECT_GT(std::stod(told.substr(index + 12)), 0.06) << "0.3 of 5 N";
    EXPECT_LE(std::stod(told.substr(index + 12)), 0.3) << "1.5 of 5 N";
    EXPECT_THAT(told, HasSubstr("slack at the end\nstopped\n"));
    const auto device = run.report("thimble-cutaneous").at("touchdiver");
    EXPECT_EQ(device.at("bad_messages"), 0);
    EXPECT_GT(device.at("forces"), 4);
}

TEST_F(TouchDiverRun, AMiddlewareThatClosesEndsTheTrialAndTheRunSaysWhy) {
    listen({"--close-when-pressed"});
    SessionFile file = session("CCF");
    file.contact_hold_s = kEndlessHold_s;
    RealRun run(file);
    EXPECT_EQ(run.end(), 1) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("no connection (the other side closed it); start WEART's middleware"));
    ASSERT_EQ(run.only_reason(), EndReason::kDeviceFault);
    EXPECT_THAT(run.first_trial_end(), HasSubstr("device_fault_cutaneous"));
    EXPECT_THAT(end(), HasSubstr("LEFT INDEX 0."));
}

// The report is a pipe without a reader, in place of a slow disk.
TEST_F(TouchDiverRun, AFingerIsLetGoBeforeTheReportIsWritten) {
    listen();
    LoneNode node("thimble-cutaneous", tables());
    ASSERT_TRUE(node.ready()) << node.words();
    ASSERT_EQ(mkfifo(node.report_file().c_str(), 0600), 0);
    PlayedSession session(node, Role::kCutaneous, Modality::kCF);
    OutboundFlow slave(Role::kSlaveSim, kSessionInstance, {node.peers().outlet(Port::kCutaneousForce)});
    const auto push = [&](SessionTime now) {
        ForceFeedback feedback;
        feedback.force_total_N = -1;
        feedback.echo_time = now;
        slave.send(now, kPlayedTrial, feedback);
    };
    ASSERT_TRUE(session.play(push, [&] { return words().ends_with("\npressed\n"); })) << words();
    node.process().signal(SIGTERM);
    EXPECT_TRUE(session.play(push, [&] { return words().ends_with("\nslack\n"); })) << words();
    ASSERT_FALSE(node.process().poll()) << node.words();
    EXPECT_FALSE(node.report().empty());
    EXPECT_EQ(node.process().wait(kPatience), 0) << node.words();
    EXPECT_THAT(end(), HasSubstr("stopped"));
}

}  // namespace
}  // namespace thimble
