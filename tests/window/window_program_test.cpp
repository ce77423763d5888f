// thimble-visual with its window, as a program.
#include <csignal>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "common/runtime/wall_clock.hpp"
#include "tests/read_text.hpp"
#include "tests/window/x_server.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

constexpr const char* kProgram = THIMBLE_BIN_DIR "/thimble-visual";

bool wait_for_words(const std::filesystem::path& log, const std::string& words) {
    for (int i = 0; i < 500; ++i) {
        if (std::filesystem::exists(log) && read_text(log).find(words) != std::string::npos) return true;
        wall_sleep(milliseconds{20});
    }
    return false;
}

TEST(WindowProgram, RefusesToStartWithoutScreen) {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    const std::filesystem::path log = std::filesystem::path(testing::TempDir()) / "window_program_test.log";
    Child visual(kProgram, {"--window", "--base-port", "26100"}, log);
    EXPECT_EQ(visual.wait(seconds{20}), 2);
    EXPECT_THAT(read_text(log), HasSubstr("no screen: DISPLAY and WAYLAND_DISPLAY are not set"));
    std::filesystem::remove(log);
}

TEST(WindowProgram, ReportsItsFramesAndEndsBySignal) {
    XServer server;
    if (!server.missing().empty()) GTEST_SKIP() << server.missing();
    const auto report = server.folder() / "report.json";
    Child visual(kProgram, {"--view", "player", "--base-port", "26130", "--report", report},
                 server.folder() / "log");
    ASSERT_TRUE(wait_for_words(server.folder() / "log", "ready"));
    wall_sleep(milliseconds{500});
    visual.signal(SIGTERM);
    ASSERT_EQ(visual.wait(seconds{20}), 0) << visual.last_words();
    const auto json = nlohmann::json::parse(read_text(report));
    EXPECT_EQ(json["window"]["end"], "asked");
    EXPECT_GT(json["window"]["frames"], 2);
    EXPECT_EQ(json["window"]["hand_to_swap"]["count"], 0);  // no trial
}

TEST(WindowProgram, OutlivesItsScreen) {
    XServer server;
    if (!server.missing().empty()) GTEST_SKIP() << server.missing();
    const auto report = server.folder() / "report.json";
    Child visual(kProgram, {"--window", "--base-port", "26160", "--report", report}, server.folder() / "log");
    ASSERT_TRUE(wait_for_words(server.folder() / "log", "ready"));
    wall_sleep(milliseconds{300});
    server.kill();
    EXPECT_TRUE(wait_for_words(server.folder() / "log", "the node goes on"));
    wall_sleep(milliseconds{300});
    EXPECT_FALSE(visual.poll()) << "it has ended: " << visual.last_words();
    visual.signal(SIGTERM);
    EXPECT_EQ(visual.wait(seconds{20}), 0) << visual.last_words();
    EXPECT_EQ(nlohmann::json::parse(read_text(report))["window"]["end"], "screen_lost");
}

}  // namespace
}  // namespace thimble
