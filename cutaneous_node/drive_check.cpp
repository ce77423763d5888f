// thimble-drive-check: presses one finger after the other without a session, to see whether a device works.
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/version.hpp"
#include "cutaneous_node/cutaneous_settings.hpp"
#include "cutaneous_node/drive_run.hpp"

namespace {

using namespace thimble;

struct CheckOptions {
    std::string config;
    double force_N = 0.5, press_s = 1;
};

// The measures at the end of the time. Throws Error (run failed) if a drive fails or a stop is requested.
double press(DriveActuator& actuator, const FingerDevice& finger, const CheckOptions& options) {
    actuator.use_hand(wall_now(), finger.hand);
    const SessionTime end = wall_now() + from_seconds(options.press_s);
    for (SessionTime now = wall_now(); now < end && !stop_requested(); now = wall_now()) {
        actuator.command(now, finger.finger, options.force_N);
        actuator.tick(now);
        if (!actuator.fault().empty()) throw Error(ExitCode::kRunFailed, std::string(actuator.fault()));
        wall_sleep(std::chrono::milliseconds{1});
    }
    if (stop_requested()) throw Error(ExitCode::kRunFailed, "interrupted while a finger was pressed");
    return actuator.output(wall_now()).force_N;
}

void press_each(DriveActuator& actuator, const DriveSettings& settings, const CheckOptions& options) {
    // In every case no drive keeps its voltage: otherwise it would keep it until it misses the heartbeat.
    const std::unique_ptr<DriveActuator, void (*)(DriveActuator*)> slack_at_end(
        &actuator, [](DriveActuator* drives) { drives->stop(); });
    bring_up_drives(actuator);
    fmt::print("{} drives run, every cable is taut\n", actuator.master().drives());
    for (const FingerDevice& finger : settings.fingers) {
        const double felt_N = press(actuator, finger, options);
        fmt::print("{} hand, {}: asked for {:.3f} N, measured {:.3f} N\n",
                   finger.hand == Hand::kActing ? "acting" : "other",
                   finger.finger == Finger::kIndex ? "index" : "thumb", options.force_N, felt_N);
    }
}

struct CheckSettings {
    CutaneousSettings cutaneous;
    NetworkSettings network;
};

// Other tables of a session file are for other programs to check.
CheckSettings read_settings(const std::string& path) {
    const ConfigFile file = ConfigFile::load(path);
    std::vector<std::string_view> elsewhere = session_tables();
    std::erase(elsewhere, "cutaneous");
    std::erase(elsewhere, "security");
    CheckSettings settings;
    SecuritySettings& security = settings.network.security;
    file.read_all(
        [&] {
            settings.cutaneous = read_cutaneous_settings(file.table("cutaneous"));
            security.allow_unprotected_network = read_security_settings(file).allow_unprotected_network;
        },
        elsewhere);
    security.mode = SecurityMode::kNone;  // of this program, which talks to no other
    return settings;
}

int check(const CheckOptions& options) {
    const auto [settings, network] = read_settings(options.config);
    if (settings.drives.bus.empty()) {
        throw Error(ExitCode::kUsage,
                    options.config + " has no [cutaneous.drives] with a bus, so there is nothing to check");
    }
    if (options.force_N < settings.drives.deadband_N || options.force_N > settings.force_limit_N)
        throw Error(
            ExitCode::kUsage,
            "--force-N {:g}: give {:g} ([cutaneous.drives] deadband_N) to {:g} ([cutaneous] force_limit_N)",
            options.force_N, settings.drives.deadband_N, settings.force_limit_N);
    Sockets sockets{network};
    const auto bus = open_bus(settings.drives, sockets);
    DriveActuator actuator(settings.drives, settings.force_limit_N, *bus);
    install_stop_signals();
    press_each(actuator, settings.drives, options);
    fmt::print("{}\n", json_text(describe_drives(actuator)));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main("thimble-drive-check", [&] {
        CheckOptions options;
        CLI::App app(
            "Starts the motor drives of a session file, presses one finger after the other, and compares the "
            "force with the command.",
            "thimble-drive-check");
        app.add_option("session", options.config, "session file with [cutaneous.drives]")->required();
        app.add_option("--force-N", options.force_N, "force on each finger, N")
            ->check(CLI::Range(0.0, 20.0))
            ->default_val(options.force_N);
        app.add_option("--seconds", options.press_s, "how long each finger is pressed, s")
            ->check(CLI::Range(0.1, 60.0));
        app.set_version_flag("--version", std::string(kVersion));
        app.footer(
            "Example:\n  thimble-drive-check device.toml --force-N 0.3\n\n"
            "Exit codes: 0 ok, 1 a drive failed, 2 usage or configuration, 3 no bus.");
        if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
        return check(options);
    });
}
