// 3D Systems' Touch through the real dlopen, with a library of our own whose scheduler is a real thread.
#include "master/devices/touch/touch_handle.hpp"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/messages.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/handles/live_handle.hpp"

namespace thimble {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

class Touch : public testing::Test {
  protected:
    Touch() {
        settings_.library = THIMBLE_FAKE_HD_FILE;
        script("");
    }
    void script(const std::string& lines) {
        std::string all = lines;
        for (const char* name : {"log", "go", "button_file", "in_well", "fault"})
            all += std::string(name) + ' ' + (folder_ / name).string() + '\n';
        write_text(folder_ / "script", all);
        setenv("THIMBLE_FAKE_HD", (folder_ / "script").c_str(), 1);
    }
    std::unique_ptr<Handle> open(double force_limit_N = kTouchForce_N) {
        return open_touch(settings_, force_limit_N);
    }
    std::string why_not() {
        return refusal([&] { open(); }, ExitCode::kUsage);
    }
    std::string log() const { return read_text(folder_ / "log"); }
    bool logs(const std::string& words) const { return log().find(words) != std::string::npos; }

    TemporaryDirectory folder_;
    TouchSettings settings_;
};

TEST_F(Touch, IsReadAndPushedAndEndsWithoutForce) {
    script("z 0.01\n");
    LiveHandle handle(open(12));
    EXPECT_EQ(handle->name(), "Touch, serial T1");
    handle.begin();
    EXPECT_TRUE(handle.push(2, [&] { return logs("force 0.00 0.00 2.00"); })) << log();
    EXPECT_NEAR(handle.sample.position_hand_m, -0.01, 1e-6);
    EXPECT_TRUE(handle.push(50, [&] { return logs("force 0.00 0.00 3.30"); })) << "no more than it bears";
    EXPECT_TRUE(handle.push(50, [&] { return handle.sample.force_hand_N != 2; }));
    EXPECT_NEAR(handle.sample.force_hand_N, 3.3, 1e-9);
    handle.reset();
    EXPECT_THAT(log(), EndsWith("force 0.00 0.00 0.00\nstop\ndisable\ndisable device\n"));
}

// The line is x, through 0 because no position was read before: the hand is 10 mm beside it, and 4 N would draw it back.
TEST_F(Touch, TheForceAlongTheAxisComesBeforeThatBesideIt) {
    script("z 0.01\n");
    settings_.axis.axis = 0;
    settings_.axis.lateral = LateralHold::kVirtual;
    LiveHandle handle(open());
    handle.begin();
    EXPECT_TRUE(handle.push(2, [&] { return logs("force 2.00 0.00 -2.62"); })) << log();
    EXPECT_TRUE(handle.push(50, [&] { return logs("force 3.30 0.00 "); })) << log();
}

TEST_F(Touch, AMasterThatHangsCostsTheForce) {
    LiveHandle handle(open());
    handle.begin();
    EXPECT_TRUE(handle.push(2, [&] { return logs(" 2.00\n"); }));
    const SessionTime end = wall_now() + std::chrono::seconds{60};
    while (log().substr(log().rfind("force")) != "force 0.00 0.00 0.00\n" && wall_now() < end)
        wall_sleep(std::chrono::milliseconds{1});
    EXPECT_THAT(log(), EndsWith("force 0.00 0.00 0.00\n"));
}

TEST_F(Touch, AnErrorThatPassesCostsTheForceForAWhile) {
    script("mode fast\n");
    LiveHandle handle(open());
    handle.begin();
    EXPECT_TRUE(handle.push(2, [&] { return logs(" 2.00\n"); })) << log();
    write_text(folder_ / "fault", "");
    EXPECT_TRUE(handle.push(2, [&] { return handle.sample.force_hand_N == 0; }));
    EXPECT_TRUE(handle.push(2, [&] { return logs(" 2.00\nforce 0.00 0.00 0.00\nforce 0.00 0.00 2.00\n"); }))
        << log();
    EXPECT_EQ(handle->fault(), "");
}

struct TouchFault {
    const char* name;
    const char* mode;
    const char* says;
};
std::ostream& operator<<(std::ostream& out, const TouchFault& fault) { return out << fault.name; }
class TouchFaults : public Touch, public testing::WithParamInterface<TouchFault> {};

TEST_P(TouchFaults, TakesTheForceAwayAndSaysWhy) {
    script(std::string("mode ") + GetParam().mode + '\n');
    LiveHandle handle(open());
    handle.begin();
    EXPECT_TRUE(handle.push(2, [&] { return logs(" 2.00\n"); })) << log();
    write_text(folder_ / "fault", "");
    EXPECT_TRUE(handle.ends(2));
    EXPECT_THAT(std::string(handle->fault()), HasSubstr("Touch, serial T1"));
    EXPECT_THAT(std::string(handle->fault()), HasSubstr(GetParam().says));
    EXPECT_LT(handle->fault().size(), DeviceFault{}.text.size());
    EXPECT_EQ(handle->read(wall_now()).force_hand_N, 0);
    EXPECT_FALSE(handle->read(wall_now()).valid);
    handle.reset();
    EXPECT_THAT(log(), HasSubstr("disable\ndisable device\n"));
}

INSTANTIATE_TEST_SUITE_P(Each, TouchFaults,
                         testing::Values(TouchFault{"Unplugged", "unplugged",
                                                    "Device communication error (error 0x0302)"},
                                         TouchFault{"Warm", "warm", "Motors are too warm (error 0x0200)"},
                                         TouchFault{"Garbled", "garbled", "no usable position"},
                                         TouchFault{"Stalled", "stalled", "no usable position"}),
                         [](const auto& fault) { return std::string(fault.param.name); });

TEST_F(Touch, TheUserPutsTheStylusIntoItsWell) {
    script("uncalibrated 1\n");
    LiveHandle handle(open());
    EXPECT_THAT(handle->awaits(), HasSubstr("put the stylus into its holder"));
    write_text(folder_ / "in_well", "");
    handle.begin();
    EXPECT_THAT(log(), HasSubstr("calibrate 4\n"));
    EXPECT_TRUE(handle.push(0, [&] { return handle.sample.valid; }));
}

TEST_F(Touch, AButtonOfTheStylusIsAnEmergencyStop) {
    LiveHandle handle(open());
    handle.begin();
    EXPECT_FALSE(handle->take_stop(wall_now()));
    write_text(folder_ / "button_file", "");
    EXPECT_TRUE(handle.push(0, [&] { return handle->take_stop(wall_now()); }));
    handle.reset();
    settings_.stop_button = 0;
    LiveHandle deaf(open());
    deaf.begin();
    EXPECT_TRUE(deaf.push(0, [&] { return deaf.sample.valid; }));
    EXPECT_FALSE(deaf->take_stop(wall_now()));
}

TEST_F(Touch, SaysWhatItCannotHave) {
    script("devices 0\n");
    EXPECT_THAT(why_not(), HasSubstr("cannot open a device: Device communication error (error 0x0302)"));
    EXPECT_THAT(why_not(), HasSubstr("Touch_Setup"));
    settings_.name = "Left";
    EXPECT_THAT(why_not(), HasSubstr("cannot open device 'Left'"));
    script("");
    open();
    EXPECT_THAT(log(), HasSubstr("init Left\n"));
    settings_.library = THIMBLE_NO_DHD_FILE;
    EXPECT_THAT(why_not(), HasSubstr("has no function hdInitDevice: it is not libHD of OpenHaptics"));
    settings_.library = "/nowhere/libHD.so";
    EXPECT_THAT(why_not(), HasSubstr("/nowhere/libHD.so: cannot open shared object"));
    EXPECT_THAT(why_not(), HasSubstr("[handle.touch] library"));
    setenv("OPENHAPTICS_LIB", THIMBLE_FAKE_HD_FILE, 1);
    EXPECT_EQ(HdLibrary("").file(), THIMBLE_FAKE_HD_FILE);
    unsetenv("OPENHAPTICS_LIB");
}

}  // namespace
}  // namespace thimble
