#include "session/records/trajectory_file.hpp"

#include <filesystem>
#include <functional>
#include <iterator>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/full_disk.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

TEST(TrajectoryFile, RoundTripToTheBit) {
    const TemporaryDirectory directory;
    const TrialRecord record = sine_record(0.1 / 3, 0.003, 4);
    TrajectoryWriter writer(directory / "t.csv");
    writer.append(record.samples);
    writer.end(EndReason::kPeerLost, Role::kVisual);

    const Trajectory back = read_trajectory(directory / "t.csv");
    EXPECT_EQ(back.reason, EndReason::kPeerLost);
    EXPECT_EQ(back.lost_peer, Role::kVisual);
    ASSERT_EQ(back.samples.size(), record.samples.size());
    for (std::size_t i = 0; i < back.samples.size(); ++i) {
        ASSERT_EQ(back.samples[i].time_s, record.samples[i].time_s);
        ASSERT_EQ(back.samples[i].position_needle_m, record.samples[i].position_needle_m);
        ASSERT_EQ(back.samples[i].position_surface_m, record.samples[i].position_surface_m);
        ASSERT_EQ(back.samples[i].phase, record.samples[i].phase);
    }
    EXPECT_TRUE(read_text(directory / "t.csv").ends_with("\n# ended: peer_lost_visual\n"));
}

TEST(TrajectoryFile, EveryColumnIsItsOwn) {
    const TemporaryDirectory directory;
    TrajectoryWriter writer(directory / "t.csv");
    writer.append(TrajectorySample{1, 2, 3, 4, 5, 6, 7, TissuePhase::kContact, false});
    writer.end(EndReason::kTimeout);
    EXPECT_EQ(read_text(directory / "t.csv"),
              "time_s,position_needle_m,position_surface_m,force_tissue_N,force_fixture_N,force_total_N,"
              "contact_time_s,tissue_phase,fixture_present\n1,2,3,4,5,6,7,contact,0\n# ended: timeout\n");
    const TrajectorySample sample = read_trajectory(directory / "t.csv").samples.at(0);
    EXPECT_EQ(sample.force_tissue_N, 4);
    EXPECT_EQ(sample.force_fixture_N, 5);
    EXPECT_EQ(sample.force_total_N, 6);
    EXPECT_EQ(sample.contact_time_s, 7);
    EXPECT_FALSE(sample.fixture_present);
}

TEST(TrajectoryFile, FlushMakesSamplesVisibleAndAFileWithoutEndIsTold) {
    const TemporaryDirectory directory;
    TrajectoryWriter writer(directory / "t.csv");
    writer.append(TrajectorySample{});
    writer.flush();
    const Trajectory trajectory = read_trajectory(directory / "t.csv");
    EXPECT_EQ(trajectory.samples.size(), 1U);
    EXPECT_EQ(trajectory.reason, EndReason::kNone);
}

bool fails_to(const std::function<void()>& write) {
    return refusal(write, ExitCode::kRunFailed) != "nothing was refused";
}

// The file's text, if the disk has `room_bytes` until the trial ends and enough room after that.
std::string with_room(std::size_t samples, rlim_t room_bytes, bool fails) {
    const TemporaryDirectory directory;
    {
        TrajectoryWriter writer(directory / "t.csv");
        {
            const FullDisk disk(room_bytes);
            TrajectorySample sample;
            for (std::size_t i = 0; i < samples; ++i) {
                sample.time_s = 1e-3 * static_cast<double>(i);
                fails_to([&] { writer.append(sample); });
            }
            EXPECT_EQ(fails_to([&] { writer.flush(); }), fails);
        }
        EXPECT_EQ(fails_to([&] { writer.end(EndReason::kCompleted); }), fails);
    }
    return read_text(directory / "t.csv");
}

