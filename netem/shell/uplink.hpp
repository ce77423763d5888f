// The outer end of a shell's link: this machine, and everything that it reaches. For root a second device, so that the kernel's
// own TCP talks to the program; for all users slirp4netns, which speaks for the program with ordinary sockets.
#pragma once

#include <string>
#include <vector>

#include "common/text_file.hpp"
#include "netem/shell/packet_relay.hpp"
#include "netem/shell/program_room.hpp"

namespace thimble {

class Uplink : boost::noncopyable {
  public:
    // Starts slirp4netns. Throws Error (network) if there is neither that nor root.
    Uplink();
    // Ends slirp4netns.
    ~Uplink();

    std::vector<TunAddress> program_addresses() const;  // of the program's device
    std::string name_server() const;                    // empty: the one that is named outside
    std::vector<PacketPort> ports() const;
    Environment environment(bool has_ip6) const;
    pid_t slirp() const { return slirp_; }  // -1: there is none

  private:
    void start_slirp();
    void connect_slirp(const std::string& path);
    std::string open_host_device();  // without one: what root can do about it
    std::string host_ip4() const;
    std::string host_ip6() const;

    pid_t slirp_ = -1;
    int life_line_ = -1;  // slirp4netns ends when this end of a pipe closes, also with a killed process
    int frames_ = -1, host_ = -1, host_stamps_ = -1;
    int host_number_ = -1;
    bool host_has_ip6_ = false;
};

}  // namespace thimble
