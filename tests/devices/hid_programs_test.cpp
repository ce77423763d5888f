// Whole sessions whose hand or fingertip device is plugged in, pulled out in mid-trial and put back.
#include <atomic>
#include <csignal>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "cutaneous_node/board/board_reports.hpp"
#include "tests/devices/mock_bed.hpp"
#include "tests/devices/mock_devices.hpp"
#include "tests/loopback/real_run.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

class HidPrograms : public OnABed<MockHid> {
  protected:
    static SessionFile session(const std::string& modality, const std::string& more) {
        SessionFile file;
        file.modalities = "[\"" + modality + "\"]";
        file.contact_hold_s = kEndlessHold_s;
        file.more = more;
        return file;
    }
    static std::string log_of(const RealRun& run, const std::string& program) {
        return read_text(run.out() / "nodes" / (program + "_0ms.log"));
    }
    std::optional<MockHid>& mock = bed_;
};

TEST_F(HidPrograms, AHandThatIsPulledOutLetsGoAndComesBack) {
    mock->plug(mock_cap());
    RealRun run(session("HF", "[handle]\ndevice = \"hid\"\n[handle.hid]\nspeed_hand_m_per_s = 0.5\n"));
    ASSERT_TRUE(run.reaches_trial()) << run.words();
    const std::vector<std::uint8_t> pushed{1, 0, 0, 0x5e, 0x01, 0, 0};
    mock->say(0, pushed);
    wall_sleep(milliseconds{100});
    mock->unplug(0);
    EXPECT_TRUE(wait_until([&] {
        return log_of(run, "thimble-master").find("is gone") != std::string::npos;
    })) << log_of(run, "thimble-master");
    mock->plug(mock_cap(2));
    EXPECT_TRUE(wait_until([&] {
        return log_of(run, "thimble-master").find("hidraw2 is in use") != std::string::npos;
    })) << log_of(run, "thimble-master");
    mock->say(2, pushed);
    const std::size_t written = run.first_trajectory().size();
    EXPECT_TRUE(wait_until([&] { return run.first_trajectory().size() > written; }));
    run.launcher().signal(SIGINT);
    EXPECT_EQ(run.end(), 1) << run.words();
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_EQ(rows[0].reason, EndReason::kInterrupted);
    const Trajectory trajectory = read_trajectory(run.trajectory_path(rows[0].conditions));
    double deepest_m = 0;
    for (const auto& sample : trajectory.samples) deepest_m = std::max(deepest_m, sample.position_needle_m);
    EXPECT_GT(deepest_m, 0.003);  // it was moved by the device
    EXPECT_EQ(run.report("thimble-master").at("hid").at("attachments"), 2);
}

// A board that answers each command, until it is pulled out.
class AnsweringBoard {
  public:
    explicit AnsweringBoard(MockHid& mock) : thread_([this, &mock] { answer(mock); }) {}
    ~AnsweringBoard() { pull_out(); }
    // Right after its last answer: a silent board is another fault.
    void pull_out() {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
    }
    std::uint16_t most_mN() const { return most_mN_; }

  private:
    void answer(MockHid& mock) {
        ask_for_realtime({});  // as the nodes: a board is never late
        while (!stop_) {
            const auto command = decode_board_command(mock.hear(1, kBoardReportBytes, milliseconds{5}));
            if (!command) continue;
            most_mN_ = std::max(most_mN_.load(), std::max(command->index_mN, command->thumb_mN));
            mock.say(1, encode(BoardStatus{command->sequence, command->press, false, BoardFault::kNone,
                                           command->index_mN, command->thumb_mN}));
        }
        mock.unplug(1);
    }
    std::atomic<bool> stop_{false};
    std::atomic<std::uint16_t> most_mN_{0};
    std::thread thread_;
};

TEST_F(HidPrograms, ABoardThatIsPulledOutEndsTheTrial) {
    mock->plug(mock_board());
    AnsweringBoard board(*mock);
    RealRun run(session("CF", "[cutaneous]\ndevice = \"board\"\n"));
    ASSERT_TRUE(run.reaches_trial()) << run.words() << log_of(run, "thimble-cutaneous");
    EXPECT_TRUE(wait_until([&] { return board.most_mN() > 0; }))
        << run.words() << log_of(run, "thimble-cutaneous");
    board.pull_out();
    EXPECT_NE(run.end(), 0) << run.words();
    EXPECT_THAT(run.words(), HasSubstr("cutaneous"));
    EXPECT_THAT(log_of(run, "thimble-cutaneous"),
                HasSubstr("Thimble board (1209:0001) at /dev/hidraw1 is gone"));
    const auto rows = run.rows();
    ASSERT_EQ(rows.size(), 1U);
    EXPECT_NE(rows[0].reason, EndReason::kCompleted);
}

}  // namespace
}  // namespace thimble
