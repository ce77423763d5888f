#include "cutaneous_node/can/socket_can_bus.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/error.hpp"

namespace thimble {
namespace {

// The interface has been set down, or is gone.
bool interface_lost(int error) { return error == ENETDOWN || error == ENXIO || error == ENODEV; }

[[noreturn]] void no_bus(const std::string& interface, const char* advice) {
    throw Error(ExitCode::kNetwork, "cannot use the CAN interface '{}': {}; {}", interface,
                std::strerror(errno), advice);
}

bool is_up(int socket, const std::string& interface) {
    ifreq request{};
    interface.copy(request.ifr_name, IFNAMSIZ - 1);
    return ioctl(socket, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

}  // namespace

SocketCanBus::SocketCanBus(const std::string& interface) {
    socket_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (socket_ < 0) {
        no_bus(interface,
               "this kernel has no CAN sockets (modprobe can-raw); a bus elsewhere can be reached with "
               "cannelloni");
    }
    try {
        open(interface);
    } catch (...) {
        close(socket_);
        throw;
    }
}

void SocketCanBus::open(const std::string& interface) {
    const can_err_mask_t every_error = CAN_ERR_MASK;
    setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &every_error, sizeof every_error);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
    if (address.can_ifindex == 0) no_bus(interface, "'ip link' lists the interfaces");
    if (bind(socket_, static_cast<const sockaddr*>(static_cast<const void*>(&address)), sizeof address) !=
        0) {
        no_bus(interface, "is it a CAN interface?");
    }
    if (!is_up(socket_, interface)) {
        errno = ENETDOWN;
        no_bus(interface, "set it up, e.g. ip link set can0 up type can bitrate 1000000");
    }
}

SocketCanBus::~SocketCanBus() { close(socket_); }

void SocketCanBus::send(const CanFrame& frame) {
    can_frame raw{};
    raw.can_id = frame.id;
    raw.len = frame.length;
    std::copy(frame.data.begin(), frame.data.end(), raw.data);
    const auto sent = write(socket_, &raw, sizeof raw);
    if (sent < 0 && interface_lost(errno)) down_ = true;
    ++(sent == sizeof raw ? counters_.sent : counters_.send_failed);
}

bool SocketCanBus::receive(SessionTime /*now*/, CanFrame& frame) {
    can_frame raw{};
    const auto size = read(socket_, &raw, sizeof raw);
    if (size < 0 && interface_lost(errno)) down_ = true;
    if (size != sizeof raw || raw.len > frame.data.size()) return false;
    frame.id = raw.can_id;
    frame.length = raw.len;
    std::copy_n(raw.data, frame.data.size(), frame.data.begin());
    ++counters_.received;
    return true;
}

}  // namespace thimble
