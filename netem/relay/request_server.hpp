// A thread that takes one request from each connection of a listening socket, answers it, and closes. The number of connections,
// the length of a request and the time for both are limited; whatever comes in, the thread goes on.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <boost/core/noncopyable.hpp>

#include "common/time.hpp"

namespace thimble {

inline constexpr int kMostVisitors = 16;  // another one is turned away

class RequestServer : boost::noncopyable {
  public:
    // Gets all bytes that came so far, and returns the answer; nothing as long as the request is not complete.
    using Answer = std::function<std::optional<std::string>(std::string_view said)>;

    // Owns `listening`, which is non-blocking. `patience`: a visitor has to have read its answer by then. `most_bytes`: a visitor
    // that says more is heard no further. The thread keeps the default scheduling.
    RequestServer(int listening, Duration patience, std::size_t most_bytes, Answer answer);
    ~RequestServer();

    int listening() const { return listening_; }

  private:
    struct Visitor {
        int socket;
        SessionTime until;
        std::string said{}, answer{};
    };

    void run();
    void let_in();
    bool attend(Visitor& visitor) const;  // false: it is done
    bool hear(Visitor& visitor) const;

    int listening_;
    Duration patience_;
    std::size_t most_bytes_;
    Answer answer_;
    std::vector<Visitor> visitors_;
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

}  // namespace thimble
