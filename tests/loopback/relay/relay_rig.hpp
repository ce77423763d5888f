// thimble-netem as its users start it, and an echo server to put it in front of.
#pragma once

#include <arpa/inet.h>
#include <atomic>
#include <csignal>
#include <fcntl.h>
#include <optional>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include <gtest/gtest.h>

#include "common/process/child.hpp"
#include "common/runtime/udp_socket.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/time.hpp"
#include "netem/relay/datagram_batch.hpp"
#include "tests/loopback/workbench.hpp"

namespace thimble {

inline bool readable(const UdpSocket& socket, Duration patience) {
    pollfd wanted{socket.descriptor(), POLLIN, 0};
    return poll(&wanted, 1, static_cast<int>(patience / std::chrono::milliseconds{1})) > 0;
}

inline void send_datagram(const UdpSocket& socket, Bytes bytes, const UdpAddress* to) {
    SendBatch batch;
    batch.add(bytes, to);
    batch.send(socket.descriptor());
}

inline UdpAddress loopback() { return {htonl(INADDR_LOOPBACK), 0}; }

// Started with these arguments; killed if it still runs at the end of the test.
class NetemProgram {
  public:
    explicit NetemProgram(const std::vector<std::string>& arguments)
        : printed_(open((folder_ / "out").c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600)),
          child_(std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-netem", arguments, folder_ / "err",
                 {.output = printed_}) {}
    ~NetemProgram() { close(printed_); }
    NetemProgram(const NetemProgram&) = delete;
    NetemProgram& operator=(const NetemProgram&) = delete;

    void signal(int number) { child_.signal(number); }
    int wait() { return child_.wait(kPatience).value_or(-1); }  // its exit code; -1 if it does not end
    std::string said() const { return read_text(folder_ / "err"); }
    std::string printed() const { return read_text(folder_ / "out"); }
    // Where its n-th inlet listens, once it is ready.
    UdpAddress inlet(int n = 0) {
        const std::string mark = "ready: UDP ";
        std::size_t at = 0;
        std::string words;
        const bool ready = wait_until([&] {
            words = said();
            at = words.find(mark);
            for (int i = 0; i < n && at != std::string::npos; ++i) at = words.find(mark, at + 1);
            return at != std::string::npos && words.find('\n', at) != std::string::npos;
        });
        if (!ready) throw std::runtime_error("not ready: " + words);
        at += mark.size();
        return read_udp_address(words.substr(at, words.find(' ', at) - at), "its own words");
    }

  private:
    Folder folder_;
    int printed_;
    Child child_;
};

struct Ended {
    int code;
    std::string printed, said;
};
inline Ended run_netem(const std::vector<std::string>& arguments) {
    NetemProgram program(arguments);
    const int code = program.wait();
    return {code, program.printed(), program.said()};
}

// Answers each datagram with the same bytes.
class EchoServer {
  public:
    EchoServer() : socket_(UdpSocket::listening(loopback())) {
        thread_ = std::thread([this] {
            ReceiveBatch batch;
            while (!stop_) {
                if (!readable(socket_, std::chrono::milliseconds{20})) continue;
                const std::size_t count = batch.receive(socket_.descriptor());
                for (std::size_t i = 0; i < count; ++i) {
                    const auto datagram = batch[i];
                    send_datagram(socket_, datagram.bytes, &datagram.from);
                }
            }
        });
    }
    ~EchoServer() {
        stop_ = true;
        thread_.join();
    }
    std::string address() const { return to_string(socket_.local()); }

  private:
    UdpSocket socket_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

class Client {
  public:
    explicit Client(const UdpAddress& relay) : socket_(UdpSocket::connected(relay)) {}
    void say(const std::string& words) const {
        send_datagram(socket_, {reinterpret_cast<const std::uint8_t*>(words.data()), words.size()}, nullptr);
    }
    std::optional<std::string> hear(Duration patience = kPatience) const {
        // One at a time: what else waits is for the next call.
        std::string words(65536, '\0');
        if (!readable(socket_, patience)) return std::nullopt;
        const auto size = recv(socket_.descriptor(), words.data(), words.size(), 0);
        if (size < 0) return std::nullopt;
        words.resize(static_cast<std::size_t>(size));
        return words;
    }
    // Says it and waits for the echo; how long that took.
    std::optional<Duration> round_trip(const std::string& words) const {
        const SessionTime start = wall_now();
        say(words);
        if (hear() != words) return std::nullopt;
        return wall_now() - start;
    }

  private:
    UdpSocket socket_;
};

class RelayProgram : public testing::Test {
  protected:
    std::vector<std::string> in_front(const std::vector<std::string>& more = {}) const {
        return words_in("--listen 127.0.0.1:0 --to " + echo_.address(), more);
    }
    EchoServer echo_;
    Folder folder_;
};

}  // namespace thimble
