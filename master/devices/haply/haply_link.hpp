// A WebSocket to a service of this machine, for one thread. No call waits longer than its limit.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"

namespace thimble {

class HaplyLink : boost::noncopyable {
  public:
    // A longer message costs the connection.
    static constexpr std::size_t kLongestMessage = std::size_t{1} << 16;

    // Throws Error (usage) if no WebSocket answers within `limit`, with what to do about it.
    HaplyLink(std::uint16_t port, Duration limit);
    ~HaplyLink();

    // Gives a message to the kernel. False: it did not, because an earlier one is still on its way there, or the link is lost.
    bool send(std::string text);
    // The oldest message that has not been returned; empty if none comes within `limit`.
    std::optional<std::string> receive(Duration limit);
    // Says farewell to the service, which gets `limit` to answer.
    void close(Duration limit);
    // Why the connection has ended; empty: it has not.
    const std::string& trouble() const;

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace thimble
