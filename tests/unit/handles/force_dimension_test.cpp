// Force Dimension's handle through the real dlopen, with a library of our own and a script behind it.
#include <cstdlib>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "master/devices/force_dimension/force_dimension_handle.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/session_time.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using testing::HasSubstr;

class ForceDimension : public testing::Test {
  protected:
    ForceDimension() { script(""); }

    void script(const std::string& lines) {
        write_text(folder_ / "script", "log " + (folder_ / "log").string() + "\n" + lines);
        setenv("THIMBLE_FAKE_DHD", (folder_ / "script").c_str(), 1);
    }
    std::unique_ptr<ForceDimensionHandle> open() {
        return std::make_unique<ForceDimensionHandle>(settings_, 12.0, DhdLibrary(THIMBLE_FAKE_DHD_FILE));
    }
    // Why it cannot be opened.
    std::string why_not(ExitCode code = ExitCode::kUsage) {
        return refusal([&] { open(); }, code);
    }
    std::string log() const { return read_text(folder_ / "log"); }
    // Reads for so many milliseconds with this force; false from the first that is not valid.
    bool reads(ForceDimensionHandle& handle, int count, double force_hand_N = 0) {
        for (int i = 0; i < count; ++i) {
            now_ += milliseconds{1};
            if (!handle.read(now_).valid) return false;
            handle.command_force(now_, force_hand_N);
        }
        return true;
    }
    // With force, until something happens; how many reads were still good.
    int good_reads(ForceDimensionHandle& handle) {
        handle.enable_force(now_, true);
        int good = 0;
        while (good < 1000 && reads(handle, 1, 3)) ++good;
        return good;
    }

    TemporaryDirectory folder_;
    ForceDimensionSettings settings_;
    SessionTime now_ = at(milliseconds{5});
};

TEST_F(ForceDimension, IsPreparedReadAndPushed) {
    script("x -0.02\n");
    auto handle = open();
    EXPECT_EQ(handle->name(), "omega.3, serial 1001, SDK 3.17.0.0");
    EXPECT_THAT(log(), HasSubstr("max 12.000000\ngravity 1\nbrakes 0\nwatchdog 255\n"));
    const HandleSample sample = handle->read(now_);
    EXPECT_DOUBLE_EQ(sample.position_hand_m, 0.02);
    EXPECT_TRUE(sample.valid);
    handle->enable_force(now_, true);
    handle->command_force(now_, 3);
    EXPECT_THAT(log(), testing::EndsWith("enable 1\nforce 0.000 0.000 0.000\nforce 3.000 0.000 0.000\n"));
    EXPECT_EQ(handle->read(now_ += milliseconds{1}).force_hand_N, 3);
    handle->command_force(now_, 20);
    EXPECT_EQ(handle->read(now_ += milliseconds{1}).force_hand_N, 12);
    handle.reset();
    EXPECT_THAT(log(), testing::EndsWith("stop\nclose\n"));
}

TEST_F(ForceDimension, WithoutForceItIsAnEncoder) {
    auto handle = open();
    handle->enable_force(now_, false);
    EXPECT_TRUE(reads(*handle, 100, 5));
    EXPECT_EQ(handle->read(now_).force_hand_N, 0);
    EXPECT_THAT(log(), testing::Not(HasSubstr("force")));
    handle->enable_force(now_, true);
    reads(*handle, 1, 5);
    handle->enable_force(now_, false);
    EXPECT_THAT(log(),
                testing::EndsWith("force 5.000 0.000 0.000\nforce 0.000 0.000 0.000\nenable 0\nbrakes 0\n"));
}

TEST_F(ForceDimension, AVirtualConstraintHoldsTheOtherAxes) {
    script("moved_after 50\n");
    settings_.axis.lateral = LateralHold::kVirtual;
    settings_.axis.lateral_damping_Ns_per_m = 0;
    auto handle = open();
    handle->enable_force(now_, true);
    EXPECT_TRUE(reads(*handle, 100, 2));
    EXPECT_THAT(log(), testing::EndsWith("force 2.000 0.000 0.000\nforce 2.000 -1.000 0.000\n"));
}

