// thimble-drive-emulator: motor drives as programs, for trying the fingertip device without one.
#include <algorithm>
#include <array>
#include <memory>
#include <poll.h>
#include <string>
#include <unistd.h>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/runtime/udp_socket.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/version.hpp"
#include "cutaneous_node/can/cannelloni.hpp"
#include "cutaneous_node/can/socket_can_bus.hpp"
#include "cutaneous_node/emulator/emulated_drives.hpp"
#include "cutaneous_node/emulator/slcan_pty.hpp"

namespace {

using namespace thimble;

struct EmulatorOptions {
    std::string interface, to;
    int listen = 20000;
    bool slcan = false, lies = false;
    std::vector<int> nodes{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    std::vector<std::string> faults, faults_when_pressed;
    double after_s = 0.2;
};

// The bus, and what to wait on for it.
struct OpenBus {
    std::unique_ptr<UdpChannel> channel;
    std::unique_ptr<CanBus> bus;
    int descriptor = -1;
    std::string name;
};

// Without --to the next port of this machine.
Endpoint other_end(const EmulatorOptions& options) {
    if (options.to.empty()) return {"127.0.0.1", static_cast<std::uint16_t>(options.listen + 1)};
    Endpoint to = read_endpoint(options.to, "--to", "127.0.0.1");
    UdpAddress::resolved(to.host, to.port, "give a known name or an IPv4 address to --to");
    return to;
}

OpenBus open_bus_for(const EmulatorOptions& options) {
    OpenBus open;
    if (options.slcan) {
        auto pty = std::make_unique<SlcanPty>(options.lies);
        open.descriptor = pty->file_descriptor();
        open.name = pty->interface();
        open.bus = std::move(pty);
    } else if (!options.interface.empty()) {
        auto can = std::make_unique<SocketCanBus>(options.interface);
        open.descriptor = can->file_descriptor();
        open.name = options.interface;
        open.bus = std::move(can);
    } else {
        const auto port = static_cast<std::uint16_t>(options.listen);
        open.channel = std::make_unique<UdpChannel>(Endpoint{"0.0.0.0", port}, other_end(options));
        open.descriptor = open.channel->file_descriptor();
        open.name = fmt::format("UDP port {}", port);
        open.bus = std::make_unique<CannelloniBus>(*open.channel);
    }
    return open;
}

// Lines from standard input, as far as they have come.
class CommandLines {
  public:
    // False once the input has ended.
    bool read_more() {
        std::array<char, 256> buffer{};
        const auto size = read(STDIN_FILENO, buffer.data(), buffer.size());
        if (size > 0) text_.append(buffer.data(), static_cast<std::size_t>(size));
        return size > 0;
    }
    bool next(std::string& line) {
        const auto end = text_.find('\n');
        if (end == std::string::npos) return false;
        line = text_.substr(0, end);
        text_.erase(0, end + 1);
        return true;
    }

  private:
    std::string text_;
};

void emulate(EmulatedDrives& drives, int bus_descriptor) {
    constexpr Duration kLongest = std::chrono::milliseconds{100};  // a stop request waits for no longer
    CommandLines commands;
    std::array<pollfd, 2> waits{pollfd{bus_descriptor, POLLIN, 0}, pollfd{STDIN_FILENO, POLLIN, 0}};
    while (!drives.stopped() && !stop_requested()) {
        drives.tick(wall_now());
        const Duration rest = std::clamp(drives.next_wakeup() - wall_now(), Duration{0}, kLongest);
        const auto rest_ms =
            (rest + std::chrono::milliseconds{1} - Duration{1}) / std::chrono::milliseconds{1};
        if (poll(waits.data(), waits.size(), static_cast<int>(rest_ms)) <= 0 || waits[1].revents == 0)
            continue;
        if (!commands.read_more()) waits[1].fd = -1;
        for (std::string line; commands.next(line);) {
            const std::string wrong = drives.obey(wall_now(), line);
            if (!wrong.empty()) spdlog::warn(wrong);
        }
    }
}

void refuse_wrong(const char* option, const std::string& wrong) {
    if (!wrong.empty()) throw Error(ExitCode::kUsage, "{} {} (--help lists the faults)", option, wrong);
}

int run_emulator(const EmulatorOptions& options) {
    const std::vector<std::uint8_t> nodes(options.nodes.begin(), options.nodes.end());
    refuse_twice("--nodes", options.nodes);  // each drive needs a node id of its own
    const OpenBus open = open_bus_for(options);
    EmulatedDrives drives(nodes, PlantParameters{}, *open.bus);
    for (const std::string& fault : options.faults) {
        refuse_wrong("--fault", drives.obey(wall_now(), fault));
    }
    for (const std::string& fault : options.faults_when_pressed) {
        refuse_wrong("--fault-when-pressed", drives.obey_when_pressed(fault, from_seconds(options.after_s)));
    }
    install_stop_signals();
    spdlog::info("{} drives on {}", nodes.size(), open.name);
    emulate(drives, open.descriptor);
    fmt::print("frames {}, strongest force {:.3f} N\n", drives.frames(), drives.strongest_N());
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main("thimble-drive-emulator", [&] {
        EmulatorOptions options;
        CLI::App app(
            "Emulates the motor drives (CANopen CiA 402) of a fingertip device, with cables and finger pads, "
            "on a CAN interface or over UDP (cannelloni).",
            "thimble-drive-emulator");
        app.add_option("--can", options.interface, "CAN interface, e.g. vcan0; default: UDP");
        app.add_flag("--slcan", options.slcan,
                     "make a CAN interface: act as an slcan adapter on a pseudo-terminal (needs root)");
        app.add_flag("--adapter-lies", options.lies,
                     "send noise between the frames, and cut some frames short")
            ->needs("--slcan");
        app.add_option("--listen", options.listen, "UDP port that receives cannelloni's datagrams")
            ->check(CLI::Range(1024, 65534))
            ->type_name("PORT")
            ->default_val(options.listen);
        app.add_option("--to", options.to,
                       "where cannelloni's datagrams go; default: this machine, the port after --listen")
            ->type_name("HOST:PORT");
        app.add_option("--nodes", options.nodes, "CANopen node ids of the drives, with commas")
            ->delimiter(',')
            ->check(CLI::Range(1, 126));
        app.add_option("--fault", options.faults,
                       "fault at the start that outlasts a reset; may be given several times");
        app.add_option("--fault-when-pressed", options.faults_when_pressed,
                       "fault after a finger has been pressed for --after-s; may be given several times");
        app.add_option("--after-s", options.after_s, "delay of --fault-when-pressed, s")
            ->check(CLI::Range(0.0, 1000.0));
        app.set_version_flag("--version", std::string(kVersion));
        app.footer(std::string("Faults; also read as lines from standard input:\n") + kFaultWords +
                   "\nExample:\n"
                   "  thimble-drive-emulator --listen 20001 --to 127.0.0.1:20000 --fault-when-pressed 'emcy "
                   "3 0x2310'\n"
                   "and in the session file:\n"
                   "  [cutaneous]\n  device = \"drives\"\n  [cutaneous.drives]\n  bus = "
                   "\"cannelloni:127.0.0.1:20001\"\n"
                   "\nExit codes: 0 ok, 1 failed, 2 usage, 3 no bus.");
        if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
        return run_emulator(options);
    });
}
