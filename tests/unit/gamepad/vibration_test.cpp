// Gamepads that cannot vibrate. One that can is a real device of a kernel's: tests/kernel/jobs/rumble.

#include "visual_node/gamepad/vibration.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/refusal.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

// A folder that looks like /sys/class/input.
struct FakeInputClasses {
    // `effects`: as the kernel writes which force feedback there is.
    void add(const std::string& entry, const JoystickIdentity& identity, const std::string& effects) const {
        const auto device = folder / entry / "device";
        std::filesystem::create_directories(device / "capabilities");
        std::filesystem::create_directories(device / "id");
        write_text(device / "name", identity.name + '\n');
        write_text(device / "id" / "vendor", fmt::format("{:04x}\n", identity.vendor));
        write_text(device / "id" / "product", fmt::format("{:04x}\n", identity.product));
        write_text(device / "capabilities" / "ff", effects + '\n');
    }
    const TemporaryDirectory folder;
};

TEST(Vibration, WithoutAGamepadThereIsNothingToSay) {
    const FakeInputClasses classes;
    Vibration vibration("", classes.folder.path());
    vibration.plugged({});
    vibration.feel(at(std::chrono::seconds{1}), 4, 4);
    vibration.stop();
    EXPECT_FALSE(vibration.ready());
    EXPECT_EQ(vibration.notice(), "");
}

TEST(Vibration, AGamepadWithoutMotorsIsNamed) {
    const FakeInputClasses classes;
    classes.add("event3", {"Old pad", 1, 2}, "0");
    Vibration vibration("", classes.folder.path());
    vibration.plugged({"Old pad", 1, 2});
    EXPECT_FALSE(vibration.ready());
    EXPECT_NE(vibration.notice().find("no motors in 'Old pad'"), std::string::npos) << vibration.notice();
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

TEST(EventDevice, IdentityIsReadFromTheGuidOfGlfw) {
    // Bus 3 (USB), vendor 045e, product 028e, version 0114.
    const JoystickIdentity pad = identity_of("Xbox 360", "030000005e0400008e02000014010000");
    EXPECT_EQ(pad.name, "Xbox 360");
    EXPECT_EQ(pad.vendor, 0x045e);
    EXPECT_EQ(pad.product, 0x028e);
    for (const char* other : {"", "0300", "05000000576972656c65737320436f6e",  // a name instead of numbers
                              "zz0000005e0400008e0200001401000", "030000005e04zz008e02000014010000"}) {
        EXPECT_EQ(identity_of("pad", other), (JoystickIdentity{"pad"})) << other;
    }
}

TEST(EventDevice, NameAndIdentityAndMotorsDecide) {
    const FakeInputClasses classes;
    classes.add("event3", {"Pad", 0x045e, 0x028e}, "0");                   // no motors
    classes.add("event4", {"Pad", 0x045e, 0x1111}, "107030000 0");         // another make
    classes.add("event5", {"Pad Consumer Control", 0x045e, 0x028e}, "1");  // another part of it
    classes.add("event7", {"Pad", 0x045e, 0x028e}, "107030000 0");
    classes.add("js0", {"Pad", 0x045e, 0x028e}, "107030000 0");
    const auto find = [&](const JoystickIdentity& joystick) {
        return find_event_device(classes.folder.path(), joystick);
    };
    EXPECT_EQ(find({"Pad", 0x045e, 0x028e}), "/dev/input/event7");
    EXPECT_EQ(find({"Pad"}), "/dev/input/event4");  // its name is all that is known
    EXPECT_EQ(find({"Pad", 0x045e, 0x9999}), std::nullopt);
    EXPECT_EQ(find({"Stick"}), std::nullopt);
    EXPECT_EQ(find_event_device(classes.folder / "absent", {"Pad"}), std::nullopt);
}

}  // namespace
}  // namespace thimble
