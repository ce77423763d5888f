// Facts from the running kernel and from other programs.
#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <ifaddrs.h>
#include <net/if.h>
#include <sstream>
#include <sys/resource.h>
#include <sys/timex.h>
#include <thread>
#include <tuple>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/own_program.hpp"
#include "common/process/child.hpp"
#include "common/ros2_settings.hpp"
#include "common/runtime/event_waiter.hpp"
#include "common/runtime/protection.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/runtime_settings.hpp"
#include "common/runtime/tcp_client.hpp"
#include "common/runtime/udp_channel.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/security/lab_key_file.hpp"
#include "common/text_file.hpp"
#include "common/version.hpp"
#include "master/devices/force_dimension/dhd_library.hpp"
#include "master/devices/haply/haply_handle.hpp"
#include "master/devices/touch/hd_library.hpp"
#include "session/clocks/chrony.hpp"
#include "session/launch/node_kinds.hpp"
#include "session/launch/remote_script.hpp"
#include "session/launch/ros2_programs.hpp"
#include "session/settings/system_settings.hpp"
#include "thimble/doctor/facts.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

// A second try, since the kernel may drop any datagram.
bool comes_back(std::uint16_t port) {
    UdpChannel in(Endpoint{"127.0.0.1", port}, {"127.0.0.1", 0});
    UdpChannel out(std::nullopt, {"127.0.0.1", port});
    constexpr std::array<std::uint8_t, 4> kWord{'e', 'c', 'h', 'o'};
    for (int attempt = 0; attempt < 2; ++attempt) {
        out.send(kWord);
        for (int look = 0; look < 50; ++look) {
            if (!in.receive().empty()) return true;
            wall_sleep(std::chrono::milliseconds{1});
        }
    }
    return false;
}

bool loopback_passes() {
    for (std::uint16_t port = 30000; port < 32768; ++port) {
        try {
            return comes_back(port);
        } catch (const Error&) {  // taken: another one
        }
    }
    return false;
}

bool is_free(std::uint16_t port) {
    try {
        const UdpChannel probe(Endpoint{"0.0.0.0", port}, {"127.0.0.1", 0});
        return true;
    } catch (const Error&) {
        return false;
    }
}

// The first process of this user's that has one of the sockets.
TakenPort with_holder(std::uint16_t port, const std::vector<std::string>& inodes) {
    TakenPort taken{port, 0, ""};
    std::error_code error;
    for (const auto& process : fs::directory_iterator("/proc", error)) {
        const std::string number = process.path().filename().string();
        if (number.find_first_not_of("0123456789") != std::string::npos) continue;
        std::error_code unseen;
        for (const auto& open : fs::directory_iterator(process.path() / "fd", unseen)) {
            const std::string target = fs::read_symlink(open.path(), unseen).string();
            for (const std::string& inode : inodes) {
                if (target != "socket:[" + inode + "]") continue;
                taken.process = std::stol(number);
                std::ifstream name(process.path() / "comm");
                std::getline(name, taken.program);
                return taken;
            }
        }
    }
    return taken;
}

// Empty if it cannot be started.
std::string version_line(const std::string& program, const std::vector<std::string>& options) {
    try {
        const ProgramResult result = run_program(program, options, ".", "");
        return result.exit_code == 0 ? result.output.substr(0, result.output.find('\n')) : "";
    } catch (const Error&) {
        return "";
    }
}

std::string system_name() {
    const std::string text = read_text_file("/etc/os-release"), key = "PRETTY_NAME=\"";
    const std::size_t at = text.find(key);
    if (at == std::string::npos) return "";
    const std::size_t start = at + key.size();
    return text.substr(start, text.find('"', start) - start);
}

}  // namespace

void gather_time(const ConfigFile& file, double seconds_s, RealtimeFacts& realtime, TimerFacts& timer) {
    const RuntimeSettings runtime = read_runtime_settings(file);
    realtime.wanted = runtime.realtime_scheduling;
    realtime.priority = runtime.priority;
    rlimit limit{};
    if (getrlimit(RLIMIT_RTPRIO, &limit) == 0)
        realtime.hard_limit = limit.rlim_max == RLIM_INFINITY ? -1 : static_cast<long>(limit.rlim_max);
    timer.allowed_miss_fraction = runtime.allowed_miss_fraction;
    std::thread measuring([&] {
        realtime.granted = ask_for_realtime(runtime).empty();
        const Histogram lateness = measure_timer(from_seconds(timer.period_s), from_seconds(seconds_s));
        timer.wake_ups = lateness.count();
        timer.median_s = to_seconds(lateness.quantile(0.5));
        timer.p99_s = to_seconds(lateness.quantile(0.99));
        timer.allowed_s = to_seconds(lateness.quantile(1 - runtime.allowed_miss_fraction));
        timer.worst_s = to_seconds(lateness.worst());
    });
    measuring.join();
}

