// thimble-igtl: a session, or the logs of one, for 3D Slicer and whatever else speaks OpenIGTLink. Looks only.
// A session as OpenIGTLink messages (version 1 of the protocol, by Debian's library): http://openigtlink.org/protocols/.
//
//   TRANSFORM "Needle", "Surface"   along z, positive into the tissue, in mm as OpenIGTLink has it
//   SENSOR    "Force"               total, tissue, fixture, at the handle (positive pushes the hand out); N
//   STRING    "State"               trial, modality, phase of the tissue, beep, for people
//   STATUS    "Thimble"             running, waiting, or why a trial has ended
#include <algorithm>
#include <array>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>
#include <igtlUnit.h>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/tcp_server.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/version.hpp"
#include "session/observe/monitor_source.hpp"
#include "session/observe/observed_session.hpp"
#include "session/observe/observers.hpp"

namespace {

using namespace thimble;

constexpr Duration kTextPeriod = std::chrono::milliseconds{250};

struct IgtlOptions {
    ObservedSession session;
    std::string listen = "127.0.0.1:18944";
    std::vector<std::string> replay{};
    double rate_Hz = 60, speed = 1;
};

constexpr double kMillimetres_per_m = 1000;

Bytes packed(igtl::MessageBase& message, std::int64_t date_ns) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    auto time = igtl::TimeStamp::New();
    time->SetTime(static_cast<igtlUint32>(date_ns / kSecond_ns),
                  static_cast<igtlUint32>(date_ns % kSecond_ns));
    message.SetTimeStamp(time);
    message.Pack();
    return {static_cast<const std::uint8_t*>(message.GetPackPointer()),
            static_cast<std::size_t>(message.GetPackSize())};
}

Bytes placed(igtl::TransformMessage& message, std::int64_t date_ns, double position_m) {
    igtl::Matrix4x4 matrix;
    igtl::IdentityMatrix(matrix);
    matrix[2][3] = static_cast<float>(kMillimetres_per_m * position_m);
    message.SetMatrix(matrix);
    return packed(message, date_ns);
}

int code_of(const Monitor& monitor, bool silent) {
    if (silent) return igtl::StatusMessage::STATUS_TIME_OUT;
    if (monitor.state == NodeState::kRunning) return igtl::StatusMessage::STATUS_OK;
    if (is_stop(monitor.reason)) return igtl::StatusMessage::STATUS_PANICK_MODE;
    switch (monitor.reason) {
        case EndReason::kDeviceFault:
            return igtl::StatusMessage::STATUS_HARDWARE_FAILURE;
        case EndReason::kPeerLost:
            return igtl::StatusMessage::STATUS_TIME_OUT;
        default:
            return igtl::StatusMessage::STATUS_NOT_READY;  // between trials
    }
}

// Of at most 19 letters, which is what there is room for.
std::string name_of(const Monitor& monitor, bool silent) {
    if (silent) return "no session";
    if (monitor.state == NodeState::kRunning) return "running";
    return monitor.reason == EndReason::kNone ? "waiting" : to_string(monitor.reason);
}

// The session as OpenIGTLink messages. Each call gives one; `date_ns` since 1970. It is valid until the next call of the same function.
class IgtlText {
  public:
    IgtlText() {
        needle_->SetDeviceName("Needle");
        surface_->SetDeviceName("Surface");
        force_->SetDeviceName("Force");
        state_->SetDeviceName("State");
        status_->SetDeviceName("Thimble");
        auto unit = igtl::Unit::New();
        unit->Append(igtl::Unit::SI_DERIVED_NEWTON, 1);
        force_->SetUnit(unit);
    }
    Bytes needle(std::int64_t date_ns, const Monitor& monitor) {
        return placed(*needle_, date_ns, monitor.position_needle_m);
    }
    Bytes surface(std::int64_t date_ns, const Monitor& monitor) {
        return placed(*surface_, date_ns, monitor.position_surface_m);
    }
    Bytes force(std::int64_t date_ns, const Monitor& m) {
        std::array<igtlFloat64, 4> values{m.force_total_N, m.force_tissue_N, m.force_fixture_N,
                                          m.force_hand_N};
        force_->SetLength(values.size());
        force_->SetValue(values.data());
        return packed(*force_, date_ns);
    }
    Bytes state(std::int64_t date_ns, std::uint32_t trial, const Monitor& m) {
        std::string text = fmt::format("trial {} {} {} {:.2f} N{}", trial, to_string(m.modality),
                                       to_string(m.phase), m.force_total_N, m.beeped ? " beeped" : "");
        state_->SetString(text);
        return packed(*state_, date_ns);
    }
    // `silent`: no session has spoken for a while.
    Bytes status(std::int64_t date_ns, const Monitor& monitor, bool silent) {
        const std::string name = name_of(monitor, silent);
        status_->SetCode(code_of(monitor, silent));
        status_->SetSubCode(0);
        status_->SetErrorName(name.c_str());
        status_->SetStatusString(name.c_str());
        return packed(*status_, date_ns);
    }

