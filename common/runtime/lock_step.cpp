#include "common/runtime/lock_step.hpp"

#include <algorithm>
#include <array>
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

#include <boost/core/noncopyable.hpp>

#include "common/error.hpp"
#include "common/runtime/grant_stream.hpp"
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

// For sendmsg() and recvmsg(): a message, and room for a descriptor beside it.
struct MessageWithRoom : boost::noncopyable {
    explicit MessageWithRoom(LockStepMessage& message) : part{&message, sizeof message} {
        header.msg_iov = &part;
        header.msg_iovlen = 1;
        header.msg_control = control.data();
        header.msg_controllen = control.size();
    }

    iovec part;
    alignas(cmsghdr) std::array<std::uint8_t, CMSG_SPACE(sizeof(int))> control{};
    msghdr header{};
};

}  // namespace

LockStepEnd::LockStepEnd(int descriptor, Duration limit) : descriptor_(descriptor), limit_(limit) {
    const timeval patience{0, kLockStepLook.count() / 1000};
    int type = 0;
    socklen_t size = sizeof type;
    if (getsockopt(descriptor_, SOL_SOCKET, SO_TYPE, &type, &size) == 0 && type == SOCK_SEQPACKET &&
        setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) == 0)
        return;
    throw Error(ExitCode::kUsage,
                "lock-step needs a controller at standard input: 'thimble run --clock lock-step' starts this "
                "program with one (docs/clocks.md)");
}

LockStepEnd::LockStepEnd(std::unique_ptr<GrantStream> stream, Duration limit)
    : stream_(std::move(stream)), limit_(limit) {}

LockStepEnd::~LockStepEnd() {
    if (page_ != nullptr) munmap(page_, sizeof *page_);
    if (offered_ >= 0) close(offered_);
    if (descriptor_ >= 0) close(descriptor_);
}

void LockStepEnd::offer_page() {
    const int page = memfd_create("lock-step", MFD_CLOEXEC);
    conductor_ = true;
    if (page >= 0 && ftruncate(page, sizeof(LockStepPage)) == 0) map(page);
    if (page_ != nullptr) {
        offered_ = page;
    } else if (page >= 0) {
        close(page);
    }
}

void LockStepEnd::map(int page) {
    void* const memory = mmap(nullptr, sizeof(LockStepPage), PROT_READ | PROT_WRITE, MAP_SHARED, page, 0);
    if (memory == MAP_FAILED) return;
    page_ = static_cast<LockStepPage*>(memory);
    out_ = conductor_ ? &page_->order : &page_->answer;
    in_ = conductor_ ? &page_->answer : &page_->order;
}

bool LockStepEnd::send(LockStepMessage message) {
    if (stream_) return stream_->send(message);
    if (by_page_) {
        const std::uint32_t turn = out_->turn.load(std::memory_order_relaxed);
        out_->messages[turn % LockStepPage::kRoom] = message;
        out_->turn.store(turn + 1, std::memory_order_release);
        if (message.kind == LockStepKind::kQuietGrant) return true;  // the next grant wakes the node
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
    MessageWithRoom with(const_cast<LockStepMessage&>(message));
    cmsghdr* const rights = CMSG_FIRSTHDR(&with.header);
    *rights = {CMSG_LEN(sizeof(int)), SOL_SOCKET, SCM_RIGHTS};
    std::memcpy(CMSG_DATA(rights), &offered_, sizeof offered_);
    const bool sent = sendmsg(descriptor_, &with.header, MSG_NOSIGNAL) == sizeof message;
    close(std::exchange(offered_, -1));
    return sent;
}

ssize_t LockStepEnd::receive_by_socket(LockStepMessage& message) {
    MessageWithRoom with(message);
    const ssize_t size = recvmsg(descriptor_, &with.header, MSG_CMSG_CLOEXEC);
    const cmsghdr* const rights = size > 0 ? CMSG_FIRSTHDR(&with.header) : nullptr;
    if (rights == nullptr || rights->cmsg_type != SCM_RIGHTS) return size;
    int page = -1;
    std::memcpy(&page, CMSG_DATA(rights), sizeof page);
    if (page_ == nullptr) map(page);
    close(page);
    return size;
}

// A futex does not tell whether the other end still lives.
ssize_t LockStepEnd::receive_by_page(LockStepMessage& message) {
    const timespec look{0, kLockStepLook.count()};
    while (in_->turn.load(std::memory_order_acquire) == heard_) {
        if (syscall(SYS_futex, &in_->turn, FUTEX_WAIT, heard_, &look, nullptr, 0) == 0 || errno == EAGAIN)
            continue;
        const bool late = errno == ETIMEDOUT;
        if (late && has_ended()) return 0;
        errno = late ? EAGAIN : EINTR;
        return -1;
    }
    message = in_->messages[heard_++ % LockStepPage::kRoom];
    return sizeof message;
}

// Sets silence() where nothing came.
ssize_t LockStepEnd::receive_within_limit(LockStepMessage& message) {
    for (Duration waited{};;) {
        const ssize_t size = stream_    ? stream_->receive(message)
                             : by_page_ ? receive_by_page(message)
                                        : receive_by_socket(message);
        if (size > 0) return size;
        const bool goes_on = size < 0 && (errno == EAGAIN || errno == EINTR);
        if (goes_on && errno == EAGAIN) waited += kLockStepLook;
        silence_ = !goes_on ? Silence::kGone : stop_requested() ? Silence::kInterrupted : Silence::kLate;
        const bool late = limit_ > Duration::zero() && waited >= limit_;
        if (silence_ != Silence::kLate || late) return size;
    }
}

bool LockStepEnd::has_ended() const {
    char byte = 0;
    return recv(descriptor_, &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

std::optional<LockStepMessage> LockStepEnd::receive() {
    LockStepMessage message;
    const ssize_t size = receive_within_limit(message);
    if (size <= 0) return std::nullopt;
    if (size != sizeof message || message.version != kLockStepVersion)
        throw Error(ExitCode::kNetwork,
                    "a lock-step message of {} bytes and version {}, but this program uses version "
                    "{} with {} bytes: use programs of one build (docs/clocks.md)",
                    size, size >= 2 ? message.version : 0, kLockStepVersion, sizeof message);
    if (conductor_ && message.by_page != 0) by_page_ = true;
    return message;
}

std::optional<LockStepMessage> run_in_lock_step(LockStepEnd& conductor, Process& process, Sockets& sockets,
                                                const std::function<SessionTime()>& quiet_until) {
    LockStepMessage reply = answer(LockStepKind::kReady, process, {});
    while (conductor.send(reply)) {
        auto order = conductor.receive();
        for (; order && order->kind == LockStepKind::kQuietGrant; order = conductor.receive()) {
            sockets.announce(order->datagrams);
            process.tick(from_nanoseconds(order->time_ns));
        }
        if (!order || order->kind != LockStepKind::kGrant) return order;
        sockets.announce(order->datagrams);
        process.tick(from_nanoseconds(order->time_ns));
        reply = answer(LockStepKind::kAnswer, process, sockets.take_sent());
        if (quiet_until) reply.instance = static_cast<std::uint64_t>(to_nanoseconds(quiet_until()));
    }
    return std::nullopt;
}

}  // namespace thimble
