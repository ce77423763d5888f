// A stop that outlives its session: kept once, and taken away only by a program that has read this one, not an older one.
#include "session/run/stop_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/runtime/standard_streams.hpp"
#include "common/text_file.hpp"
#include "session/run/session_stop.hpp"
#include "session/virtual/virtual_session.hpp"
#include "tests/refusal.hpp"
#include "tests/unit/session/records.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

class StopFileTest : public testing::Test {
  protected:
    StopFileTest() {
        setenv("THIMBLE_STOP_DIR", folder_.path().c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
    }
    ~StopFileTest() override {
        unsetenv("THIMBLE_STOP_DIR");  // NOLINT(concurrency-mt-unsafe): one thread
    }
    static std::string words_of(const std::function<void()>& refused) {
        return refusal(refused, ExitCode::kRunFailed);
    }

    const TemporaryDirectory folder_;
};

TEST_F(StopFileTest, KeepsTheFirstUntilItIsReleased) {
    const StopFile file(27000);
    EXPECT_FALSE(file.kept());
    file.require_released();
    file.keep("emergency stop (master): smoke");
    file.keep("emergency stop (session): again");
    EXPECT_THAT(file.kept()->words, HasSubstr("smoke, at "));
    EXPECT_THAT(words_of([&] { file.require_released(); }), HasSubstr("--release --base-port 27000"));
    StopFile(27033).require_released();
    EXPECT_TRUE(file.release(file.kept()));
    EXPECT_FALSE(file.release(file.kept()));
    file.require_released();
}

TEST_F(StopFileTest, OneThatCameLaterIsNotTakenAway) {
    const StopFile file(27000);
    EXPECT_FALSE(file.release(std::nullopt));
    file.keep("smoke");
    const auto first = file.kept();
    ASSERT_TRUE(file.release(first));
    file.keep("smoke");  // in the same second, of the same words
    EXPECT_FALSE(file.release(first));
    EXPECT_FALSE(file.release(std::nullopt));
    EXPECT_TRUE(file.kept());
}

TEST_F(StopFileTest, APlaceThatKeepsNoStopIsRefusedBeforeAnythingBegins) {
    const StopFile file(27000);
    std::filesystem::create_symlink(folder_ / "elsewhere", file.path());
    EXPECT_THAT(words_of([&] { file.require_released(); }), HasSubstr("cannot read"));
    EXPECT_THAT(words_of([&] { file.keep("smoke"); }), HasSubstr("cannot read"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "elsewhere"));
    std::filesystem::remove(file.path());
    std::filesystem::create_directory(file.path());
    EXPECT_THAT(words_of([&] { file.require_released(); }), HasSubstr("does not belong to this user"));
    std::filesystem::remove_all(folder_.path());
    file.require_released();
    EXPECT_THAT(words_of([&] { file.keep("smoke"); }), HasSubstr("cannot write"));
}

// A folder in its place stands for a file that may not be removed.
TEST_F(StopFileTest, OneThatCannotBeRemovedIsToldOnceAndTriedAgain) {
    VirtualSession session(load_system_settings({}));
    const ConditionPlan plan;
    const StopFile file(plan.network.base_port);
    SessionStop stop(session.session(), plan);
    session.emergency_stop(Role::kSession, "smoke");
    stop.look();
    ASSERT_TRUE(file.kept());
    std::filesystem::rename(file.path(), folder_ / "away");
    std::filesystem::create_directory(file.path());
    session.idle(std::chrono::seconds{1});
    session.release_stop();
    session.idle(std::chrono::seconds{1});
    ASSERT_FALSE(stop.stopped());
    testing::internal::CaptureStderr();
    stop.look();
    stop.look();
    EXPECT_TRUE(stderr_written_within(std::chrono::seconds{20}));
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_THAT(said, HasSubstr("warning: the stop was released, but its file is still there: "));
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    std::filesystem::remove(file.path());
    std::filesystem::rename(folder_ / "away", file.path());
    stop.look();
    EXPECT_FALSE(file.kept());
}

// Long enough to leave any buffer before the file is closed, and short enough to stay in it.
const std::string kTexts[] = {std::string(100'000, 'x'), "a line\n"};

void expect_refused(const std::filesystem::path& path) {
    for (const std::string& text : kTexts)
        EXPECT_THAT(refusal([&] { write_text_file(path, text); }, ExitCode::kRunFailed),
                    testing::HasSubstr(path.string()));
}

TEST(TextFile, IsReplacedAndKeepsEveryByte) {
    const TemporaryDirectory directory;
    const std::string first("a\r\n\0b\xff", 6);
    write_text_file(directory / "text", first);
    EXPECT_EQ(read_text(directory / "text"), first);
    write_text_file(directory / "text", "c");
    EXPECT_EQ(read_text(directory / "text"), "c");
    write_text_file(directory / "text", "");
    EXPECT_TRUE(std::filesystem::is_empty(directory / "text"));
}

TEST(TextFile, MissingDirectoryIsNamed) {
    const TemporaryDirectory directory;
    expect_refused(directory / "nowhere" / "text");
    EXPECT_FALSE(std::filesystem::exists(directory / "nowhere"));
}

TEST(TextFile, FullDiskIsAnError) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
    expect_refused("/dev/full");
}

TEST(Folder, IsMadeWithThoseOnTheWay) {
    const TemporaryDirectory directory;
    for (int twice = 0; twice < 2; ++twice) make_folder(directory / "a/b");
    EXPECT_TRUE(std::filesystem::is_directory(directory / "a/b"));
    make_folder("");
}

TEST(Folder, ThatCannotBeMadeIsNamed) {
    const TemporaryDirectory directory;
    write_text_file(directory / "file", "");
    for (const std::filesystem::path& folder : {directory / "file", directory / "file/in it"})
        EXPECT_THAT(refusal([&] { make_folder(folder); }, ExitCode::kUsage),
                    testing::HasSubstr((directory / "file").string() + ": is a file"));
}

}  // namespace
}  // namespace thimble
