#include "tests/kernel/vhci_falcon.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

namespace thimble {

// Big-endian on the socket, 48 bytes; what stands behind the fifth word depends on the command.
struct VhciFalcon::Request {
    std::uint32_t command, sequence, device, inward, endpoint;
    std::uint32_t flags, length, start_frame, packets, interval;  // of an unlink: flags is whose
    std::array<std::uint8_t, 8> setup;
};

namespace {

constexpr std::uint32_t kSubmit = 1, kUnlink = 2, kSubmitted = 3, kUnlinked = 4;
constexpr int kFullSpeed = 2, kLatency_ms = 1;

const std::vector<std::uint8_t> kDevice{18, 1, 0, 2, 0, 0, 0, 64, 0x03, 0x04, 0x48, 0xcb, 0, 6, 0, 0, 1, 1};
const std::vector<std::uint8_t> kConfiguration{9,  2, 32, 0,    1,    1,    0, 0x80, 45, 9,    4,
                                               0,  0, 2,  0xff, 0xff, 0xff, 0, 7,    5,  0x81, 2,
                                               64, 0, 0,  7,    5,    0x02, 2, 64,   0,  0};
const std::vector<std::uint8_t> kSerial{6, 3, 'F', 0, '1', 0}, kLanguages{4, 3, 9, 4};

bool read_whole(int socket, void* to, std::size_t bytes) {
    return bytes == 0 || recv(socket, to, bytes, MSG_WAITALL) == static_cast<ssize_t>(bytes);
}

const std::vector<std::uint8_t>* descriptor(std::uint16_t value) {
    switch (value) {
        case 0x100:
            return &kDevice;
        case 0x200:
            return &kConfiguration;
        case 0x300:
            return &kLanguages;
        case 0x301:
            return &kSerial;
        default:
            return nullptr;
    }
}

}  // namespace

VhciFalcon::VhciFalcon(int port) {
    static_assert(sizeof(Request) == 48);
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) throw std::runtime_error("no socket pair");
    std::ofstream attach("/sys/devices/platform/vhci_hcd.0/attach");
    attach << port << ' ' << ends[1] << ' ' << 0x10000 + port + 1 << ' ' << kFullSpeed << std::endl;
    close(ends[1]);
    socket_ = ends[0];
    if (!attach) throw std::runtime_error("no vhci_hcd in this kernel, or its port is taken");
    thread_ = std::thread([this] { serve(); });
}

void VhciFalcon::unplug() {
    if (!thread_.joinable()) return;
    shutdown(socket_, SHUT_RDWR);
    thread_.join();
    close(socket_);
}

void VhciFalcon::serve() {
    for (;;) {
        pollfd ready{socket_, POLLIN, 0};
        const int events = poll(&ready, 1, kLatency_ms);
        const std::lock_guard lock(mutex_);
        if (events == 0) {
            feed_status();
        } else if (events < 0 || !take()) {
            return;
        }
    }
}

bool VhciFalcon::take() {
    Request request{};
    if (!read_whole(socket_, &request, sizeof request)) return false;
    for (std::uint32_t* word : {&request.command, &request.sequence, &request.inward, &request.endpoint,
                                &request.flags, &request.length})
        *word = ntohl(*word);
    if (request.command == kUnlink) {
        const auto found = std::find_if(waiting_in_.begin(), waiting_in_.end(), [&](const Waiting& waiting) {
            return waiting.sequence == request.flags;
        });
        const bool held = found != waiting_in_.end();
        if (held) waiting_in_.erase(found);
        reply(kUnlinked, request.sequence, held ? -ECONNRESET : 0, {}, 0);
        return true;
    }
    std::vector<std::uint8_t> data(request.inward == 0 ? request.length : 0);
    if (request.command != kSubmit || !read_whole(socket_, data.data(), data.size())) return false;
    submit(request, std::move(data));
    return true;
}

void VhciFalcon::submit(const Request& request, std::vector<std::uint8_t> data) {
    if (request.endpoint == 0) return control(request);
    if (request.inward == 0) {
        emulator_.receive(data);
        reply(kSubmitted, request.sequence, 0, {}, data.size());
    } else {
        waiting_in_.push_back({request.sequence, request.length});
    }
    feed();
}

void VhciFalcon::control(const Request& request) {
    const auto value = static_cast<std::uint16_t>(request.setup[2] | (request.setup[3] << 8));
    const bool inward = (request.setup[0] & 0x80) != 0, vendor = (request.setup[0] & 0x60) == 0x40;
    std::vector<std::uint8_t> answer;
    bool good = true;
    if (vendor) {
        good = !inward && emulator_.control(request.setup[1], value);
    } else if (inward && request.setup[1] == 6) {
        const auto* found = descriptor(value);
        good = found != nullptr;
        if (good) answer = *found;
    } else if (inward) {
        answer = {0, 0};
    }
    answer.resize(std::min<std::size_t>(answer.size(), request.length));
    reply(kSubmitted, request.sequence, good ? 0 : -EPIPE, answer, answer.size());
}

// Two bytes of the chip's own, then what the firmware says.
void VhciFalcon::feed() {
    while (!waiting_in_.empty() && emulator_.has_something()) {
        std::vector<std::uint8_t> packet{0x01, 0x60};
        const auto bytes = emulator_.transmit(waiting_in_.front().length - 2);
        packet.insert(packet.end(), bytes.begin(), bytes.end());
        reply(kSubmitted, waiting_in_.front().sequence, 0, packet, packet.size());
        waiting_in_.pop_front();
    }
}

// Nothing to say for a latency timer: the two bytes alone.
void VhciFalcon::feed_status() {
    if (waiting_in_.empty()) return;
    reply(kSubmitted, waiting_in_.front().sequence, 0, {0x01, 0x60}, 2);
    waiting_in_.pop_front();
}

void VhciFalcon::reply(std::uint32_t command, std::uint32_t sequence, int status,
                       const std::vector<std::uint8_t>& data, std::size_t length) {
    std::array<std::uint32_t, 12> head{};
    head[0] = htonl(command);
    head[1] = htonl(sequence);
    head[5] = htonl(static_cast<std::uint32_t>(status));
    head[6] = htonl(static_cast<std::uint32_t>(length));
    std::vector<std::uint8_t> bytes(sizeof head + data.size());
    std::memcpy(bytes.data(), head.data(), sizeof head);
    std::copy(data.begin(), data.end(), bytes.begin() + sizeof head);
    if (send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0)
        waiting_in_.clear();  // unplugged meanwhile
}

}  // namespace thimble
