#include "netem/relay/udp_address.hpp"

#include <arpa/inet.h>
#include <charconv>
#include <cstring>
#include <netdb.h>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

std::uint16_t read_port(std::string_view text, const std::string& whole, const std::string& option) {
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (error != std::errc{} || end != text.data() + text.size()) {
        throw Error(ExitCode::kUsage,
                    fmt::format("{}: '{}' has no port from 0 to 65535; write it as HOST:PORT or PORT (IPv4)",
                                option, whole));
    }
    return port;
}

std::uint32_t resolve(const std::string& host, const std::string& option) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found);
    if (error != 0 || found == nullptr) {
        throw Error(ExitCode::kNetwork, fmt::format("{}: cannot resolve host '{}': {}; give an IPv4 address?",
                                                    option, host, gai_strerror(error)));
    }
    sockaddr_in address{};
    std::memcpy(&address, found->ai_addr, sizeof address);
    freeaddrinfo(found);
    return address.sin_addr.s_addr;
}

}  // namespace

sockaddr_in UdpAddress::generic() const {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = host;
    address.sin_port = port;
    return address;
}

std::string to_string(const UdpAddress& address) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&address.host);
    return fmt::format("{}.{}.{}.{}:{}", bytes[0], bytes[1], bytes[2], bytes[3], ntohs(address.port));
}

UdpAddress read_udp_address(const std::string& text, const std::string& option) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos) return {htonl(INADDR_ANY), htons(read_port(text, text, option))};
    const std::uint16_t port = read_port(std::string_view(text).substr(colon + 1), text, option);
    return {resolve(text.substr(0, colon), option), htons(port)};
}

}  // namespace thimble
