// The state of a session as JSON datagrams for PlotJuggler's "UDP Server" (docs/interoperability.md lists the keys).
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "common/process.hpp"
#include "common/runtime/udp_channel.hpp"
#include "session/run/condition_run.hpp"

namespace thimble {

// A datagram each. Faster than any screen, slow enough for every loop.
inline constexpr Duration kPlotJugglerPeriod = std::chrono::milliseconds{10};

// One object; `date_s` since 1970. `condition` stands between "thimble" and the values, unless it is empty.
std::string plotjuggler_json(double date_s, const std::string& condition, std::uint32_t trial,
                             const Monitor& monitor);

// Where [HOST:]PORT of --plotjuggler is, if the file allows it. Throws Error as read_observer() and require_observer_here() do.
Endpoint plotjuggler_at(const std::string& text, const NetworkSettings& network);

// Sits beside a session and sends what it shows, undelayed and with the fixture. Reads only; what cannot be sent is lost.
class PlotJugglerFeed final : public Process {
  public:
    // `session` outlives the feed. `ahead`: of 1970's clock, of the session's. `other`, which may be null, is
    // called before it. Throws Error (network) if the host is unknown.
    PlotJugglerFeed(const Endpoint& to, const SessionProcess& session, Duration ahead, std::string condition,
                    std::unique_ptr<Process> other = nullptr)
        : channel_(std::nullopt, to),
          session_(&session),
          ahead_(ahead),
          condition_(std::move(condition)),
          other_(std::move(other)) {}

    void tick(SessionTime now) override;
    SessionTime next_wakeup() const override {
        return other_ ? std::min(next_, other_->next_wakeup()) : next_;
    }
    bool stopped() const override { return false; }

  private:
    UdpChannel channel_;
    const SessionProcess* session_;
    Duration ahead_;
    std::string condition_;
    std::unique_ptr<Process> other_;
    SessionTime next_{};
};

// `other`, which may be none, and beside it a feed to `to`.
MakeObserver with_plotjuggler(MakeObserver other, const Endpoint& to);

}  // namespace thimble
