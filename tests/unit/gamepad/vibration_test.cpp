// Gamepads that cannot vibrate. One that can is a real device of a kernel's: tests/kernel/jobs/rumble.
#include "visual_node/gamepad/vibration.hpp"

#include <gtest/gtest.h>

#include "tests/unit/gamepad/fake_input_classes.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

TEST(Vibration, WithoutAGamepadThereIsNothingToSay) {
    const FakeInputClasses classes;
    Vibration vibration("", classes.folder());
    vibration.plugged({});
    vibration.feel(at(std::chrono::seconds{1}), 4, 4);
    vibration.stop();
    EXPECT_FALSE(vibration.ready());
    EXPECT_EQ(vibration.notice(), "");
}

TEST(Vibration, AGamepadWithoutMotorsIsNamed) {
    const FakeInputClasses classes;
    classes.add("event3", {"Old pad", 1, 2}, "0");
    Vibration vibration("", classes.folder());
    vibration.plugged({"Old pad", 1, 2});
    EXPECT_FALSE(vibration.ready());
    EXPECT_NE(vibration.notice().find("'Old pad' has no motors"), std::string::npos) << vibration.notice();
}

TEST(Vibration, ADeviceThatIsNotThereOrIsNoneIsNamedAndHarmless) {
    for (const char* path : {"/dev/input/event999", "/dev/null"}) {
        Vibration vibration(path);
        EXPECT_FALSE(vibration.ready());
        EXPECT_NE(vibration.notice().find(path), std::string::npos) << vibration.notice();
        vibration.plugged({"pad"});
        vibration.feel(at(std::chrono::seconds{1}), 4, 4);
        vibration.plugged({});
        EXPECT_FALSE(vibration.ready());
    }
}

TEST(RumbleDevice, IsHarmlessWhereThereIsNone) {
    RumbleDevice none("/dev/null");
    EXPECT_FALSE(none.ready());
    none.set({1, 2});
    none.set({});
    EXPECT_NE(none.notice().find("no motors"), std::string::npos);
}

}  // namespace
}  // namespace thimble
