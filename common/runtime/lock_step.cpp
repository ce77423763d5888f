#include "common/runtime/lock_step.hpp"

#include <bit>
#include <cerrno>
#include <cstring>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"

namespace thimble {
namespace {

static_assert(std::endian::native == std::endian::little);

LockStepMessage answer(LockStepKind kind, const Process& process, const DatagramCounts& sent) {
    LockStepMessage message;
    message.kind = kind;
    message.time_ns = to_nanoseconds(process.stopped() ? kNever : process.next_wakeup());
    std::copy(sent.begin(), sent.end(), message.datagrams.begin());
    return message;
}

}  // namespace

LockStepEnd::LockStepEnd(int descriptor, Duration limit) : descriptor_(descriptor) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(limit);
    const timeval patience{seconds.count(), (limit - seconds).count() / 1000};
    int type = 0;
    socklen_t size = sizeof type;
    if (getsockopt(descriptor_, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_SEQPACKET &&
        setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) == 0)
        return;
    throw Error(
        ExitCode::kUsage,
        "no conductor at standard input: a program takes part in lock-step where 'thimble run --clock "
        "lock-step' starts it (docs/lock-step.md)");
}

LockStepEnd::~LockStepEnd() { close(descriptor_); }

bool LockStepEnd::send(const LockStepMessage& message) const {
    return ::send(descriptor_, &message, sizeof message, MSG_NOSIGNAL) == sizeof message;
}

std::optional<LockStepMessage> LockStepEnd::receive() {
    LockStepMessage message;
    ssize_t size = 0;
    do {
        size = recv(descriptor_, &message, sizeof message, 0);
    } while (size < 0 && errno == EINTR && !stop_requested());
    if (size <= 0) {
        silence_ = size == 0         ? Silence::kGone
                   : errno == EINTR  ? Silence::kInterrupted
                   : errno == EAGAIN ? Silence::kLate
                                     : Silence::kGone;
        return std::nullopt;
    }
    if (size == sizeof message && message.version == kLockStepVersion) return message;
    throw Error(
        ExitCode::kNetwork,
        "a lock-step message of {} bytes and version {}, but this program speaks version {}, {} bytes: "
        "use programs of one build (docs/lock-step.md)",
        size, size >= 2 ? message.version : 0, kLockStepVersion, sizeof message);
}

std::optional<LockStepMessage> run_in_lock_step(LockStepEnd& conductor, Process& process, Sockets& sockets) {
    LockStepMessage reply = answer(LockStepKind::kReady, process, {});
    while (conductor.send(reply)) {
        const auto order = conductor.receive();
        if (!order || order->kind != LockStepKind::kGrant) return order;
        sockets.announce(order->datagrams);
        process.tick(from_nanoseconds(order->time_ns));
        reply = answer(LockStepKind::kAnswer, process, sockets.take_sent());
    }
    return std::nullopt;
}

}  // namespace thimble
