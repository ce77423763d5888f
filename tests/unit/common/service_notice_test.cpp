// The messages at a service manager's socket.
#include "common/runtime/service_notice.hpp"

#include <cstdlib>
#include <filesystem>
#include <unistd.h>
#include <utility>

#include <gtest/gtest.h>

#include "tests/notify_socket.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

std::string abstract_name() { return "@thimble-notice-test-" + std::to_string(getpid()); }

TEST(ServiceNotice, SaysReadyAndStoppingByPathAndByName) {
    const std::string path =
        (std::filesystem::temp_directory_path() / ("thimble-notice-" + std::to_string(getpid()))).string();
    for (const std::string& name : {path, abstract_name()}) {
        const NotifySocket manager(name);
        ServiceNotice notice(name, {});
        notice.ready();
        notice.stopping();
        EXPECT_EQ(manager.heard(), "READY=1\nSTOPPING=1\n");
    }
    std::filesystem::remove(path);
}

TEST(ServiceNotice, TheWatchdogHearsTwicePerPeriodAndNotMoreAndNothingWithoutOne) {
    for (const auto& [period_ms, words] : {std::pair{1000, "WATCHDOG=1\nWATCHDOG=1\n"}, std::pair{0, ""}}) {
        const NotifySocket manager(abstract_name());
        ServiceNotice notice(abstract_name(), milliseconds{period_ms});
        for (int at_ms = 5000; at_ms < 6000; ++at_ms) notice.turns(SessionTime{milliseconds{at_ms}});
        EXPECT_EQ(manager.heard(), words) << period_ms;
    }
}

TEST(ServiceNotice, SignsOfLifeThatNobodyReadsLeaveRoomForTheEnd) {
    const NotifySocket manager(abstract_name());
    ServiceNotice notice(abstract_name(), milliseconds{2});
    notice.ready();
    for (int at_ms = 1; at_ms < 100; ++at_ms) notice.turns(SessionTime{milliseconds{at_ms}});
    notice.stopping();
    const std::string heard = manager.heard();
    EXPECT_TRUE(heard.starts_with("READY=1\nWATCHDOG=1\n")) << heard;
    EXPECT_TRUE(heard.ends_with("WATCHDOG=1\nSTOPPING=1\n")) << heard;
    notice.turns(SessionTime{milliseconds{100}});
    EXPECT_EQ(manager.heard(), "WATCHDOG=1\n") << "who has read hears again";
}

TEST(ServiceNotice, ReadsTheEnvironment) {
    const NotifySocket manager(abstract_name());
    setenv("NOTIFY_SOCKET", abstract_name().c_str(), 1);
    setenv("WATCHDOG_USEC", "2000000", 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
    ServiceNotice().turns(SessionTime{milliseconds{1}});
    EXPECT_EQ(manager.heard(), "WATCHDOG=1\n");
    setenv("WATCHDOG_PID", "1", 1);  // meant for another process
    ServiceNotice().turns(SessionTime{milliseconds{1}});
    EXPECT_EQ(manager.heard(), "");
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
}

TEST(ServiceNotice, NobodyThereIsNoError) {
    ServiceNotice nobody(abstract_name(), milliseconds{1});
    nobody.ready();
    nobody.turns(SessionTime{milliseconds{1}});
    ServiceNotice too_long(std::string(500, 'x'), {});
    too_long.ready();
}

}  // namespace
}  // namespace thimble
