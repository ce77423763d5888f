// Messages of a service to the manager that started it, as systemd defines them (sd_notify(3)): a datagram to the socket that
// NOTIFY_SOCKET names. Without that variable nothing is said.
#pragma once

#include <string>
#include <string_view>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"

namespace thimble {

class ServiceNotice : boost::noncopyable {
  public:
    // As the environment has it: NOTIFY_SOCKET, and WATCHDOG_USEC if WATCHDOG_PID is unset or this process.
    ServiceNotice();
    // `socket`: a path, or a name of the abstract namespace that begins with '@'; empty: no manager listens.
    // `watchdog`: how long the manager waits for a sign of life; zero: it does not.
    ServiceNotice(const std::string& socket, Duration watchdog);
    ~ServiceNotice();

    void ready() { say("READY=1"); }
    void stopping() { say("STOPPING=1"); }
    // Reports that the loop is alive, at most twice per watchdog period. Call it often; it never blocks.
    // While a manager reads nothing, it gets two or three reports, so that its queue keeps room for stopping().
    void turns(SessionTime now);

  private:
    void open(const std::string& socket, Duration watchdog);
    bool leaves_room() const;
    void say(std::string_view word) const;

    int socket_ = -1;
    Duration period_{};
    SessionTime next_{};
};

}  // namespace thimble
