// A connection over TCP to a program that listens.
#pragma once

#include "common/byte_stream.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/udp_socket.hpp"

namespace thimble {

class TcpClient final : public ByteStream {
  public:
    // The first connect() begins the connection. Throws Error (network) with `advice` if the host cannot be resolved.
    TcpClient(const Endpoint& there, std::string_view advice);
    ~TcpClient() override;

    void connect() override;
    State state() override;
    std::size_t send(std::string_view bytes) override;
    std::size_t receive(std::span<char> room) override;
    void close() override;
    std::string_view why() const override { return why_; }

  private:
    void fail(int error);

    SocketAddress address_;
    int socket_ = -1;
    bool open_ = false;
    const char* why_ = "not connected yet";
};

}  // namespace thimble
