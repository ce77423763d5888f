#include "netem/shell/uplink.hpp"

#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <ifaddrs.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/own_program.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/shell/ip_packet.hpp"

namespace thimble {
namespace {

constexpr int kMostHostDevices = 250;
constexpr int kConnectTries = 300;
constexpr Duration kConnectPause = std::chrono::milliseconds{10};
constexpr int kFrameBuffer = 4 << 20;  // bytes, as far as the system allows
constexpr std::size_t kMostFolderCharacters = sizeof(sockaddr_un::sun_path) - sizeof "/slirp";

std::string ip4_of(int number, int host) { return fmt::format("10.77.{}.{}", number, host); }
std::string ip6_of(int number, int host) { return fmt::format("fd77:0:0:{:x}::{}", number + 1, host); }

std::vector<std::uint8_t> bytes_of(int family, const std::string& text) {
    std::vector<std::uint8_t> bytes(family == AF_INET ? 4 : 16);
    inet_pton(family, text.c_str(), bytes.data());
    return bytes;
}

// Whether an interface of this machine has the network already.
bool is_taken(int number) {
    ifaddrs* list = nullptr;
    if (getifaddrs(&list) != 0) return false;
    const auto wanted = bytes_of(AF_INET, ip4_of(number, 0));
    bool taken = false;
    for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
        if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
        sockaddr_in address{};
        std::memcpy(&address, entry->ifa_addr, sizeof address);
        taken = taken || std::memcmp(&address.sin_addr, wanted.data(), 3) == 0;
    }
    freeifaddrs(list);
    return taken;
}

// Its standard input is the pipe: at its end slirp4netns leaves. A group of its own, so that Ctrl-C does not end it.
[[noreturn]] void be_slirp(int life_line, const std::string& path) {
    setpgid(0, 0);
    dup2(life_line, STDIN_FILENO);
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) dup2(nothing, stream);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    execlp("slirp4netns", "slirp4netns", "--target-type=bess", "--enable-ipv6", "--mtu=1500", "--exit-fd=0",
           path.c_str(), static_cast<char*>(nullptr));
    _exit(127);
}

}  // namespace

Uplink::Uplink() {
    const std::string refusal = geteuid() == 0 ? open_host_device() : "or run as root";
    start_slirp();
    if (frames_ < 0 && host_ < 0) {
        throw Error(
            ExitCode::kNetwork,
            "the namespace cannot reach the network: install slirp4netns (apt install slirp4netns), {}",
            refusal);
    }
}

Uplink::~Uplink() {
    for (const int descriptor : {life_line_, frames_, host_, host_stamps_}) {
        if (descriptor >= 0) close(descriptor);
    }
    if (slirp_ < 0) return;
    kill(slirp_, SIGKILL);
    waitpid(slirp_, nullptr, 0);
}

void Uplink::start_slirp() {
    std::string folder = temporary_folder() + "/thimble-XXXXXX";
    if (folder.size() > kMostFolderCharacters)
        throw Error(ExitCode::kUsage,
                    "TMPDIR: '{}' is {} characters too long for a socket: set a shorter one",
                    temporary_folder(), folder.size() - kMostFolderCharacters);
    std::array<int, 2> pipe_ends{};
    if (mkdtemp(folder.data()) == nullptr || pipe2(pipe_ends.data(), O_CLOEXEC) != 0)
        throw Error(ExitCode::kRunFailed, "cannot make a folder in the place of temporary files: {}",
                    std::strerror(errno));
    const std::string path = folder + "/slirp";
    slirp_ = fork();
    if (slirp_ == 0) be_slirp(pipe_ends[0], path);
    close(pipe_ends[0]);
    life_line_ = pipe_ends[1];
    connect_slirp(path);
    unlink(path.c_str());
    rmdir(folder.c_str());
}

// It listens a moment after it has started; without the program it ends at once.
void Uplink::connect_slirp(const std::string& path) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    path.copy(name.sun_path, sizeof name.sun_path - 1);
    const int line = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    for (const int option : {SO_SNDBUF, SO_RCVBUF})
        setsockopt(line, SOL_SOCKET, option, &kFrameBuffer, sizeof kFrameBuffer);
    for (int i = 0; slirp_ > 0 && i < kConnectTries; ++i) {
        if (connect(line, static_cast<sockaddr*>(static_cast<void*>(&name)), sizeof name) == 0) {
            fcntl(line, F_SETFL, O_NONBLOCK);
            announce_addresses(frames_ = line);
            return;
        }
        if (waitpid(slirp_, nullptr, WNOHANG) == slirp_) slirp_ = -1;
        wall_sleep(kConnectPause);
    }
    close(line);
}

// The first number that neither another shell nor this machine's network has.
std::string Uplink::open_host_device() {
    try {
        for (int number = 0; host_ < 0 && number < kMostHostDevices; ++number) {
            if (is_taken(number)) continue;
            const std::string name = fmt::format("thimble{}", number);
            host_ = open_tun(name);
            host_number_ = number;
            if (host_ < 0) continue;
            host_has_ip6_ = configure_tun(name, {{ip4_of(number, 1), ip6_of(number, 1), 30, 64}}, false);
            host_stamps_ = open_stamp_socket(name);
        }
    } catch (const Error& error) {  // root of a container without rights to its network: as any other user
        if (host_ >= 0) close(std::exchange(host_, -1));
        return fmt::format("or, as root, remove this cause: {}", error.what());
    }
    return "or remove devices: the networks from 10.77.0.0 on are all taken";
}

std::string Uplink::host_ip4() const { return host_ >= 0 ? ip4_of(host_number_, 1) : kSlirpHost4; }

std::string Uplink::host_ip6() const {
    return host_ >= 0 && host_has_ip6_ ? ip6_of(host_number_, 1) : kSlirpHost6;
}

std::vector<TunAddress> Uplink::program_addresses() const {
    std::vector<TunAddress> addresses;
    if (frames_ >= 0) addresses.push_back({kSlirpOwn4, kSlirpOwn6, 24, 64});
    if (host_ >= 0) addresses.push_back({ip4_of(host_number_, 2), ip6_of(host_number_, 2), 30, 64});
    return addresses;
}

std::string Uplink::name_server() const { return frames_ >= 0 ? kSlirpDns4 : ""; }

std::vector<PacketPort> Uplink::ports() const {
    std::vector<PacketPort> ports;
    if (host_ >= 0)
        ports.push_back({host_, host_stamps_, false, bytes_of(AF_INET, ip4_of(host_number_, 1)),
                         bytes_of(AF_INET6, ip6_of(host_number_, 1))});
    if (frames_ >= 0) ports.push_back({frames_, -1, true});
    return ports;
}

Environment Uplink::environment(bool has_ip6) const {
    Environment environment{{"THIMBLE_HOST", host_ip4()}};
    if (has_ip6 && (frames_ >= 0 || host_has_ip6_)) environment.emplace_back("THIMBLE_HOST6", host_ip6());
    return environment;
}

}  // namespace thimble