// No sample stands there twice, and no end behind a gap.
TEST(TrajectoryFile, WhatAFullDiskCutOffIsNotWrittenAgain) {
    for (const std::size_t samples : {std::size_t{50}, std::size_t{6000}}) {
        const std::string whole = with_room(samples, 1'000'000'000, false);
        for (const rlim_t room_bytes : {rlim_t{0}, rlim_t{700}, rlim_t{5000}, rlim_t{70'000}}) {
            if (room_bytes > whole.size()) continue;
            const std::string cut = with_room(samples, room_bytes, true);
            EXPECT_LT(cut.size(), whole.size());
            EXPECT_TRUE(whole.starts_with(cut)) << samples << " in " << room_bytes;
        }
    }
}

TEST(TrajectoryFile, DamageIsNamedWithLineAndColumn) {
    const TemporaryDirectory directory;
    const auto path = directory / "t.csv";
    {
        TrajectoryWriter writer(path);
        writer.append(TrajectorySample{});
        writer.end(EndReason::kCompleted);
    }
    const std::string good = read_text(path);
    std::string phase = good;
    phase.replace(phase.find("free"), 4, "tree");
    EXPECT_NO_THROW(read_trajectory(path));
    for (const auto& [text, complaint] : {std::pair{good + "0,0,0,0,0,0,0,free,1\n", ":4: column 1"},
                                          std::pair{good + "0,0\n", ":4: has 2 fields"},
                                          std::pair{phase, ":2: column 8 (tissue_phase): 'tree'"},
                                          std::pair{good + "# ended: maybe\n", "ended: maybe"}}) {
        write_text(path, text);
        EXPECT_THAT(refusal([&] { read_trajectory(path); }), testing::HasSubstr(complaint));
    }
}

TEST(TrajectoryFile, RefusesToOverwrite) {
    const TemporaryDirectory directory;
    TrajectoryWriter(directory / "t.csv").end(EndReason::kCompleted);
    EXPECT_THROW(TrajectoryWriter(directory / "t.csv"), Error);
    EXPECT_NO_THROW(TrajectoryWriter(directory / "t.csv", IfExists::kReplace));
}

TEST(TrajectoryFile, RemovesThoseOfRunsAndStudiesAlone) {
    const TemporaryDirectory directory;
    for (const char* name : {"trial01_HF_50ms.csv", "trial01_HF_50ms.events.csv",
                             "experiment3_subject01_trial01_HF_50ms.csv", "trials.csv", "trial01.txt"})
        write_text(directory / name, "");
    remove_trajectories(directory.path());
    remove_trajectories(directory / "absent");
    using Files = std::filesystem::directory_iterator;
    EXPECT_EQ(std::distance(Files(directory.path()), Files()), 2);
    EXPECT_TRUE(std::filesystem::exists(directory / "trials.csv"));
}

TEST(EventFile, StandsBesideTheTrajectory) {
    EXPECT_EQ(event_path("out/trial01_HF_50ms.csv"), "out/trial01_HF_50ms.events.csv");
    EXPECT_EQ(event_path("out/trial01_HF_0.5ms.csv"), "out/trial01_HF_0.5ms.events.csv");
}

TEST(EventFile, AProfileComesBackWithItsNumbers) {
    const TemporaryDirectory directory;
    const NetworkEvent wifi{1.5, 0.002, "wifi", {0.001, 0.0001, 0.5}, {0.002, 0.1 / 3, 0.002}};
    // The delay alone right behind it, and at the same time: still two events.
    const std::vector<NetworkEvent> events{wifi, {1.5, 0.1}, wifi, {0.1 / 3, 0}, {12.25, 0}, {12.25, 0.05}};
    write_events(directory / "e.csv", events);
    const auto back = read_events(directory / "e.csv");
    ASSERT_EQ(back.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
        SCOPED_TRACE(i);
        EXPECT_EQ(back[i].time_s, events[i].time_s);
        EXPECT_EQ(back[i].profile, events[i].profile);
        EXPECT_EQ(back[i].delay_s, events[i].delay_s);
        EXPECT_EQ(back[i].force.delay_s, events[i].force.delay_s);
        EXPECT_EQ(back[i].force.jitter_spread_s, events[i].force.jitter_spread_s);
        EXPECT_EQ(back[i].force.loss, events[i].force.loss);
        EXPECT_EQ(back[i].needle.delay_s, events[i].needle.delay_s);
        EXPECT_EQ(back[i].needle.loss, events[i].needle.loss);
    }
}

TEST(EventFile, RefusesAProfileThatIsCutOffAndWhatItDoesNotKnow) {
    const TemporaryDirectory directory;
    for (const char* lines : {"1,profile,lte\n", "1,profile,lte\n1,delay_s,0.1\n",
                              "1,profile,lte\n1,delay_s,0.1\n1,delay_s,0.2\n", "1,earthquake,2\n"}) {
        write_text(directory / "e.csv", std::string("time_s,event,value\n") + lines);
        EXPECT_THROW(read_events(directory / "e.csv"), Error) << lines;
    }
    EXPECT_THROW(read_events(directory / "absent.csv"), Error);
}

}  // namespace
}  // namespace thimble
