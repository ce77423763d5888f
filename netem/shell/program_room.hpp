// A program in a network namespace of its own, with one device that leads to the link. It keeps its environment, its folder, its
// terminal and its user. Without root the namespace belongs to a user namespace in which the user has the same number.
#pragma once

#include <string>
#include <sys/types.h>
#include <utility>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "netem/shell/tun_device.hpp"

namespace thimble {

struct RoomSettings {
    std::vector<std::string> command{};  // empty: no program, but a UDP socket for this process
    std::vector<TunAddress> addresses;
    std::string name_server{};  // written to the room's own /etc/resolv.conf; empty: as outside
    bool own_input = true;      // reads this program's standard input; otherwise nothing
};

using Environment = std::vector<std::pair<std::string, std::string>>;

class ProgramRoom : boost::noncopyable {
  public:
    // Makes namespace and device; the program waits for start(). Call before there are other threads.
    // Throws Error: network, with one line that says what to switch on; usage for a program that is not there.
    explicit ProgramRoom(const RoomSettings& settings);
    // Closes the device. A program that still runs is ended by others (programs.hpp); one that waits for start() ends.
    ~ProgramRoom();

    int device() const { return device_; }
    int stamps() const { return stamps_; }  // open_stamp_socket() of the device
    int socket() const { return socket_; }  // without a program: listens on all IPv4 addresses of the room
    bool has_ip6() const { return has_ip6_; }
    pid_t pid() const { return pid_; }
    void start(const Environment& environment);

  private:
    void hear_of_device();

    pid_t pid_ = -1;
    int line_ = -1, device_ = -1, stamps_ = -1, socket_ = -1;
    bool has_ip6_ = false;
};

}  // namespace thimble
