// thimble-netem as its users start it, and an echo server to put it in front of.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/process/child.hpp"
#include "common/runtime/udp_socket.hpp"
#include "common/time.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {

UdpAddress loopback();

// Started with these arguments; killed if it still runs at the end of the test.
class NetemProgram {
  public:
    explicit NetemProgram(const std::vector<std::string>& arguments);
    ~NetemProgram();
    NetemProgram(const NetemProgram&) = delete;
    NetemProgram& operator=(const NetemProgram&) = delete;

    void signal(int number) { child_.signal(number); }
    int wait() { return child_.wait(kPatience).value_or(-1); }  // its exit code; -1 if it does not end
    std::string said() const { return read_text(folder_ / "err"); }
    std::string printed() const { return read_text(folder_ / "out"); }
    // Where its n-th inlet listens, once it is ready.
    UdpAddress inlet(int n = 0);

  private:
    Folder folder_;
    int printed_;
    Child child_;
};

struct Ended {
    int code;
    std::string printed, said;
};
Ended run_netem(const std::vector<std::string>& arguments);

// Answers each datagram with the same bytes.
class EchoServer {
  public:
    EchoServer();
    ~EchoServer();
    std::string address() const { return to_string(socket_.local()); }

  private:
    UdpSocket socket_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

class Client {
  public:
    explicit Client(const UdpAddress& relay) : socket_(UdpSocket::connected(relay)) {}
    void say(const std::string& words) const;
    std::optional<std::string> hear(Duration patience = kPatience) const;
    // Says it and waits for the echo; how long that took.
    std::optional<Duration> round_trip(const std::string& words) const;

  private:
    UdpSocket socket_;
};

}  // namespace thimble
