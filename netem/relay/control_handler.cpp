#include "netem/relay/control_handler.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>
#include <sys/eventfd.h>
#include <unistd.h>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/runtime/wall_clock.hpp"

namespace thimble {
namespace {

constexpr Duration kPatience = std::chrono::seconds{2};
// A lock would let a sleeper hold up the relaying thread; looking now and then cannot.
constexpr Duration kLook = std::chrono::microseconds{500};

}  // namespace

ControlHandler::ControlHandler() : event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (event_ < 0) {
        throw Error(ExitCode::kRunFailed, fmt::format("cannot make an event: {}", std::strerror(errno)));
    }
}

ControlHandler::~ControlHandler() { close(event_); }

bool ControlHandler::ask(const Job& job) {
    Request request{&job, nullptr, {}};
    waiting_.store(&request, std::memory_order_release);
    eventfd_write(event_, 1);
    const SessionTime limit = wall_now() + kPatience;
    while (!request.done.load(std::memory_order_acquire)) {
        Request* mine = &request;
        if (wall_now() > limit && waiting_.compare_exchange_strong(mine, nullptr)) return false;
        wall_sleep(kLook);
    }
    if (request.failure) std::rethrow_exception(request.failure);
    return true;
}

void ControlHandler::serve(RelayEngine& engine) {
    eventfd_t ignored = 0;
    eventfd_read(event_, &ignored);
    Request* request = waiting_.exchange(nullptr, std::memory_order_acquire);
    if (request == nullptr) return;
    try {
        (*request->job)(engine);
    } catch (...) {
        request->failure = std::current_exception();
    }
    request->done.store(true, std::memory_order_release);
}

}  // namespace thimble
