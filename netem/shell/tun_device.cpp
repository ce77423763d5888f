#include "netem/shell/tun_device.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <linux/if_tun.h>
#include <linux/ipv6.h>
#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "common/text_file.hpp"

namespace thimble {
namespace {

constexpr const char* kTunFile = "/dev/net/tun";
constexpr int kTunQueue = 4000;  // packets that wait for this program; the kernel drops more

ifreq request_for(const std::string& name) {
    ifreq request{};
    name.copy(request.ifr_name, IFNAMSIZ - 1);
    return request;
}

void set(int socket, unsigned long what, void* request, const char* which) {
    if (ioctl(socket, what, request) == 0) return;
    throw Error(ExitCode::kNetwork, "cannot set the {} of the link's device: {}", which,
                std::strerror(errno));
}

void set_ip4(int socket, ifreq& request, unsigned long what, in_addr_t value, const char* which) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = value;
    std::memcpy(&request.ifr_addr, &address, sizeof address);
    set(socket, what, &request, which);
}

void bring_up(int socket, const std::string& name) {
    ifreq request = request_for(name);
    set(socket, SIOCGIFFLAGS, &request, "flags");
    request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP);
    set(socket, SIOCSIFFLAGS, &request, "flags");
}

// Files below /proc/sys. They may be read-only in a container; the link works without them.
void write_sysctl(const std::string& name, const std::string& value) {
    std::ofstream("/proc/sys/net/" + name) << value;
}

// The kernel sends nothing of its own accord: such packets would have numbers, at times that no seed knows.
void keep_quiet(const std::string& name) {
    const std::string folder = "ipv6/conf/" + name + '/';
    for (const char* key : {"accept_ra", "router_solicitations", "dad_transmits", "accept_dad"})
        write_sysctl(folder + key, "0");
    write_sysctl(folder + "addr_gen_mode", "1");
    write_sysctl("ipv4/conf/" + name + "/rp_filter", "0");
}

// All but the first under a label of their own, or it would replace the first.
void add_ip4(int socket, const std::string& label, const TunAddress& address) {
    ifreq request = request_for(label);
    set_ip4(socket, request, SIOCSIFADDR, inet_addr(address.ip4.c_str()), "address");
    set_ip4(socket, request, SIOCSIFNETMASK, htonl(~0U << (32 - address.prefix4)), "netmask");
}

void route_all_ip4(int socket, const std::string& name) {
    rtentry route{};
    for (sockaddr* address : {&route.rt_dst, &route.rt_genmask}) address->sa_family = AF_INET;
    std::string device = name;
    route.rt_dev = device.data();
    route.rt_flags = RTF_UP;
    set(socket, SIOCADDRT, &route, "default route");
}

bool add_ip6(int socket, int index, const std::string& address, int prefix) {
    in6_ifreq request{};
    inet_pton(AF_INET6, address.c_str(), &request.ifr6_addr);
    request.ifr6_prefixlen = static_cast<__u32>(prefix);
    request.ifr6_ifindex = index;
    return ioctl(socket, SIOCSIFADDR, &request) == 0;
}

// Hosts of the link's own network, and all others. The metric is the kernel's for a user's routes.
bool route_all_ip6(int socket, int index) {
    in6_rtmsg route{};
    route.rtmsg_ifindex = index;
    route.rtmsg_metric = 1024;
    route.rtmsg_flags = RTF_UP;
    return ioctl(socket, SIOCADDRT, &route) == 0;
}

bool set_ip6(const std::string& name, const std::vector<TunAddress>& addresses, bool default_route) {
    const FileDescriptor socket(::socket(AF_INET6, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    if (socket.get() < 0) return false;
    const int index = static_cast<int>(if_nametoindex(name.c_str()));
    for (const TunAddress& address : addresses) {
        if (!add_ip6(socket.get(), index, address.ip6, address.prefix6)) return false;
    }
    // For multicast on the link, as every interface has it.
    const std::string& first = addresses.front().ip6;
    add_ip6(socket.get(), index, "fe80::" + first.substr(first.rfind(':') + 1), 64);
    return !default_route || route_all_ip6(socket.get(), index);
}

bool is_number(const char* file, int number) {
    int found = number - 1;
    return std::ifstream(file) >> found && found == number;
}

}  // namespace

int open_tun(const std::string& name) {
    const int opened = open(kTunFile, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (opened < 0) {
        const bool absent = errno == ENOENT || errno == ENXIO || errno == ENODEV;
        throw Error(ExitCode::kNetwork, "cannot open {}: {}; {}", kTunFile, std::strerror(errno),
                    absent ? "as root 'modprobe tun', in a container '--device /dev/net/tun', switches it on"
                           : "as root 'chmod 666 /dev/net/tun' allows it to all users, as udev does");
    }
    ifreq request = request_for(name);
    request.ifr_flags = IFF_TUN | IFF_NO_PI;
    if (ioctl(opened, TUNSETIFF, &request) == 0) return opened;
    const int error = errno;
    close(opened);
    if (error == EBUSY) return -1;
    throw Error(ExitCode::kNetwork, "cannot make a TUN device: {}; {}", std::strerror(error),
                namespace_remedy());
}

bool configure_tun(const std::string& name, const std::vector<TunAddress>& addresses, bool default_route) {
    const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    keep_quiet(name);
    ifreq request = request_for(name);
    request.ifr_mtu = kTunMtu;
    set(socket.get(), SIOCSIFMTU, &request, "MTU");
    request.ifr_qlen = kTunQueue;
    ioctl(socket.get(), SIOCSIFTXQLEN, &request);  // for root of the machine only; others keep 500
    for (std::size_t i = 0; i < addresses.size(); ++i)
        add_ip4(socket.get(), i == 0 ? name : fmt::format("{}:{}", name, i), addresses[i]);
    bring_up(socket.get(), name);
    if (default_route) route_all_ip4(socket.get(), name);
    return set_ip6(name, addresses, default_route);
}

std::string namespace_remedy() {
    if (is_number("/proc/sys/kernel/unprivileged_userns_clone", 0))
        return "as root 'sysctl -w kernel.unprivileged_userns_clone=1' switches user namespaces on";
    if (is_number("/proc/sys/user/max_user_namespaces", 0))
        return "as root 'sysctl -w user.max_user_namespaces=10000' switches user namespaces on";
    if (is_number("/proc/sys/kernel/apparmor_restrict_unprivileged_userns", 1))
        return "as root 'sysctl -w kernel.apparmor_restrict_unprivileged_userns=0' switches user namespaces "
               "on";
    return "a container may forbid namespaces: start it with '--cap-add NET_ADMIN --cap-add SYS_ADMIN'";
}

void configure_namespace() {
    const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    bring_up(socket.get(), "lo");
    write_sysctl("ipv4/ping_group_range", fmt::format("{0} {0}", getgid()));
}

}  // namespace thimble
