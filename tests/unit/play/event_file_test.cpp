#include "experiment/event_file.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/unit/experiment/records.hpp"

namespace thimble {
namespace {

TEST(EventFile, StandsBesideTheTrajectory) {
    EXPECT_EQ(event_path("out/trial01_HF_50ms.csv"), "out/trial01_HF_50ms.events.csv");
    EXPECT_EQ(event_path("out/trial01_HF_0.5ms.csv"), "out/trial01_HF_0.5ms.events.csv");
}

TEST(EventFile, RoundTripToTheBit) {
    const TemporaryDirectory directory;
    const std::vector<DelayChange> changes{{0.1 / 3, 0.5}, {12.25, 0}, {12.25, 0.05}};
    write_events(directory / "e.csv", changes);
    const auto back = read_events(directory / "e.csv");
    ASSERT_EQ(back.size(), changes.size());
    for (std::size_t i = 0; i < back.size(); ++i) {
        EXPECT_EQ(back[i].time_s, changes[i].time_s);
        EXPECT_EQ(back[i].delay_s, changes[i].delay_s);
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
