#include "common/runtime/lock_step.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>
#include <utility>

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

LockStepEnd::LockStepEnd(int descriptor, Duration limit) : descriptor_(descriptor), limit_(limit) {
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

LockStepEnd::~LockStepEnd() {
    if (page_ != nullptr) munmap(page_, sizeof *page_);
    if (offered_ >= 0) close(offered_);
    close(descriptor_);
}

void LockStepEnd::offer_page() {
    const int page = memfd_create("lock-step", MFD_CLOEXEC);
    if (page < 0 || ftruncate(page, sizeof(LockStepPage)) != 0) return;
    conductor_ = true;
    offered_ = page;
    map(page);
}

void LockStepEnd::map(int page) {
    void* const memory = mmap(nullptr, sizeof(LockStepPage), PROT_READ | PROT_WRITE, MAP_SHARED, page, 0);
    if (memory == MAP_FAILED) return;
    page_ = static_cast<LockStepPage*>(memory);
    out_ = conductor_ ? &page_->order : &page_->answer;
    in_ = conductor_ ? &page_->answer : &page_->order;
}

bool LockStepEnd::send(LockStepMessage message) {
    if (by_page_) {
        out_->message = message;
        out_->turn.fetch_add(1, std::memory_order_release);
        syscall(SYS_futex, &out_->turn, FUTEX_WAKE, 1, nullptr, nullptr, 0);
        return true;
    }
    message.by_page = !conductor_ && page_ != nullptr ? 1 : 0;
    const bool sent = send_by_socket(message);
    by_page_ = message.by_page != 0;
    return sent;
}

bool LockStepEnd::send_by_socket(const LockStepMessage& message) {
    if (offered_ < 0) return ::send(descriptor_, &message, sizeof message, MSG_NOSIGNAL) == sizeof message;
    iovec part{const_cast<LockStepMessage*>(&message), sizeof message};
    alignas(cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(int))> control{};
    msghdr header{};
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    cmsghdr* const rights = CMSG_FIRSTHDR(&header);
    *rights = {CMSG_LEN(sizeof(int)), SOL_SOCKET, SCM_RIGHTS};
    std::memcpy(CMSG_DATA(rights), &offered_, sizeof offered_);
    const bool sent = sendmsg(descriptor_, &header, MSG_NOSIGNAL) == sizeof message;
    close(std::exchange(offered_, -1));
    return sent;
}

ssize_t LockStepEnd::receive_by_socket(LockStepMessage& message) {
    iovec part{&message, sizeof message};
    alignas(cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(int))> control{};
    msghdr header{};
    header.msg_iov = &part;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    const ssize_t size = recvmsg(descriptor_, &header, MSG_CMSG_CLOEXEC);
    const cmsghdr* const rights = size > 0 ? CMSG_FIRSTHDR(&header) : nullptr;
    if (rights == nullptr || rights->cmsg_type != SCM_RIGHTS || page_ != nullptr) return size;
    int page = -1;
    std::memcpy(&page, CMSG_DATA(rights), sizeof page);
    map(page);
    close(page);
    return size;
}

// Looks now and then whether the other end still lives: a futex does not tell.
ssize_t LockStepEnd::receive_by_page(LockStepMessage& message) {
    constexpr Duration kLook = std::chrono::milliseconds{100};
    const timespec look{0, kLook.count()};
    for (Duration waited{}; in_->turn.load(std::memory_order_acquire) == heard_;) {
        if (syscall(SYS_futex, &in_->turn, FUTEX_WAIT, heard_, &look, nullptr, 0) == 0) continue;
        if (errno == EINTR && stop_requested()) return -1;
        if (errno != ETIMEDOUT) continue;
        waited += kLook;
        if (has_ended()) return 0;
        if (limit_ == Duration::zero() || waited < limit_) continue;
        errno = EAGAIN;
        return -1;
    }
    heard_ = in_->turn.load(std::memory_order_acquire);
    message = in_->message;
    return sizeof message;
}

bool LockStepEnd::has_ended() const {
    char byte = 0;
    return recv(descriptor_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

std::optional<LockStepMessage> LockStepEnd::receive() {
    LockStepMessage message;
    ssize_t size = 0;
    do {
        size = by_page_ ? receive_by_page(message) : receive_by_socket(message);
    } while (size < 0 && errno == EINTR && !stop_requested());
    if (size <= 0) {
        silence_ = Silence::kGone;
        if (size < 0 && errno == EINTR) silence_ = Silence::kInterrupted;
        if (size < 0 && errno == EAGAIN) silence_ = Silence::kLate;
        return std::nullopt;
    }
    if (size != sizeof message || message.version != kLockStepVersion)
        throw Error(
            ExitCode::kNetwork,
            "a lock-step message of {} bytes and version {}, but this program speaks version {}, {} bytes: "
            "use programs of one build (docs/lock-step.md)",
            size, size >= 2 ? message.version : 0, kLockStepVersion, sizeof message);
    if (conductor_ && message.by_page != 0) by_page_ = true;
    return message;
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
