// The near side of a link test: knocks at every port, finds the largest datagram that passes, then sends a session's traffic
// and listens to the echo.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "common/runtime/event_waiter.hpp"
#include "common/runtime/wall_clock.hpp"
#include "thimble/link_test/link_figures.hpp"
#include "thimble/link_test/port_probe.hpp"

namespace thimble {

struct LinkTestPlan {
    std::string host;
    std::uint16_t base_port = 0;
    std::vector<Port> ports;
    Duration duration = std::chrono::seconds{5};  // of the traffic
    const std::atomic<bool>* stop = nullptr;
};

class LinkTester {
  public:
    // Throws Error: usage or network, if the host is unknown or there is no route to it.
    explicit LinkTester(const LinkTestPlan& plan);

    LinkFigures run();

  private:
    bool going_on() const { return plan_.stop == nullptr || !*plan_.stop; }
    void pump(SessionTime until);
    void listen(SessionTime latest);
    void knock();
    void find_mtu();
    bool passes(PortProbe& probe, std::size_t bytes, bool& refused_here);
    void load();
    void count();
    Duration patience() const;
    LinkFigures figures();

    const LinkTestPlan& plan_;
    EventWaiter waiter_{false};
    std::vector<PortProbe> probes_;
    MtuFigures mtu_;
    std::vector<ClockExchange> exchanges_;
    std::uint32_t stalls_ = 0;
};

}  // namespace thimble
