#include "netem/shell/program_room.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/runtime/udp_socket.hpp"
#include "netem/shell/device_stamps.hpp"

namespace thimble {
namespace {

constexpr const char* kDeviceName = "link";
constexpr std::size_t kLongestMessageBytes = 8192;

// A message between the two processes: its kind, a number, and text or a descriptor.
struct Note {
    char kind = 0;  // 'd' device, 'e' error, 's' start; 0: the other side has closed
    std::uint8_t number = 0;
    std::string text{};
    std::array<int, 3> descriptors{-1, -1, -1};  // all or none
};

constexpr std::size_t kDescriptorBytes = sizeof Note::descriptors;
union DescriptorSpace {
    cmsghdr head;
    std::array<char, CMSG_SPACE(kDescriptorBytes)> bytes;
};

void send_note(int line, const Note& note) {
    std::string words{note.kind, static_cast<char>(note.number)};
    words += note.text;
    iovec part{words.data(), std::min(words.size(), kLongestMessageBytes)};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    DescriptorSpace space{};
    if (note.descriptors[0] >= 0) {
        message.msg_control = &space;
        message.msg_controllen = sizeof space;
        cmsghdr* head = CMSG_FIRSTHDR(&message);
        head->cmsg_level = SOL_SOCKET;
        head->cmsg_type = SCM_RIGHTS;
        head->cmsg_len = CMSG_LEN(kDescriptorBytes);
        std::memcpy(CMSG_DATA(head), note.descriptors.data(), kDescriptorBytes);
    }
    sendmsg(line, &message, MSG_NOSIGNAL);
}

Note read_note(int line) {
    std::vector<char> words(kLongestMessageBytes);
    iovec part{words.data(), words.size()};
    msghdr message{};
    DescriptorSpace space{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = &space;
    message.msg_controllen = sizeof space;
    const auto size = recvmsg(line, &message, MSG_CMSG_CLOEXEC);
    if (size < 2) return {};
    Note note{words[0], static_cast<std::uint8_t>(words[1]),
              std::string(words.data() + 2, static_cast<std::size_t>(size) - 2)};
    if (const cmsghdr* head = CMSG_FIRSTHDR(&message); head != nullptr && head->cmsg_type == SCM_RIGHTS)
        std::memcpy(note.descriptors.data(), CMSG_DATA(head), kDescriptorBytes);
    return note;
}

bool write_map(const char* file, const std::string& text) {
    std::ofstream map(file);
    map << text << std::flush;
    return static_cast<bool>(map);
}

// Root needs no user namespace, unless a container has taken its rights.
void enter_namespaces() {
    constexpr int kOwn = CLONE_NEWNET | CLONE_NEWNS;
    if (unshare(kOwn) == 0) return;
    const uid_t user = geteuid();
    const gid_t group = getegid();
    if (unshare(CLONE_NEWUSER | kOwn) != 0) {
        const std::string why = std::strerror(errno);
        throw Error(ExitCode::kNetwork, "cannot make a network namespace: {}; {}", why, namespace_remedy());
    }
    write_map("/proc/self/setgroups", "deny");
    if (!write_map("/proc/self/uid_map", fmt::format("{0} {0} 1", user)) ||
        !write_map("/proc/self/gid_map", fmt::format("{0} {0} 1", group))) {
        throw Error(ExitCode::kNetwork, "cannot map the user into a namespace: {}", namespace_remedy());
    }
}

// Over /etc/resolv.conf, for this namespace only: the outer one may name a server on this machine's loopback. Where that fails
// programs ask the servers that are named outside.
void name_server_is(const std::string& address) {
    // Where "/" is no mount, as in a chroot, this fails: then the file would stand in the outer namespace too.
    if (mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0) return;
    std::string file = temporary_folder() + "/thimble-resolv-XXXXXX";
    const int opened = mkstemp(file.data());
    if (opened < 0) return;
    const std::string line = "nameserver " + address + "\n";
    const bool written = write(opened, line.data(), line.size()) > 0 && fchmod(opened, 0644) == 0;
    if (written) mount(file.c_str(), "/etc/resolv.conf", nullptr, MS_BIND, nullptr);
    close(opened);
    unlink(file.c_str());
}

void reset_signals() {
    for (const int number : {SIGPIPE, SIGXFSZ, SIGCHLD}) std::signal(number, SIG_DFL);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
}

// KEY=VALUE, each ended by a zero.
void take_environment(const std::string& text) {
    for (std::size_t at = 0; at < text.size(); at += std::strlen(text.c_str() + at) + 1) {
        const std::string line = text.c_str() + at;
        const std::size_t middle = line.find('=');
        setenv(line.substr(0, middle).c_str(), line.substr(middle + 1).c_str(), 1);
    }
}

void start_program(const RoomSettings& settings) {
    if (!settings.own_input) {
        const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
        dup2(nothing, STDIN_FILENO);
    }
    std::vector<char*> words;
    words.reserve(settings.command.size() + 1);
    for (const std::string& word : settings.command)
        words.push_back(const_cast<char*>(word.c_str()));  // NOLINT
    words.push_back(nullptr);
    reset_signals();
    execvp(words[0], words.data());
    throw Error(ExitCode::kUsage, "cannot start '{}': {}", settings.command[0], std::strerror(errno));
}

// The new process, until it becomes the program.
void live_in_room(const RoomSettings& settings, int line) {
    enter_namespaces();
    const int device = open_tun(kDeviceName);
    configure_namespace();
    const bool has_ip6 = configure_tun(kDeviceName, settings.addresses, true);
    if (!settings.name_server.empty()) name_server_is(settings.name_server);
    // The device stands in for a descriptor that is not there: the note has all three.
    const int stamps = open_stamp_socket(kDeviceName);
    const UdpSocket own = settings.command.empty() ? UdpSocket::listening({}) : UdpSocket();
    send_note(line, {.kind = 'd',
                     .number = static_cast<std::uint8_t>(has_ip6),
                     .descriptors = {device, stamps < 0 ? device : stamps,
                                     own.descriptor() < 0 ? device : own.descriptor()}});
    const Note start = read_note(line);
    if (start.kind != 's') return;
    take_environment(start.text);
    start_program(settings);
}

[[noreturn]] void be_child(const RoomSettings& settings, int line) {
    prctl(PR_SET_PDEATHSIG, SIGKILL, 0UL, 0UL, 0UL);
    try {
        live_in_room(settings, line);
    } catch (const Error& error) {
        send_note(line,
                  {.kind = 'e', .number = static_cast<std::uint8_t>(error.code()), .text = error.what()});
    } catch (const std::exception& error) {
        send_note(line, {.kind = 'e', .number = 1, .text = error.what()});
    }
    _exit(1);
}

}  // namespace

ProgramRoom::ProgramRoom(const RoomSettings& settings) {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
        throw Error(ExitCode::kRunFailed, "cannot make a socket pair: {}", std::strerror(errno));
    pid_ = fork();
    if (pid_ == 0) {
        close(ends[0]);  // else it would not notice that this process has closed the line
        be_child(settings, ends[1]);
    }
    line_ = ends[0];
    close(ends[1]);
    try {
        if (pid_ < 0) throw Error(ExitCode::kRunFailed, "cannot start a process: {}", std::strerror(errno));
        hear_of_device();
    } catch (const Error&) {
        close(line_);
        if (pid_ > 0) waitpid(pid_, nullptr, 0);
        throw;
    }
}

ProgramRoom::~ProgramRoom() {
    close(device_);
    close(stamps_);
    close(socket_);
    if (line_ >= 0) close(line_);
}

void ProgramRoom::hear_of_device() {
    const Note note = read_note(line_);
    if (note.kind == 'e') throw Error(static_cast<ExitCode>(note.number), note.text);
    if (note.kind != 'd' || note.descriptors[0] < 0)
        throw Error(ExitCode::kRunFailed, "the process that makes the namespace has ended");
    device_ = note.descriptors[0];
    stamps_ = note.descriptors[1];
    socket_ = note.descriptors[2];
    has_ip6_ = note.number != 0;
}

void ProgramRoom::start(const Environment& environment) {
    std::string text;
    for (const auto& [key, value] : environment) {
        text += fmt::format("{}={}", key, value);
        text += '\0';
    }
    send_note(line_, {.kind = 's', .text = text});
    // The program closes the line by starting.
    if (const Note note = read_note(line_); note.kind == 'e')
        throw Error(static_cast<ExitCode>(note.number), note.text);
    close(line_);
    line_ = -1;
}

}  // namespace thimble
