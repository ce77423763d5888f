// Facts about this machine and a session, which checks.hpp judges. They are plain values, so that tests can check machines that do not
// exist.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/config.hpp"
#include "common/error.hpp"

namespace thimble {

struct NetworkSettings;
struct SystemSettings;

struct SessionFacts {
    std::string file;     // as given; empty: the defaults
    std::string problem;  // why it cannot be read, or its plug-in fails; empty: it is good
    bool several_machines = false;
    std::string handle = "simulated", fingertip = "simulated";  // [handle] device, [cutaneous] device
    bool window = false;                                        // [visual] display
    std::string energy{};                                       // energy_warning()
    bool human = false;                                         // [session] subject
    bool beep_shown = false;                                    // [visual] beep_shown = "always"
    bool cutaneous_drawn =
        true;  // CF and CCF reach a person: by a device, as a picture, or the session has neither
    std::string software_problem{};    // of a device: its SDK, its firmware or its program cannot be used
    std::string middleware_problem{};  // of TouchDIVERs: no program listens at its port, and why
    std::string can_bus{};  // of motor drives; empty: there are none, or their bus is reached over UDP
    ExitCode problem_code{ExitCode::kUsage};
};

struct ProtectionFacts {
    std::string mode = "user-key";  // [security] mode
    std::string problem;            // why thimble run refuses it, or cannot use the key; empty: it can
    ExitCode code = ExitCode::kUsage;
    std::string remedy{};  // one command
};

struct RealtimeFacts {
    bool wanted = true;   // [runtime] realtime_scheduling
    bool granted = true;  // SCHED_FIFO was asked for and given
    int priority = 60;
    long hard_limit = 0;  // ulimit -H -r; negative: none
};

// Lateness of absolute deadlines, one each period_s.
struct TimerFacts {
    double period_s = 0.001;
    std::uint64_t wake_ups = 0;  // 0: not measured
    double median_s = 0, p99_s = 0, allowed_s = 0, worst_s = 0;
    double allowed_miss_fraction = 0.001;  // allowed_s: this share was later
};

struct ProcessorFacts {
    unsigned processors = 1;
    std::vector<std::string> governors;  // different ones; empty: the frequency is not the kernel's to choose
    std::string clock_source;
    std::vector<std::string> clock_sources;  // to choose from
};

struct KernelFacts {
    std::string release, preemption;
    double timer_resolution_s = 1e-9;
    bool can = false, hidraw = false;
};

struct ClockFacts {
    bool known = false, synchronised = false;
    double error_bound_s = 0;  // the kernel's own, of a synchronised clock
    std::string chrony;        // what it says itself
};

struct TakenPort {
    std::uint16_t port = 0;
    long process = 0;     // 0: not to be seen by this user
    std::string program;  // its name
};
struct PortFacts {
    std::uint16_t first = 27000, count = 0;
    std::vector<TakenPort> taken;
    bool loopback_passes = true;  // a datagram to 127.0.0.1 came back
};

enum class FirewallKind : std::uint8_t { kNone, kUfw, kFirewalld, kNftables };
struct FirewallFacts {
    FirewallKind kind = FirewallKind::kNone;
    std::string chain;  // kNftables: "inet filter input"
};

struct ProgramFacts {
    struct Program {
        std::string name;
        std::string version;  // empty: not there, or does not start
    };
    std::string own_version, folder;
    std::vector<Program> nodes;
    std::string gnuplot;   // version; empty: not there
    std::string system;    // "Debian GNU/Linux 12 (bookworm)"
    std::string python{};  // version of the thimble that python3 imports; empty: none
};

enum class DeviceUse : std::uint8_t { kHidHand, kForceDimension, kFalcon, kFingertipBoard, kUnusable };
struct DeviceFacts {
    struct Device {
        DeviceUse use = DeviceUse::kUnusable;
        std::string name;  // "SpaceMouse Compact (256f:c635)"
        std::string node;  // "/dev/hidraw0"
        bool accessible = false;
    };
    std::vector<Device> devices;
    std::vector<std::string> rules;  // of ours that are installed, file names
};

struct CanFacts {
    struct Interface {
        std::string name;
        bool up = false;
        int queue_frames = 0;  // that wait to be sent, at most; 0: not known
    };
    std::vector<Interface> interfaces;
};

struct Ros2Facts {
    struct Interface {
        std::string address;  // [handle.ros2] or [slave_sim.ros2] interface
        std::string name;     // "eth0"; empty: no interface of this machine has the address
        bool up = false, multicast = false;
    };
    bool wanted = false;  // a device of the session is one of ROS 2
    std::vector<Interface> interfaces;
    std::string domain, domain_problem;  // ROS_DOMAIN_ID
    std::string rmw;                     // RMW_IMPLEMENTATION
};

struct ScreenFacts {
    bool built = true;    // THIMBLE_GUI
    std::string problem;  // empty: a window with OpenGL could be opened
    std::string renderer, version;
};

struct SoundFacts {
    bool built = true;
    std::string problem;  // empty: there is a device
};

struct Facts {
    SessionFacts session;
    ProgramFacts programs;
    PortFacts ports;
    FirewallFacts firewall;
    RealtimeFacts realtime;
    TimerFacts timer;
    ProcessorFacts processors;
    KernelFacts kernel;
    ClockFacts clock;
    DeviceFacts devices;
    CanFacts can;
    Ros2Facts ros2{};
    ScreenFacts screen;
    SoundFacts sound;
    ProtectionFacts protection{};
};

// Looks at the machine for the doctor. Files are read below a folder, which is "/" except in tests. It changes
// nothing and needs no root. Unreadable facts keep their default.
//
// Files of /proc and /sys below `root`.
ProcessorFacts gather_processors(const std::filesystem::path& root);
KernelFacts gather_kernel(const std::filesystem::path& root);
CanFacts gather_can(const std::filesystem::path& root);
FirewallFacts gather_firewall(const std::filesystem::path& root);
DeviceFacts gather_devices(const std::filesystem::path& root);

// Asked of the kernel. The timer is measured in a thread of its own, with the scheduling that a node would get.
void gather_time(const ConfigFile& file, double seconds_s, RealtimeFacts& realtime, TimerFacts& timer);
ClockFacts gather_clock();
// All ports of as many conditions as the session has, on every address of this machine.
PortFacts gather_ports(std::uint16_t base_port, unsigned conditions);
// Starts each node of `folder` with --version.
ProgramFacts gather_programs(const std::filesystem::path& folder);
// The facts of a session file. It loads the handle's SDK and reads its firmware.
void gather_session(const ConfigFile& file, const SystemSettings& settings, SessionFacts& facts);
// Connects to the services of the session's devices, which another session may use: for thimble doctor alone.
void gather_services(const SystemSettings& settings, SessionFacts& facts);
// Reads the key that the session's programs need, as they do, and makes none. A lab key hides this process's memory.
ProtectionFacts gather_protection(const NetworkSettings& network, const SystemSettings& settings);
// The interfaces of the session's ROS 2 devices, 127.0.0.1 without one, and what the environment says to ROS 2.
Ros2Facts gather_ros2(const ConfigFile& file, const SystemSettings& settings);
ScreenFacts gather_screen();
SoundFacts gather_sound();

// The chain of `nft list ruleset`'s words that hears incoming packets and drops by default; empty: none.
std::string dropping_chain(const std::string& ruleset);
// Lines of /proc/net/udp that listen at `port`: their sockets' inodes.
std::vector<std::string> udp_inodes(const std::string& table, std::uint16_t port);

}  // namespace thimble
