// Sends the same messages to every program that connects over TCP (IPv4), and discards what they send. Never blocks:
// a slow client misses whole messages.
#pragma once

#include <cstdint>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/channel.hpp"
#include "common/network_settings.hpp"
#include "common/text_file.hpp"

namespace thimble {

class TcpServer : boost::noncopyable {
  public:
    static constexpr std::size_t kMostClients = 16;  // another one is turned away

    // Port 0: the kernel's choice. Throws Error (network) with the address if it is taken or cannot be resolved.
    explicit TcpServer(const Endpoint& local);
    ~TcpServer();

    // Accepts waiting clients and drops those that have left.
    void look_after_clients();
    // A whole message to each client that has taken all of the one before.
    void send(Bytes message);
    // True once nothing waits to be sent any more.
    bool all_sent();

    std::size_t clients() const { return clients_.size(); }
    std::uint64_t skipped() const { return skipped_; }  // messages that a client was too slow for
    std::uint16_t port() const;

  private:
    struct Client {
        int socket = -1;
        std::vector<std::uint8_t> left{};  // of the message before
        bool gone = false;
    };
    static void throw_away_input(Client& client);
    static void send_rest(Client& client);

    FileDescriptor socket_;
    std::vector<Client> clients_;
    std::uint64_t skipped_ = 0;
};

}  // namespace thimble