ClockFacts gather_clock() {
    ClockFacts facts;
    timex words{};
    const int state = adjtimex(&words);
    facts.known = state >= 0;
    facts.synchronised = state >= 0 && state != TIME_ERROR && (words.status & STA_UNSYNC) == 0;
    facts.error_bound_s = 1e-6 * static_cast<double>(words.maxerror);
    facts.chrony = describe_chrony();
    return facts;
}

PortFacts gather_ports(std::uint16_t base_port, unsigned conditions) {
    PortFacts facts;
    facts.first = base_port;
    facts.count =
        static_cast<std::uint16_t>(std::min<std::size_t>(conditions * kPortCount, 65536U - base_port));
    facts.loopback_passes = loopback_passes();
    // A socket of IPv6 has the port of IPv4 too.
    const std::string table = read_text_file("/proc/net/udp") + read_text_file("/proc/net/udp6");
    for (unsigned i = 0; i < facts.count; ++i) {
        const auto port = static_cast<std::uint16_t>(base_port + i);
        if (is_free(port)) continue;
        // Looking for its owner takes a while; one name is enough.
        facts.taken.push_back(facts.taken.size() < 3
                                  ? with_holder(port, udp_inodes(table, port))
                                  : TakenPort{port, facts.taken[0].process, facts.taken[0].program});
    }
    return facts;
}

ProgramFacts gather_programs(const fs::path& folder) {
    ProgramFacts facts;
    facts.own_version = kVersion;
    facts.folder = folder.string();
    for (const NodeKind& node : kNodes)
        facts.nodes.push_back({node.program, version_line((folder / node.program).string(), {"--version"})});
    facts.gnuplot = version_line("gnuplot", {"--version"});
    facts.python = version_line("python3", {"-P", "-c", "import thimble; print(thimble.__version__)"});
    facts.system = system_name();
    return facts;
}

namespace {

std::string in_one_line(const Error& error) {
    std::string words = error.what();
    std::replace(words.begin(), words.end(), '\n', ' ');
    return words;
}

// Empty: the devices have what they need, or need nothing.
std::string software_problem(const SystemSettings& settings) {
    const HandleSettings& handle = settings.handle;
    const std::string& firmware = handle.falcon.firmware;
    if (handle.kind == HandleKind::kFalcon && !firmware.empty()) {
        const std::string sum = sha256_of_file(firmware);
        if (sum.empty()) return fmt::format("[handle.falcon] firmware: {} cannot be read", firmware);
        if (sum != handle.falcon.firmware_sha256)
            return fmt::format(
                "[handle.falcon] firmware: the SHA-256 of {} is {}, not the one in the session file",
                firmware, sum);
    }
    try {
        for (const Ros2Program& ros2 : ros2_programs(settings)) path_of(ros2);
        if (handle.kind == HandleKind::kForceDimension) DhdLibrary(handle.force_dimension.library).file();
        if (handle.kind == HandleKind::kTouch) HdLibrary(handle.touch.library).file();
    } catch (const Error& error) {
        return in_one_line(error);
    }
    return "";
}

// Empty: the service has the device, or the session needs none.
std::string haply_problem(const HandleSettings& handle) {
    if (handle.kind != HandleKind::kHaply) return "";
    try {
        HaplyExchange(handle.haply).name();
    } catch (const Error& error) {
        return in_one_line(error);
    }
    return "";
}

// Empty: a program listens there, or the session needs none.
std::string middleware_problem(const CutaneousSettings& cutaneous) {
    if (cutaneous.device != FingertipDevice::kTouchDiver) return "";
    const auto& [host, port] = std::tie(cutaneous.touchdiver.host, cutaneous.touchdiver.port);
    try {
        TcpClient client({host, port}, "check [cutaneous.touchdiver] host");
        client.connect();
        const SessionTime end = wall_now() + std::chrono::seconds{1};
        while (client.state() == ByteStream::State::kConnecting && wall_now() < end)
            wall_sleep(std::chrono::milliseconds{2});
        if (client.state() == ByteStream::State::kOpen) return "";
        const bool silent = client.state() == ByteStream::State::kConnecting;
        return fmt::format("no program listens at TCP {}:{} ({})", host, port,
                           silent ? "no answer in 1 s" : client.why());
    } catch (const Error& error) {
        return error.what();
    }
}

// Of a lab key that is not there, or of a key that is not good.
std::string key_remedy(const SecuritySettings& security) {
    const bool user_key = security.mode == SecurityMode::kUserKey;
    const fs::path key = user_key ? user_key_file() : lab_key_file(security.key_file);
    std::error_code none;
    return (user_key || fs::exists(key, none) ? "ls -l " : "thimble keygen ") + shell_word(key.string());
}

Ros2Facts::Interface interface_at(const std::string& address) {
    Ros2Facts::Interface found{address, "", false, false};
    ifaddrs* list = nullptr;
    if (getifaddrs(&list) != 0) return found;
    for (const ifaddrs* at = list; at != nullptr; at = at->ifa_next) {
        if (at->ifa_addr == nullptr || at->ifa_addr->sa_family != AF_INET) continue;
        std::array<char, INET_ADDRSTRLEN> text{};
        sockaddr_in own{};
        std::memcpy(&own, at->ifa_addr, sizeof own);
        inet_ntop(AF_INET, &own.sin_addr, text.data(), text.size());
        if (address != text.data()) continue;
        // Linux does not claim multicast for the loopback interface, but has it.
        const bool multicast = (at->ifa_flags & (IFF_MULTICAST | IFF_LOOPBACK)) != 0;
        found = {address, at->ifa_name, (at->ifa_flags & IFF_UP) != 0, multicast};
    }
    freeifaddrs(list);
    return found;
}

}  // namespace