TEST_F(ForceDimension, TheVelocityOfTheSdkAgreesWithOurs) {
    script("press 0.03\n");
    auto handle = open();
    EXPECT_TRUE(reads(*handle, 1000));
    EXPECT_GT(handle->velocity_difference_m_per_s(), 0);
    EXPECT_LT(handle->velocity_difference_m_per_s(), 0.005);  // of 0.047 m/s at most
}

TEST_F(ForceDimension, SaturationIsCountedAndGoesOn) {
    script("saturated_after 10\n");
    auto handle = open();
    handle->enable_force(now_, true);
    EXPECT_TRUE(reads(*handle, 30, 3));
    EXPECT_GE(handle->saturated(), 15U);
    nlohmann::ordered_json report;
    handle->describe(report);
    EXPECT_EQ(report["handle"]["saturated"], handle->saturated());
}

struct Fault {
    const char* name;
    const char* script;
    int good_reads_at_most;
    const char* words;
};
std::ostream& operator<<(std::ostream& out, const Fault& fault) { return out << fault.name; }

class ForceDimensionFault : public ForceDimension, public testing::WithParamInterface<Fault> {};

// Two ticks for what every call tells, the status' period for what it tells, 20 ms for a clock that stands.
TEST_P(ForceDimensionFault, TakesTheForceAwayAndSaysWhy) {
    script(GetParam().script);
    auto handle = open();
    EXPECT_LE(good_reads(*handle), GetParam().good_reads_at_most);
    EXPECT_THAT(std::string(handle->fault()), testing::StartsWith("omega.3, serial 1001"));
    EXPECT_THAT(std::string(handle->fault()), HasSubstr(GetParam().words));
    EXPECT_LT(handle->fault().size(), DeviceFault{}.text.size());
    EXPECT_EQ(handle->read(now_).force_hand_N, 0);
    EXPECT_FALSE(handle->read(now_).valid);
    EXPECT_THAT(log(), testing::EndsWith("stop\n"));
    const std::string before = log();
    handle->enable_force(now_, true);  // nor does the next trial bring it back
    handle->command_force(now_, 5);
    EXPECT_EQ(log(), before);
}

INSTANTIATE_TEST_SUITE_P(Each, ForceDimensionFault,
                         testing::Values(Fault{"Unplugged", "unplugged_after 30\n", 30,
                                               "communication error"},
                                         Fault{"Stalled", "stalled_after 30\n", 51, "its clock has stopped"},
                                         Fault{"Garbled", "garbled_after 30\n", 30, "impossible position"},
                                         Fault{"Uncalibrated", "uncalibrated_after 30\n", 40,
                                               "hold the handle in its rest position"},
                                         Fault{"MotorsOff", "motors_off_after 30\n", 40,
                                               "its watchdog fired: this program called too rarely"}),
                         [](const auto& fault) { return std::string(fault.param.name); });

TEST_F(ForceDimension, AClockThatStandsStillCostsTheForceInTwoTicks) {
    script("stalled_after 30\n");
    auto handle = open();
    handle->enable_force(now_, true);  // the first position
    EXPECT_TRUE(reads(*handle, 29, 3));
    EXPECT_EQ(handle->read(now_ += milliseconds{1}).force_hand_N, 3);
    const HandleSample second = handle->read(now_ += milliseconds{1});
    EXPECT_TRUE(second.valid);
    EXPECT_EQ(second.force_hand_N, 0);
    EXPECT_THAT(log(), testing::EndsWith("force 3.000 0.000 0.000\nforce 0.000 0.000 0.000\n"));
}

