// Setting up a Falcon: what is running, what is loaded, and what is refused with which words.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "master/devices/falcon/falcon_link.hpp"
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
    std::string loading() {
        try {
            load_falcon_firmware(link, image);
        } catch (const Error& error) {
            return error.what();
        }
        return "loaded";
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
    EXPECT_EQ(loading(), "loaded");
    EXPECT_EQ(device.loaded, image);
    EXPECT_TRUE(falcon_answers(link));
}

TEST_F(FalconSetup, AWrongEchoMeansOnceMore) {
    device.wrong_echo_at = 500;
    EXPECT_EQ(loading(), "loaded");
    EXPECT_EQ(device.loaded, image);
}

TEST_F(FalconSetup, SaysWhichStepFailed) {
    device.image_bytes = image.size() + 1000;  // wants more than the file has
    EXPECT_THAT(loading(), HasSubstr("the first report of what was loaded failed 3 times"));
    device.deaf_loader = true;
    EXPECT_THAT(loading(), HasSubstr("its boot loader's greeting failed"));
    device.unplugged = true;
    EXPECT_THAT(loading(), HasSubstr("no such device"));
}

TEST(FalconFirmware, IsTheFileThatWasMeant) {
    std::string name = (std::filesystem::temp_directory_path() / "thimble-firmware-XXXXXX").string();
    close(::mkstemp(name.data()));
    const auto reading = [&name](const std::string& sum) -> std::string {
        try {
            return std::to_string(read_falcon_firmware(name, sum).size());
        } catch (const Error& error) {
            return error.what();
        }
    };
    EXPECT_THAT(reading("x"), HasSubstr("it is empty"));
    std::ofstream(name) << "abc";
    // FIPS 180-2's own example.
    const std::string sum = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    EXPECT_EQ(reading(sum), "3");
    const std::string other(64, '0');
    EXPECT_THAT(reading(other), testing::AllOf(HasSubstr("its SHA-256 is " + sum),
                                               HasSubstr("firmware_sha256 says " + other)));
    std::filesystem::remove(name);
    EXPECT_THAT(reading(sum), HasSubstr("No such file"));
}

}  // namespace
}  // namespace thimble
