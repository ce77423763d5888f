#include "netem/shell/shell_selftest.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <sys/socket.h>

#include "common/error.hpp"
#include "netem/shell/shell_service.hpp"

namespace thimble {

ShellPath::ShellPath()
    : client_({.addresses = {pair_address(0)}}), server_({.addresses = {pair_address(1)}}) {}

void ShellPath::open(const SelftestSettings& settings, bool precise, PacketSink& records) {
    relay_.emplace(PacketRelaySettings{settings.links,
                                       settings.timelines,
                                       settings.seed,
                                       precise,
                                       {.descriptor = client_.device(), .stamps = client_.stamps()},
                                       {{.descriptor = server_.device(), .stamps = server_.stamps()}}},
                   &records, -1);
}

int ShellPath::client() {
    SocketAddress address{};
    socklen_t size = sizeof address;
    getsockname(server_.socket(), &address.any, &size);
    inet_pton(AF_INET, pair_address(1).ip4.c_str(), &address.v4.sin_addr);
    if (connect(client_.socket(), &address.any, sizeof address.v4) != 0)
        throw Error(ExitCode::kNetwork, "cannot reach the other namespace: {}", std::strerror(errno));
    return client_.socket();
}

}  // namespace thimble
