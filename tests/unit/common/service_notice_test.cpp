// The messages at a service manager's socket.
#include "common/runtime/service_notice.hpp"

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

class Manager {
  public:
    // A path, or with '@' in front a name of the abstract namespace.
    explicit Manager(const std::string& name) : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::memcpy(address.sun_path, name.data(), name.size());
        if (name.front() == '@') address.sun_path[0] = '\0';
        const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
        bound_ = bind(socket_, static_cast<const sockaddr*>(static_cast<const void*>(&address)), length) == 0;
    }
    ~Manager() { close(socket_); }
    Manager(const Manager&) = delete;
    Manager& operator=(const Manager&) = delete;

    bool bound() const { return bound_; }
    std::vector<std::string> heard() const {
        std::vector<std::string> words;
        std::array<char, 100> word{};
        for (ssize_t n; (n = recv(socket_, word.data(), word.size(), MSG_DONTWAIT)) > 0;)
            words.emplace_back(word.data(), static_cast<std::size_t>(n));
        return words;
    }

  private:
    int socket_;
    bool bound_;
};

std::string abstract_name() { return "@thimble-notice-test-" + std::to_string(getpid()); }

TEST(ServiceNotice, SaysReadyAndStoppingByPathAndByName) {
    const std::string path =
        (std::filesystem::temp_directory_path() / ("thimble-notice-" + std::to_string(getpid()))).string();
    for (const std::string& name : {path, abstract_name()}) {
        const Manager manager(name);
        ASSERT_TRUE(manager.bound()) << name;
        ServiceNotice notice(name, {});
        notice.ready();
        notice.stopping();
        EXPECT_THAT(manager.heard(), ElementsAre("READY=1", "STOPPING=1"));
    }
    std::filesystem::remove(path);
}

TEST(ServiceNotice, TheWatchdogHearsTwicePerPeriodAndNotMore) {
    const Manager manager(abstract_name());
    ASSERT_TRUE(manager.bound());
    ServiceNotice notice(abstract_name(), milliseconds{1000});
    for (int at_ms = 5000; at_ms < 6000; ++at_ms) notice.turns(SessionTime{milliseconds{at_ms}});
    EXPECT_THAT(manager.heard(), ElementsAre("WATCHDOG=1", "WATCHDOG=1"));
}

TEST(ServiceNotice, WithoutAWatchdogTurnsAreSilent) {
    const Manager manager(abstract_name());
    ServiceNotice notice(abstract_name(), {});
    notice.turns(SessionTime{milliseconds{1}});
    EXPECT_THAT(manager.heard(), IsEmpty());
}

TEST(ServiceNotice, ReadsTheEnvironment) {
    const Manager manager(abstract_name());
    setenv("NOTIFY_SOCKET", abstract_name().c_str(), 1);
    setenv("WATCHDOG_USEC", "2000000", 1);
    setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
    ServiceNotice().turns(SessionTime{milliseconds{1}});
    EXPECT_THAT(manager.heard(), ElementsAre("WATCHDOG=1"));
    setenv("WATCHDOG_PID", "1", 1);  // meant for another process
    ServiceNotice().turns(SessionTime{milliseconds{1}});
    EXPECT_THAT(manager.heard(), IsEmpty());
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
