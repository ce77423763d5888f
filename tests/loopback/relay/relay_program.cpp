#include "tests/loopback/relay/relay_program.hpp"

#include <arpa/inet.h>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <poll.h>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

#include "common/runtime/wall_clock.hpp"
#include "netem/relay/datagram_batch.hpp"

namespace thimble {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{2};

bool readable(const UdpSocket& socket, Duration patience) {
    pollfd wanted{socket.descriptor(), POLLIN, 0};
    return poll(&wanted, 1, static_cast<int>(patience / std::chrono::milliseconds{1})) > 0;
}

void send(const UdpSocket& socket, Bytes bytes, const UdpAddress* to) {
    SendBatch batch;
    batch.add(bytes, to);
    batch.send(socket.descriptor());
}

void redirect(const std::string& path, int descriptor) {
    const int file = open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    dup2(file, descriptor);
}

}  // namespace

UdpAddress loopback() { return {htonl(INADDR_LOOPBACK), 0}; }

Folder::Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "thimble-relay-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
    path_ = pattern;
}

Folder::~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::string read_text(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

NetemProgram::NetemProgram(const std::vector<std::string>& arguments) {
    const std::string program = (std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-netem").string();
    const std::string out = folder_ / "out", err = folder_ / "err";
    std::vector<char*> words{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    redirect(out, STDOUT_FILENO);
    redirect(err, STDERR_FILENO);
    execv(program.c_str(), words.data());
    _exit(127);
}

NetemProgram::~NetemProgram() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
}

void NetemProgram::signal(int number) const { kill(pid_, number); }

int NetemProgram::wait() {
    int status = 0;
    for (const SessionTime end = wall_now() + kPatience; waitpid(pid_, &status, WNOHANG) == 0;
         wall_sleep(kLook)) {
        if (wall_now() > end) return -1;
    }
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

UdpAddress NetemProgram::inlet(int n) {
    const std::string mark = "ready: UDP ";
    for (const SessionTime end = wall_now() + kPatience; wall_now() < end; wall_sleep(kLook)) {
        const std::string words = said();
        std::size_t at = words.find(mark);
        for (int i = 0; i < n && at != std::string::npos; ++i) at = words.find(mark, at + 1);
        if (at == std::string::npos || words.find('\n', at) == std::string::npos) continue;
        at += mark.size();
        return read_udp_address(words.substr(at, words.find(' ', at) - at), "its own words");
    }
    throw std::runtime_error("not ready: " + said());
}

Ended run_netem(const std::vector<std::string>& arguments) {
    NetemProgram program(arguments);
    const int code = program.wait();
    return {code, program.printed(), program.said()};
}

EchoServer::EchoServer() : socket_(UdpSocket::listening(loopback())) {
    thread_ = std::thread([this] {
        ReceiveBatch batch;
        while (!stop_) {
            if (!readable(socket_, std::chrono::milliseconds{20})) continue;
            const std::size_t count = batch.receive(socket_.descriptor());
            for (std::size_t i = 0; i < count; ++i) {
                const auto datagram = batch[i];
                send(socket_, datagram.bytes, &datagram.from);
            }
        }
    });
}

EchoServer::~EchoServer() {
    stop_ = true;
    thread_.join();
}

void Client::say(const std::string& words) const {
    send(socket_, {reinterpret_cast<const std::uint8_t*>(words.data()), words.size()}, nullptr);
}

std::optional<std::string> Client::hear(Duration patience) const {
    // One at a time: what else waits is for the next call.
    std::string words(65536, '\0');
    if (!readable(socket_, patience)) return std::nullopt;
    const auto size = recv(socket_.descriptor(), words.data(), words.size(), 0);
    if (size < 0) return std::nullopt;
    words.resize(static_cast<std::size_t>(size));
    return words;
}

std::optional<Duration> Client::round_trip(const std::string& words) const {
    const SessionTime start = wall_now();
    say(words);
    if (hear() != words) return std::nullopt;
    return wall_now() - start;
}

}  // namespace thimble