TEST_F(ForceDimension, SaysWhichDeviceItCannotHave) {
    script("devices 0\n");
    EXPECT_THAT(why_not(), HasSubstr("no Force Dimension handle found"));
    script("devices 2\n");
    EXPECT_THAT(why_not(), HasSubstr("name one in [handle.force_dimension] serial"));
    settings_.serial = 1002;
    EXPECT_EQ(open()->name(), "omega.3, serial 1002, SDK 3.17.0.0");
    settings_.serial = 7;
    EXPECT_THAT(why_not(), HasSubstr("serial 7: number 0 has serial 1001; number 1 has serial 1002"));
    settings_.serial = 0;
    script("in_use 1\n");
    EXPECT_THAT(why_not(), HasSubstr("device already in use (error 20)"));
    script("type 60\n");
    EXPECT_THAT(why_not(), HasSubstr("use device = \"falcon\" for a Falcon"));
    script("uncalibrated 1\n");
    EXPECT_THAT(why_not(ExitCode::kRunFailed), HasSubstr("it is not calibrated"));
    script("power 0\n");
    EXPECT_THAT(why_not(ExitCode::kRunFailed), HasSubstr("switch it on"));
    script("no_watchdog 1\n");
    EXPECT_THAT(why_not(ExitCode::kRunFailed), HasSubstr("watchdog = false"));
    settings_.watchdog = false;
    EXPECT_NO_THROW(open());
}

std::string library_refusal(const std::string& file) {
    return refusal([&] { const DhdLibrary library(file); }, ExitCode::kUsage);
}

TEST_F(ForceDimension, SaysWhichLibraryItLacks) {
    EXPECT_THAT(library_refusal("/nowhere/libdhd.so.3"),
                HasSubstr("/nowhere/libdhd.so.3: cannot open shared object"));
    EXPECT_THAT(library_refusal("/nowhere/libdhd.so.3"), HasSubstr("[handle.force_dimension] library"));
    EXPECT_THAT(library_refusal(THIMBLE_NO_DHD_FILE), HasSubstr("has no function dhdOpenID"));
    write_text(folder_ / "libdhd.so.3.17.0", "no library");
    const std::string link = (folder_ / "libdhd.so.3").string();
    EXPECT_THAT(library_refusal(link),
                HasSubstr("The link is missing: run `sudo ln -s libdhd.so.3.17.0 " + link));
}

TEST_F(ForceDimension, AButtonThatTheFileNamesIsAnEmergencyStop) {
    script("pressed_after 10\n");
    const auto deaf = open();
    EXPECT_TRUE(reads(*deaf, 20));
    EXPECT_FALSE(deaf->take_stop(now_)) << "no button is named";
    settings_.stop_button = 0;
    const auto handle = open();
    EXPECT_TRUE(reads(*handle, 5));
    EXPECT_FALSE(handle->take_stop(now_));
    EXPECT_TRUE(reads(*handle, 6));
    EXPECT_TRUE(handle->take_stop(now_));
    settings_.stop_button = 3;
    EXPECT_THAT(why_not(), HasSubstr("stop_button names button 3, which"));
}

TEST_F(ForceDimension, NamesTheFoldersItLookedInInVain) {
    setenv("FDSDK", folder_.path().c_str(), 1);
    const std::string words = library_refusal("");
    unsetenv("FDSDK");
    if (words == "nothing was refused") GTEST_SKIP() << "the real library is installed here";
    EXPECT_THAT(words, HasSubstr(folder_.path().string() + "/lib/release/lin-"));
    EXPECT_THAT(words, HasSubstr("-gcc: neither libdrd.so.* nor libdhd.so.*"));
    EXPECT_THAT(words, HasSubstr("libdhd.so.3: cannot open shared object file"));
}

TEST_F(ForceDimension, LooksWhereTheSdkLiesNewestFirst) {
    const fs::path lib = folder_ / "lib";
    fs::create_directories(lib);
    for (const char* name : {"libdhd.so.3.9.1", "libdhd.so.3.17.0", "libdrd.so.3.9.1", "libother.so.3"})
        write_text(lib / name, "");
    std::vector<std::string> names;
    for (const fs::path& file : dhd_files_in(lib)) names.push_back(file.filename().string());
    EXPECT_THAT(names, testing::ElementsAre("libdrd.so.3.9.1", "libdhd.so.3.17.0", "libdhd.so.3.9.1"));
    setenv("FORCEDIMENSION_LIB", THIMBLE_FAKE_DHD_FILE, 1);
    EXPECT_EQ(DhdLibrary("").file(), THIMBLE_FAKE_DHD_FILE);
    unsetenv("FORCEDIMENSION_LIB");
}

}  // namespace
}  // namespace thimble
