#include "common/runtime/service_notice.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "common/decimal_text.hpp"
#include "common/own_program.hpp"

namespace thimble {
namespace {

// Linux queues eleven datagrams, and counts 768 bytes or more for each.
constexpr int kMostUnread_bytes = 2048;

// 0 if it is no number.
std::int64_t number(const std::string& text) { return parse_whole<std::int64_t>(text).value_or(0); }

Duration watchdog_in_environment() {
    const std::string whose = environment_text("WATCHDOG_PID");
    if (!whose.empty() && number(whose) != getpid()) return {};
    constexpr std::int64_t kHour_us = 3'600'000'000;
    return std::chrono::microseconds{std::min(number(environment_text("WATCHDOG_USEC")), kHour_us)};
}

}  // namespace

ServiceNotice::ServiceNotice() { open(environment_text("NOTIFY_SOCKET"), watchdog_in_environment()); }

ServiceNotice::ServiceNotice(const std::string& socket, Duration watchdog) { open(socket, watchdog); }

ServiceNotice::~ServiceNotice() {
    if (socket_ >= 0) close(socket_);
}

void ServiceNotice::open(const std::string& socket, Duration watchdog) {
    sockaddr_un address{};
    if (socket.empty() || socket.size() >= sizeof address.sun_path) return;
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, socket.data(), socket.size());
    if (socket.front() == '@') address.sun_path[0] = '\0';
    // The length counts for an abstract name: zeros after it would be part of it.
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket.size());
    socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const auto* generic = static_cast<const sockaddr*>(static_cast<const void*>(&address));
    if (socket_ >= 0 && connect(socket_, generic, length) != 0) {
        close(socket_);
        socket_ = -1;
    }
    if (watchdog > Duration::zero()) period_ = watchdog / 2;
}

void ServiceNotice::turns(SessionTime now) {
    if (period_ == Duration::zero() || now < next_) return;
    next_ = now + period_;
    if (leaves_room()) say("WATCHDOG=1");
}

bool ServiceNotice::leaves_room() const {
    int unread_bytes = 0;
    return ioctl(socket_, SIOCOUTQ, &unread_bytes) != 0 || unread_bytes < kMostUnread_bytes;
}

void ServiceNotice::say(std::string_view word) const {
    if (socket_ >= 0) send(socket_, word.data(), word.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
}

}  // namespace thimble
