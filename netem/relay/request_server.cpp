#include "netem/relay/request_server.hpp"

#include <cerrno>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <utility>

#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr int kLatestLook_ms = 50;

bool may_come_later() { return errno == EAGAIN || errno == EINTR; }

}  // namespace

RequestServer::RequestServer(int listening, Duration patience, std::size_t most_bytes, Answer answer)
    : listening_(listening),
      patience_(patience),
      most_bytes_(most_bytes),
      answer_(std::move(answer)),
      thread_([this] { run(); }) {}

RequestServer::~RequestServer() {
    stop_ = true;
    thread_.join();
    for (const Visitor& visitor : visitors_) close(visitor.socket);
    close(listening_);
}

void RequestServer::run() {
    block_signals();
    std::vector<pollfd> wanted;
    while (!stop_) {
        wanted.assign(1, {listening_, POLLIN, 0});
        for (const Visitor& visitor : visitors_)
            wanted.push_back(
                {visitor.socket, static_cast<short>(visitor.answer.empty() ? POLLIN : POLLOUT), 0});
        if (poll(wanted.data(), wanted.size(), kLatestLook_ms) > 0 && (wanted[0].revents & POLLIN) != 0)
            let_in();
        std::erase_if(visitors_, [&](Visitor& visitor) {
            if (attend(visitor) && wall_now() < visitor.until) return false;
            close(visitor.socket);
            return true;
        });
    }
}

void RequestServer::let_in() {
    const int visitor = accept4(listening_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (visitor < 0) {
        // Without a free descriptor the visitor waits outside, and poll() would return at once.
        if (!may_come_later()) wall_sleep(std::chrono::milliseconds{kLatestLook_ms});
        return;
    }
    if (visitors_.size() < std::size_t{kMostVisitors}) {
        visitors_.push_back({visitor, wall_now() + patience_});
    } else {
        close(visitor);
    }
}

bool RequestServer::attend(Visitor& visitor) const {
    if (visitor.answer.empty() && !hear(visitor)) return false;
    if (visitor.answer.empty()) return true;
    const auto sent = send(visitor.socket, visitor.answer.data(), visitor.answer.size(), MSG_NOSIGNAL);
    if (sent < 0) return may_come_later();
    visitor.answer.erase(0, static_cast<std::size_t>(sent));
    return !visitor.answer.empty();
}

// One byte more than allowed, to see that a request is too long. A packet socket gives a whole request at once.
bool RequestServer::hear(Visitor& visitor) const {
    const std::size_t before = visitor.said.size();
    visitor.said.resize(most_bytes_ + 1);
    const auto size = recv(visitor.socket, visitor.said.data() + before, visitor.said.size() - before, 0);
    const bool later = size < 0 && may_come_later();
    visitor.said.resize(before + (size > 0 ? static_cast<std::size_t>(size) : 0));
    if (size <= 0) return later;
    visitor.answer = answer_(visitor.said).value_or("");
    return true;
}

}  // namespace thimble