void gather_session(const ConfigFile& file, const SystemSettings& settings, SessionFacts& facts) {
    file.table("handle").read("device", facts.handle, "");
    file.table("cutaneous").read("device", facts.fingertip, "");
    const DriveSettings& drives = settings.cutaneous.drives;
    if (settings.cutaneous.device == FingertipDevice::kDrives && !drives.cannelloni)
        facts.can_bus = drives.bus;
    facts.window = settings.visual.window;
    facts.human = settings.plan.kind == SubjectKind::kHuman;
    facts.beep_shown = settings.visual.beep_shown == BeepShown::kAlways;
    const auto& modalities = settings.plan.modalities;
    const bool cutaneous = std::any_of(modalities.begin(), modalities.end(), [](Modality modality) {
        return modality == Modality::kCF || modality == Modality::kCCF;
    });
    facts.cutaneous_drawn =
        !cutaneous || settings.visual.fingertip || settings.cutaneous.device != FingertipDevice::kSimulated;
    facts.software_problem = software_problem(settings);
}

void gather_services(const SystemSettings& settings, SessionFacts& facts) {
    if (facts.software_problem.empty()) facts.software_problem = haply_problem(settings.handle);
    facts.middleware_problem = middleware_problem(settings.cutaneous);
}

ProtectionFacts gather_protection(const NetworkSettings& network, const SystemSettings& settings) {
    const SecuritySettings& security = network.security;
    ProtectionFacts facts{std::string(to_string(security.mode)), "", ExitCode::kUsage, "thimble keygen"};
    try {
        require_protection(network);
        if (is_real(settings.handle.kind) || settings.slave.device != SlaveDevice::kSimulated)
            require_protection_of_handle(network);
        facts.remedy.clear();
        if (security.mode == SecurityMode::kNone) return facts;
        if (security.mode == SecurityMode::kUserKey && !has_user_key()) return facts;  // programs make it
        facts.remedy = key_remedy(security);
        make_security(network);
    } catch (const Error& error) {
        facts.problem = in_one_line(error);
        facts.code = error.code();
    }
    return facts;
}

Ros2Facts gather_ros2(const ConfigFile& file, const SystemSettings& settings) {
    Ros2Facts facts;
    facts.domain = environment_text("ROS_DOMAIN_ID");
    facts.rmw = environment_text("RMW_IMPLEMENTATION");
    try {
        ros2_domain();
    } catch (const Error& error) {
        facts.domain_problem = in_one_line(error);
    }
    std::vector<std::string> addresses;
    if (settings.handle.kind == HandleKind::kRos2)
        addresses.push_back(read_ros2_settings(file.table("handle").table("ros2")).interface);
    if (settings.slave.device == SlaveDevice::kRos2) addresses.push_back(settings.slave.ros2.interface);
    facts.wanted = !addresses.empty();
    if (addresses.empty()) addresses.push_back(Ros2Settings{}.interface);
    addresses.erase(std::unique(addresses.begin(), addresses.end()), addresses.end());
    facts.interfaces.reserve(addresses.size());
    for (const std::string& address : addresses) facts.interfaces.push_back(interface_at(address));
    return facts;
}

std::string dropping_chain(const std::string& ruleset) {
    std::istringstream lines(ruleset);
    std::string table, chain;
    for (std::string line; std::getline(lines, line);) {
        std::array<char, 64> first{}, second{};
        if (std::sscanf(line.c_str(), " table %63s %63s", first.data(), second.data()) == 2)
            table = fmt::format("{} {}", first.data(), second.data());
        if (std::sscanf(line.c_str(), " chain %63s", first.data()) == 1) chain = first.data();
        if (line.find("hook input") != std::string::npos && line.find("policy drop") != std::string::npos)
            return fmt::format("{} {}", table, chain);
    }
    return "";
}

// Columns: slot, local address:port, remote, state, queues, timer, retransmits, uid, timeout, inode.
std::vector<std::string> udp_inodes(const std::string& table, std::uint16_t port) {
    std::istringstream lines(table);
    std::vector<std::string> inodes;
    for (std::string line; std::getline(lines, line);) {
        unsigned local = 0;
        unsigned long inode = 0;
        if (std::sscanf(line.c_str(), " %*d: %*x:%x %*x:%*x %*x %*x:%*x %*x:%*x %*x %*u %*u %lu", &local,
                        &inode) == 2 &&
            local == port)
            inodes.push_back(std::to_string(inode));
    }
    return inodes;
}

}  // namespace thimble
