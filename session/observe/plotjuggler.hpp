// The state of a session as JSON datagrams for PlotJuggler's "UDP Server" (docs/interoperability.md).
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "common/process.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/runtime/wall_clock.hpp"
#include "session/observe/observers.hpp"
#include "session/play/monitor_feed.hpp"
#include "session/run/condition_run.hpp"

namespace thimble {

// A datagram each. Faster than any screen, slow enough for every loop.
inline constexpr Duration kPlotJugglerPeriod = std::chrono::milliseconds{10};

// One object; `date_s` since 1970. `condition` stands between "thimble" and the values, unless it is empty.
inline std::string plotjuggler_json(double date_s, const std::string& condition, std::uint32_t trial,
                                    const Monitor& m) {
    // Unknown values are left out, so no curve begins at a value that was not measured.
    nlohmann::ordered_json values{{"trial", trial},
                                  {"time_s", m.time_s},
                                  {"position_needle_m", m.position_needle_m},
                                  {"position_surface_m", m.position_surface_m},
                                  {"position_fixture_m", m.position_fixture_m},
                                  {"force_tissue_N", m.force_tissue_N},
                                  {"force_fixture_N", m.force_fixture_N},
                                  {"force_total_N", m.force_total_N},
                                  {"force_hand_N", m.force_hand_N},
                                  {"energy_in_J", m.energy_in_J},
                                  {"contact_time_s", m.contact_time_s},
                                  {"network_delay_s", m.network_delay_s},
                                  {"datagrams_accepted", m.accepted},
                                  {"datagrams_refused", m.refused},
                                  {"subject", m.subject},
                                  {"modality", to_string(m.modality)},
                                  {"tissue_phase", to_string(m.phase)},
                                  {"running", m.state == NodeState::kRunning},
                                  {"fixture_present", m.fixture_present},
                                  {"needle_held", m.needle_held},
                                  {"beeped", m.beeped}};
    if (m.round_trip_s > 0) values["round_trip_s"] = m.round_trip_s;
    if (m.one_way_s >= 0) values["one_way_s"] = m.one_way_s;
    if (m.one_way_s >= 0) values["one_way_bound_s"] = m.one_way_bound_s;
    if (!condition.empty()) values = nlohmann::ordered_json{{condition, std::move(values)}};
    return json_text(nlohmann::ordered_json{{"timestamp", date_s}, {"thimble", std::move(values)}});
}

// Where [HOST:]PORT of --plotjuggler is, if the file allows it. Throws Error as read_endpoint() and require_observer_here() do.
inline Endpoint plotjuggler_at(const std::string& text, const NetworkSettings& network) {
    Endpoint to = read_endpoint(text, "--plotjuggler", "127.0.0.1");
    require_observer_here(network.security, to.host, "--plotjuggler");
    return to;
}

// Observes a session and sends its state, undelayed and with the fixture. A datagram that cannot be sent is lost.
class PlotJugglerFeed final : public Observer {
  public:
    // `session` outlives the feed. `ahead`: of 1970's clock, of the session's. `other`, which may be null, is
    // called before it. Throws Error (network) if the host is unknown.
    PlotJugglerFeed(const Endpoint& to, const SessionProcess& session, Duration ahead, std::string condition,
                    std::unique_ptr<Observer> other = nullptr)
        : channel_(std::nullopt, to),
          session_(&session),
          ahead_(ahead),
          condition_(std::move(condition)),
          other_(std::move(other)) {}

    void tick(SessionTime now) override {
        if (other_) other_->tick(now);
        if (now < next_) return;
        next_ = std::max(next_ + kPlotJugglerPeriod, now + kPlotJugglerPeriod / 2);
        const Monitor monitor = make_monitor(now - session_ahead_, *session_, {});
        const std::string text = plotjuggler_json(to_seconds(now + ahead_ - SessionTime{}), condition_,
                                                  session_->number(), monitor);
        channel_.send({static_cast<const std::uint8_t*>(static_cast<const void*>(text.data())), text.size()});
    }

    void serve(const SessionProcess& session, Duration ahead) override {
        session_ = &session;
        session_ahead_ = ahead;
        if (other_) other_->serve(session, ahead);
    }

    SessionTime next_wakeup() const override {
        return other_ ? std::min(next_, other_->next_wakeup()) : next_;
    }
    bool stopped() const override { return false; }

  private:
    UdpChannel channel_;
    const SessionProcess* session_;
    Duration ahead_;
    std::string condition_;
    std::unique_ptr<Observer> other_;
    Duration session_ahead_{};  // as in serve()
    SessionTime next_{};
};

// `other`, which may be none, and beside it a feed to `to`.
inline MakeObserver with_plotjuggler(MakeObserver other, const Endpoint& to) {
    return [other = std::move(other), to](SessionProcess& session, Sockets& sockets,
                                          const std::string& condition) -> std::unique_ptr<Observer> {
        const ClockPair clocks = read_clock_pair();
        const Duration ahead{clocks.realtime_ns - to_nanoseconds(clocks.before)};
        return std::make_unique<PlotJugglerFeed>(to, session, ahead, condition,
                                                 other ? other(session, sockets, condition) : nullptr);
    };
}

}  // namespace thimble
