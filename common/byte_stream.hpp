// A connection to another program that carries bytes in order and never waits. TCP: common/runtime/tcp_client.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <boost/core/noncopyable.hpp>

namespace thimble {

class ByteStream : boost::noncopyable {
  public:
    enum class State : std::uint8_t { kClosed, kConnecting, kOpen };

    virtual ~ByteStream() = default;

    // Begins a new connection; state() tells when it is open.
    virtual void connect() = 0;
    virtual State state() = 0;
    // As many bytes as the connection takes now; 0: none, or it is closed.
    virtual std::size_t send(std::string_view bytes) = 0;
    // As many bytes as have come and `room` holds; 0: none, or it is closed.
    virtual std::size_t receive(std::span<char> room) = 0;
    virtual void close() = 0;
    // Why it is closed: that the other side closed it, or words of the system like "Connection refused".
    virtual std::string_view why() const = 0;
};

}  // namespace thimble
