#include <fstream>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "session/records/trajectory_file.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

TEST(EventFile, StandsBesideTheTrajectory) {
    EXPECT_EQ(event_path("out/trial01_HF_50ms.csv"), "out/trial01_HF_50ms.events.csv");
    EXPECT_EQ(event_path("out/trial01_HF_0.5ms.csv"), "out/trial01_HF_0.5ms.events.csv");
}

TEST(EventFile, RoundTripToTheBit) {
    const TemporaryDirectory directory;
    const std::vector<NetworkEvent> changes{{0.1 / 3, 0.5}, {12.25, 0}, {12.25, 0.05}};
    write_events(directory / "e.csv", changes);
    const auto back = read_events(directory / "e.csv");
    ASSERT_EQ(back.size(), changes.size());
    for (std::size_t i = 0; i < back.size(); ++i) {
        EXPECT_EQ(back[i].time_s, changes[i].time_s);
        EXPECT_EQ(back[i].delay_s, changes[i].delay_s);
    }
}

TEST(EventFile, AProfileComesBackWithItsNumbers) {
    const TemporaryDirectory directory;
    const NetworkEvent wifi{1.5, 0.002, "wifi", {0.001, 0.0001, 0.5}, {0.002, 0.1 / 3, 0.002}};
    // The delay alone right behind it, and at the same time: two events all the same.
    write_events(directory / "e.csv", {wifi, {1.5, 0.1}, wifi});
    const auto back = read_events(directory / "e.csv");
    ASSERT_EQ(back.size(), 3U);
    for (const std::size_t i : {0U, 2U}) {
        EXPECT_EQ(back[i].profile, "wifi");
        EXPECT_EQ(back[i].delay_s, 0.002);
        EXPECT_EQ(back[i].force.delay_s, 0.002);
        EXPECT_EQ(back[i].force.jitter_spread_s, 0.1 / 3);
        EXPECT_EQ(back[i].force.loss, 0.002);
        EXPECT_EQ(back[i].needle.delay_s, 0.001);
        EXPECT_EQ(back[i].needle.loss, 0.5);
    }
    EXPECT_EQ(back[1].profile, "");
    EXPECT_EQ(back[1].delay_s, 0.1);
}

TEST(EventFile, RefusesAProfileThatIsCutOff) {
    const TemporaryDirectory directory;
    for (const char* lines : {"1,profile,lte\n", "1,profile,lte\n1,delay_s,0.1\n",
                              "1,profile,lte\n1,delay_s,0.1\n1,delay_s,0.2\n"}) {
        std::ofstream(directory / "e.csv") << "time_s,event,value\n" << lines;
        EXPECT_THROW(read_events(directory / "e.csv"), Error) << lines;
    }
}

TEST(EventFile, RefusesWhatItDoesNotKnow) {
    const TemporaryDirectory directory;
    std::ofstream(directory / "e.csv") << "time_s,event,value\n1,earthquake,2\n";
    EXPECT_THROW(read_events(directory / "e.csv"), Error);
    EXPECT_THROW(read_events(directory / "absent.csv"), Error);
}

}  // namespace
}  // namespace thimble
