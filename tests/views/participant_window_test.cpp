// A person's session with the mouse alone, as one person meets it: pages, a key, a needle; a power cut in between.
#include <csignal>
#include <cstdlib>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "session/participant/dataset.hpp"
#include "session/participant/record_table.hpp"
#include "tests/views/pushed_needle.hpp"

namespace thimble {
namespace {

constexpr const char* kMouseSession =
    "[session]\nsubject = 'human'\nparticipant = 'P07'\nmodalities = ['CF']\nfixture_jitter_m = 0\n"
    "[handle]\ndevice = 'pointer'\n"
    "[visual]\npointer_m_per_count = 5e-4\nsound = false\nfingertip = true\n"
    "[fixture]\nposition_m = 0.03\n[trial]\ncontact_hold_s = 0.02\n"
    "[protocol]\nexperiments = [1]\ntrials_per_modality = 1\npractice_trials = 1\nbreak_every = 0\n"
    "next_by = 'subject'\n"
    "[instructions]\nready_title = 'Bereit?'\nready = 'Versuch {trial} von {trials}'\n";

class SessionWithAMouse : public OnAScreen {
  protected:
    // Where nobody types.
    Child start(const std::string& more = "") const {
        const std::string command = "exec " THIMBLE_BIN_DIR "/thimble run " +
                                    folder_.write("session.toml", kMouseSession).string() + " --out " +
                                    dataset_.folder().string() + " --base-port " +
                                    std::to_string(ports_.base()) + " --consent " + more + " </dev/null";
        return {"/bin/sh", {"-c", command}, folder_ / "words"};
    }
    std::string words() const { return read_text(folder_ / "words"); }
    std::vector<DatasetRecord> records() const { return read_records(dataset_.records(7)); }
    std::filesystem::path trajectory(std::uint32_t record, std::uint32_t trial) const {
        return dataset_.source(7) / "trajectories" /
               fmt::format("record{:03}_experiment1_trial{:02}_CF_0ms.csv", record, trial);
    }
    // Presses until it does: its page may not be there yet.
    static bool begins(const VirtualScreen& screen, const std::filesystem::path& trial) {
        return wait_until([&] {
            screen.press("space");
            return newest_needle_m(trial) > -1;
        });
    }

    Folder folder_;
    PortBlock ports_;
    Dataset dataset_{folder_ / "data"};
};

TEST_F(SessionWithAMouse, IsCutAndGoesOn) {
    VirtualScreen& screen = *screen_;
    const auto practice = trajectory(1, 1001), real = trajectory(2, 1);
    const auto insert_and_withdraw = [&](const std::filesystem::path& trial, std::size_t records_then) {
        // On a crowded machine the whole trial may be over between two looks.
        const auto over = [&] { return records().size() == records_then; };
        return move_until(screen, 8, [&] { return newest_needle_m(trial) > 0.035 || over(); }) &&
               move_until(screen, -8, over);
    };
    {
        Child first = start();
        ASSERT_TRUE(screen.wait_for_window("Thimble")) << words();
        ASSERT_TRUE(begins(screen, practice)) << words();
        ASSERT_TRUE(screen.press("F10"));  // a subject does not end it
        ASSERT_TRUE(screen.click(250, 450));
        ASSERT_TRUE(insert_and_withdraw(practice, 1)) << words();
        ASSERT_TRUE(begins(screen, real)) << words();
        first.signal(SIGKILL);
        first.wait(kPatience);
    }
    ASSERT_TRUE(wait_until([&] {
        return !screen.hand({"search", "--onlyvisible", "--name", "Thimble"});
    })) << "the programs end with the one that started them";

    Child second = start("--resume");
    ASSERT_TRUE(screen.wait_for_window("Thimble")) << words();
    const auto cut = real.parent_path() / (real.stem().string() + "_cut1.csv");
    ASSERT_TRUE(wait_until([&] {
        screen.click(250, 450);  // the page's end, and the hand's beginning
        return std::filesystem::exists(cut) && newest_needle_m(real) > -1;  // not of the trial that was cut
    })) << words();
    EXPECT_TRUE(insert_and_withdraw(real, 2)) << words();
    EXPECT_EQ(second.wait(kPatience), 0) << words();

    const auto done = records();
    ASSERT_EQ(done.size(), 2U);
    EXPECT_TRUE(done[0].practice);
    for (const DatasetRecord& record : done) EXPECT_EQ(record.row.reason, EndReason::kCompleted);
    EXPECT_EQ(done[1].repeat_of, 0U);
    EXPECT_THAT(words(), testing::HasSubstr("2 of 2 trials"));
}

TEST_F(SessionWithAMouse, AScreenThatGoesAwayStopsItInOrder) {
    Child run = start();
    ASSERT_TRUE(screen_->wait_for_window("Thimble")) << words();
    ASSERT_TRUE(begins(*screen_, trajectory(1, 1001))) << words();
    screen_.reset();
    EXPECT_EQ(run.wait(kPatience), 3) << words();
    // The second in the window's words, or in those of Xlib, where the screen is still on its way out.
    EXPECT_THAT(words(), testing::AnyOf(testing::HasSubstr("no screen"), testing::HasSubstr("X server")));
    ASSERT_EQ(records().size(), 1U);
    EXPECT_EQ(records()[0].row.reason, EndReason::kPeerLost);
}

TEST_F(SessionWithAMouse, WithoutAScreenIsRefusedBeforeAnythingIsWritten) {
    screen_.reset();
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    Child run = start();
    EXPECT_EQ(run.wait(kPatience), 2);
    EXPECT_THAT(words(), testing::HasSubstr("screen"));
    EXPECT_FALSE(std::filesystem::exists(dataset_.folder()));
}

}  // namespace
}  // namespace thimble