  private:
    igtl::TransformMessage::Pointer needle_ = igtl::TransformMessage::New(),
                                    surface_ = igtl::TransformMessage::New();
    igtl::SensorMessage::Pointer force_ = igtl::SensorMessage::New();
    igtl::StringMessage::Pointer state_ = igtl::StringMessage::New();
    igtl::StatusMessage::Pointer status_ = igtl::StatusMessage::New();
};

// Asks the source, tells the clients, in the loop that drives every node.
class IgtlServer final : public Process {
  public:
    IgtlServer(MonitorSource& source, TcpServer& server, double rate_Hz, bool waits, Duration ahead)
        : source_(&source),
          server_(&server),
          period_(from_seconds(1 / rate_Hz)),
          ahead_(ahead),
          waits_(waits) {}

    void tick(SessionTime now) override {
        if (!waits_) source_->update(now);
        if (now < next_) return;
        next_ = std::max(next_ + period_, now + period_ / 2);
        server_->look_after_clients();
        if (waits_ && server_->clients() > 0) {
            waits_ = false;
            source_->start(now);
            source_->update(now);
        }
        if (!waits_) tell(now);
    }
    SessionTime next_wakeup() const override { return next_; }
    // Ends with a recorded session, after all clients have received it.
    bool stopped() const override { return over_; }

  private:
    void tell(SessionTime now) {
        const std::int64_t date_ns = to_nanoseconds(now + ahead_);
        const Monitor& monitor = source_->newest();
        const bool silent = source_->silent(now);
        if (!silent) {
            server_->send(words_.needle(date_ns, monitor));
            server_->send(words_.surface(date_ns, monitor));
            server_->send(words_.force(date_ns, monitor));
        }
        const bool last = source_->over();
        if (now >= next_text_ || last) {
            next_text_ = now + kTextPeriod;
            if (!silent) server_->send(words_.state(date_ns, source_->trial(), monitor));
            server_->send(words_.status(date_ns, monitor, silent));
        }
        over_ = last && server_->all_sent();
    }

    MonitorSource* source_;
    TcpServer* server_;
    IgtlText words_;
    Duration period_, ahead_;
    SessionTime next_{}, next_text_{};
    bool waits_, over_ = false;
};

void add_igtl_options(CLI::App& app, IgtlOptions& o) {
    o.session.add_options(app);
    app.add_option("--listen", o.listen, "where OpenIGTLink clients connect")
        ->default_val(o.listen)
        ->type_name("[HOST:]PORT");
    app.add_option("--replay", o.replay,
                   "show log files (.mcap) of one session instead of a running session; starts when the "
                   "first client connects");
    app.add_option("--speed", o.speed, "speed of the replay; 1: as recorded")
        ->check(CLI::Range(0.01, 100.0))
        ->default_val(o.speed);
    app.add_option("--rate-Hz", o.rate_Hz, "how often needle, surface and force are sent, Hz")
        ->check(CLI::Range(1.0, 250.0))
        ->default_val(o.rate_Hz);
    app.set_version_flag("--version", std::string(kVersion));
    app.footer(
        "Examples:\n"
        "  thimble-igtl deploy/sessions/delay50.toml      # beside: thimble run ... --monitor\n"
        "  thimble-igtl --replay out/run/nodes/session_50ms.mcap\n"
        "\n"
        "Exit codes: 0 ok, 2 usage or configuration, 3 network, 5 a log cannot be read.");
}

int serve(const IgtlOptions& options) {
    const NetworkSettings network = options.session.network();
    const Endpoint local = read_endpoint(options.listen, "--listen", "127.0.0.1");
    require_observer_here(network.security, local.host, "--listen");
    const bool replay = !options.replay.empty();
    install_stop_signals();
    TcpServer server(local);
    std::unique_ptr<Sockets> sockets;
    std::unique_ptr<MonitorSource> source;
    if (replay) {
        source = std::make_unique<LoggedMonitor>(options.replay, options.speed);
    } else {
        sockets = std::make_unique<Sockets>(network);
        source = std::make_unique<LiveMonitor>(*sockets, options.session.monitor(*sockets));
    }
    const ClockPair clocks = read_clock_pair();
    IgtlServer process(*source, server, options.rate_Hz, replay,
                       Duration{clocks.realtime_ns - to_nanoseconds(clocks.before)});
    RealtimeLoop loop(sockets ? std::span<Listener* const>(sockets->listeners())
                              : std::span<Listener* const>());
    spdlog::info("ready: OpenIGTLink on {}:{}", local.host, server.port());
    loop.run(process);
    if (server.skipped() > 0)
        spdlog::warn("{} messages were not sent, because clients read too slowly", server.skipped());
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main("thimble-igtl", [&] {
        CLI::App app(
            "Shows a session in 3D Slicer and other OpenIGTLink programs: needle and surface (TRANSFORM, "
            "mm), force (SENSOR, N), state (STRING) and status (STATUS). It only observes: clients cannot "
            "change the session.",
            "thimble-igtl");
        IgtlOptions options;
        add_igtl_options(app, options);
        if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
        return serve(options);
    });
}
