// A service manager's socket, as a program under test sees it.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace thimble {

class NotifySocket {
  public:
    // A path, or with '@' in front a name of the abstract namespace.
    explicit NotifySocket(const std::string& name)
        : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        if (name.size() >= sizeof address.sun_path)
            throw std::runtime_error("cannot bind " + name +
                                     ": the path is too long: set TMPDIR to a shorter one");
        std::memcpy(address.sun_path, name.data(), name.size());
        if (name.front() == '@') address.sun_path[0] = '\0';
        const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
        const auto* generic = static_cast<const sockaddr*>(static_cast<const void*>(&address));
        if (bind(socket_, generic, length) != 0) throw std::runtime_error("cannot bind " + name);
    }
    ~NotifySocket() { close(socket_); }
    NotifySocket(const NotifySocket&) = delete;
    NotifySocket& operator=(const NotifySocket&) = delete;

    // Everything since the last call, a line each.
    std::string heard() const {
        std::string lines;
        std::array<char, 100> word{};
        for (ssize_t n; (n = recv(socket_, word.data(), word.size(), MSG_DONTWAIT)) > 0;)
            lines += std::string(word.data(), static_cast<std::size_t>(n)) + "\n";
        return lines;
    }

  private:
    int socket_;
};

}  // namespace thimble
