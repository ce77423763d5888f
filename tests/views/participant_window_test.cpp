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
    "[fixture]\nposition_m = 0.03\n[trial]\ncontact_hold_s = 0.02\npeer_wait_s = 30\n"
    "[protocol]\nexperiments = [1]\ntrials_per_modality = 1\npractice_trials = 1\nbreak_every = 0\n"
    "next_by = 'subject'\n"
    "[instructions]\nready_title = 'Bereit?'\nready = 'Versuch {trial} von {trials}'\n";

// With the arrow keys, a consent page, and questions before the trial and after it.
constexpr const char* kKeySession =
    "[session]\nsubject = 'human'\nparticipant = 'P07'\nmodalities = ['CF']\nfixture_jitter_m = 0\n"
    "[handle]\ndevice = 'keyboard'\n[visual]\nsound = false\nfingertip = true\n"
    "[fixture]\nposition_m = 0.03\n[trial]\ncontact_hold_s = 0.02\npeer_wait_s = 30\n"
    "[protocol]\nexperiments = [1]\ntrials_per_modality = 1\npractice_trials = 0\nbreak_every = 0\n"
    "next_by = 'subject'\nblinded = true\n[instructions]\npages = 'pages.toml'\n";
constexpr const char* kPages =
    "[consent]\nversion = 'v2'\ntext = 'You take part.'\nagree = 'yes'\ndecline = 'no'\n"
    "[[questionnaire]]\nname = 'about'\nwhen = 'start'\n[[questionnaire.question]]\nid = 'age'\n"
    "text = 'How old?'\nkind = 'number'\nfrom = 18\nto = 89\n"
    "[[questionnaire]]\nname = 'load'\n[[questionnaire.question]]\nid = 'effort'\ntext = 'How hard?'\n"
    "kind = 'likert'\n";

class SessionWithAMouse : public OnAScreen {
  protected:
    // Without a keyboard.
    Child start(const std::string& more = "--consent", const char* session = kMouseSession) const {
        folder_.write("pages.toml", kPages);
        const std::string command = "exec " THIMBLE_BIN_DIR "/thimble run " +
                                    folder_.write("session.toml", session).string() + " --out " +
                                    dataset_.folder().string() + " --base-port " +
                                    std::to_string(ports_.base()) + " " + more + " </dev/null";
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

    bool declines(Child& run) const {
        return wait_until([&] {
            screen_->press("2");
            screen_->press("Return");
            return run.poll().has_value();
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

    Child second = start("--consent --resume");
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

TEST_F(SessionWithAMouse, ConsentQuestionsAndATrialByKeysAlone) {
    VirtualScreen& screen = *screen_;
    const auto answers = [&](const char* table) {
        return testing::Value(read_text(dataset_.folder() / "phenotype" / table), testing::HasSubstr("Z\t"));
    };
    // Pressed until it is written down: the page may not be there yet.
    const auto answer = [&](const std::vector<std::string>& keys, const std::function<bool()>& done) {
        return wait_until([&] {
            for (const std::string& key : keys) screen.press(key);
            return done();
        });
    };
    Child run = start("", kKeySession);
    ASSERT_TRUE(screen.wait_for_window("Thimble")) << words();
    ASSERT_TRUE(answer({"1", "Return"}, [&] { return answers("consent.tsv"); })) << words();
    ASSERT_TRUE(answer({"Delete", "3", "1", "Return"}, [&] { return answers("about.tsv"); })) << words();
    const auto trial = trajectory(1, 1);
    ASSERT_TRUE(begins(screen, trial)) << words();
    const auto hold = [&](const char* key, const std::function<bool()>& done) {
        screen.hand({"keydown", key});
        const bool good = wait_until(done);
        screen.hand({"keyup", key});
        return good;
    };
    ASSERT_TRUE(hold("Down", [&] { return newest_needle_m(trial) > 0.035 || records().size() == 1; }))
        << words();
    ASSERT_TRUE(hold("Up", [&] { return records().size() == 1; })) << words();
    ASSERT_TRUE(answer({"6", "Return"}, [&] { return answers("load_block1.tsv"); })) << words();
    EXPECT_EQ(run.wait(kPatience), 0) << words();
    EXPECT_EQ(records()[0].row.reason, EndReason::kCompleted);
    EXPECT_THAT(read_text(dataset_.folder() / "phenotype" / "about.tsv"), testing::HasSubstr("\t31\n"));
    EXPECT_THAT(read_text(dataset_.participants()), testing::HasSubstr("yes"));
    std::string said = words();  // they name the folder, whose name is random
    const std::string place = dataset_.folder().parent_path().string();
    for (auto at = said.find(place); at != std::string::npos; at = said.find(place))
        said.erase(at, place.size());
    EXPECT_THAT(said, testing::Not(testing::HasSubstr("CF"))) << "blinded";
}

TEST_F(SessionWithAMouse, WhoDeclinesLeavesNothing) {
    Child run = start("", kKeySession);
    ASSERT_TRUE(screen_->wait_for_window("Thimble")) << words();
    ASSERT_TRUE(declines(run)) << words();
    EXPECT_EQ(run.wait(kPatience), 0) << words();
    EXPECT_THAT(words(), testing::HasSubstr("did not consent"));
    EXPECT_FALSE(std::filesystem::exists(dataset_.source(7)));
    EXPECT_FALSE(std::filesystem::exists(dataset_.participants()));
    EXPECT_FALSE(std::filesystem::exists(dataset_.order(7)));
}

TEST_F(SessionWithAMouse, WhoDeclinesTakesNothingAwayThatAnotherSessionWroteMeanwhile) {
    Child run = start("", kKeySession);
    ASSERT_TRUE(screen_->wait_for_window("Thimble")) << words();
    const auto theirs = trajectory(1, 1).parent_path();
    std::filesystem::create_directories(theirs);
    ASSERT_TRUE(declines(run)) << words();
    EXPECT_TRUE(std::filesystem::exists(theirs)) << words();
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
