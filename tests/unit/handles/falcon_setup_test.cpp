// Setting up a Falcon: what is running, what is loaded, and what is refused with which words.
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/devices/falcon/falcon_link.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/handles/falcon_emulator.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

class FalconSetup : public testing::Test {
  protected:
    FalconSetup() {
        std::iota(image.begin(), image.end(), std::uint8_t{0});
        device.image_bytes = image.size();
    }
    std::string why_not() {
        return refusal([&] { load_falcon_firmware(link, image); }, ExitCode::kRunFailed);
    }
    std::vector<std::uint8_t> image = std::vector<std::uint8_t>(1000);
    FalconEmulator device;
    EmulatedFalconLink link{device};
};

TEST_F(FalconSetup, ARunningFirmwareAnswers) {
    ASSERT_TRUE(set_falcon_running(link));
    EXPECT_FALSE(falcon_answers(link));
    device.running = true;
    EXPECT_TRUE(falcon_answers(link));
    EXPECT_EQ(device.commanded.motors, FalconTriple{});
    EXPECT_TRUE(device.commanded.homing);
}

TEST_F(FalconSetup, LoadsWhatItIsGiven) {
    load_falcon_firmware(link, image);
    EXPECT_EQ(device.loaded, image);
    EXPECT_TRUE(falcon_answers(link));
}

TEST_F(FalconSetup, AGreetingAfterAZeroOrAfterPiecesOfOthersIsUnderstood) {
    device.zero_before_greeting = true;
    EXPECT_NO_THROW(load_falcon_firmware(link, image));
    EXPECT_EQ(device.loaded, image);
    device.greetings_cut_short = 3;
    EXPECT_NO_THROW(load_falcon_firmware(link, image));
    device.zero_before_greeting = false;
    device.greetings_cut_short = 3;
    EXPECT_NO_THROW(load_falcon_firmware(link, image));
}

TEST_F(FalconSetup, AWrongEchoMeansOnceMore) {
    device.wrong_echo_at = 500;
    load_falcon_firmware(link, image);
    EXPECT_EQ(device.loaded, image);
}

TEST_F(FalconSetup, SaysWhichStepFailed) {
    device.image_bytes = image.size() + 1000;  // wants more than the file has
    EXPECT_THAT(why_not(), HasSubstr("the first report of the loaded firmware failed 3 times"));
    device.deaf_loader = true;
    EXPECT_THAT(why_not(), HasSubstr("its boot loader's greeting failed"));
    device.unplugged = true;
    EXPECT_THAT(why_not(), HasSubstr("no such device"));
}

TEST(FalconFirmware, IsTheFileThatWasMeant) {
    const TemporaryDirectory folder;
    const std::string name = folder / "firmware";
    const auto why_not = [&name](const std::string& sum) {
        return refusal([&] { read_falcon_firmware(name, sum); }, ExitCode::kUsage);
    };
    EXPECT_THAT(why_not("x"), HasSubstr("No such file"));
    write_text(name, "");
    EXPECT_THAT(why_not("x"), HasSubstr("it is empty"));
    for (const std::string& other : {folder.path().string(), std::string("/dev/zero")})
        EXPECT_THAT(refusal([&] { read_falcon_firmware(other, "x"); }, ExitCode::kUsage),
                    HasSubstr("cannot read the Falcon's firmware '" + other));
    write_text(name, "abc");
    // FIPS 180-2's own example.
    const std::string sum = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    EXPECT_EQ(read_falcon_firmware(name, sum).size(), 3U);
    const std::string other(64, '0');
    EXPECT_THAT(why_not(other),
                testing::AllOf(HasSubstr("its SHA-256 is " + sum), HasSubstr("firmware_sha256 is " + other)));
}

}  // namespace
}  // namespace thimble
