#include "common/runtime/grant_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/time.h>

#include "common/error.hpp"
#include "common/runtime/udp_socket.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/security/keyed_hash.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMarkBytes = sizeof(GrantMark);

template <class Plain>
std::span<const std::uint8_t> plain_bytes(const Plain& plain) {
    return {static_cast<const std::uint8_t*>(static_cast<const void*>(&plain)), sizeof plain};
}

void limit_waits(int descriptor, int option, Duration limit) {
    const timeval patience{limit.count() / 1'000'000'000, limit.count() / 1000 % 1'000'000};
    setsockopt(descriptor, SOL_SOCKET, option, &patience, sizeof patience);
}

// All of it, or false.
bool read_all(int descriptor, void* out, std::size_t size) {
    return recv(descriptor, out, size, MSG_WAITALL) == static_cast<ssize_t>(size);
}

bool write_all(int descriptor, const void* bytes, std::size_t size) {
    return ::send(descriptor, bytes, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size);
}

int open_tcp(int flags) {
    const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | flags, 0);
    if (descriptor >= 0) return descriptor;
    throw Error(ExitCode::kNetwork, "cannot open a TCP socket: {}{}", std::strerror(errno),
                descriptor_advice(errno));
}

sockaddr_in conductor_at(const Endpoint& endpoint) {
    return UdpAddress::resolved(endpoint.host, endpoint.port, "check [network] host_session").generic();
}

constexpr Duration kWayThere = std::chrono::seconds{10};    // to a conductor
constexpr Duration kTimeToProve = std::chrono::seconds{1};  // of a program that has connected
constexpr std::size_t kMostUnproved = 256;                  // more would use up the descriptors of a program

}  // namespace

// The node's answer to the 32 random bytes that the conductor sends first.
struct GrantStream::Hello {
    std::uint16_t version = kLockStepVersion;
    std::array<char, 30> program{};  // filled up with zeros
    GrantMark random{}, proof{};
};

struct GrantStream::Marked {
    LockStepMessage message;
    GrantMark mark{};
};

SecretKey read_grant_key(const std::string& digits) {
    SecretKey key;
    std::size_t size = 0;
    const int read = sodium_hex2bin(key.bytes.data(), key.bytes.size(), digits.data(), digits.size(), nullptr,
                                    &size, nullptr);
    if (read == 0 && size == key.bytes.size()) return key;
    throw Error(ExitCode::kUsage,
                "{} does not hold the key of a lock-step run, 64 hexadecimal digits: 'thimble run --clock "
                "lock-step' sets it (docs/clocks.md)",
                kGrantKeyVariable);
}

std::string grant_key_text(const SecretKey& key) {
    std::string text(2 * key.bytes.size() + 1, '\0');
    sodium_bin2hex(text.data(), text.size(), key.bytes.data(), key.bytes.size());
    text.pop_back();
    return text;
}

GrantStream::GrantStream(int descriptor, Sender self) : descriptor_(descriptor), self_(self) {
    static_assert(sizeof(Marked) == sizeof came_);
    const int at_once = 1;
    setsockopt(descriptor_.get(), IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
}

std::unique_ptr<GrantStream> GrantStream::to_conductor(const Endpoint& conductor, const SecretKey& key,
                                                       const std::string& program) {
    const sockaddr_in address = conductor_at(conductor);
    const int descriptor = open_tcp(0);
    std::unique_ptr<GrantStream> stream(new GrantStream(descriptor, Sender::kNode));
    limit_waits(descriptor, SO_SNDTIMEO, kWayThere);
    limit_waits(descriptor, SO_RCVTIMEO, kWayThere);
    errno = 0;
    if (connect(descriptor, raw(address), sizeof address) == 0 && stream->prove(key, program)) {
        limit_waits(descriptor, SO_RCVTIMEO, kLockStepLook);
        return stream;
    }
    throw Error(ExitCode::kNetwork,
                "cannot reach the lock-step controller at TCP {}:{}: {}; does a firewall block that port "
                "(docs/machines.md)?",
                conductor.host, conductor.port,
                errno == 0 ? "it closed the connection" : std::strerror(errno));
}

// Both ends do the same with what both have said.
void GrantStream::agree(const SecretKey& key, const Hello& hello) {
    KeyedHash(key.bytes, kKeyBytes).add("grants of lock-step").add(hello.proof).finish(key_.bytes);
}

namespace {

GrantMark proof_of(const SecretKey& key, const GrantMark& asked, std::span<const std::uint8_t> said) {
    GrantMark proof{};
    KeyedHash(key.bytes, kMarkBytes).add("a node of lock-step").add(asked).add(said).finish(proof);
    return proof;
}

}  // namespace

bool GrantStream::prove(const SecretKey& key, const std::string& program) {
    GrantMark asked{};
    if (!read_all(descriptor_.get(), asked.data(), asked.size())) return false;
    Hello hello;
    program.copy(hello.program.data(), hello.program.size() - 1);
    system_random_bytes()(hello.random);
    hello.proof = proof_of(key, asked, plain_bytes(hello).first(sizeof hello - kMarkBytes));
    agree(key, hello);
    program_ = program;
    return write_all(descriptor_.get(), &hello, sizeof hello);
}

bool GrantStream::ask() {
    prove_until_ = wall_now() + kTimeToProve;
    system_random_bytes()(asked_);
    return write_all(descriptor_.get(), asked_.data(), asked_.size());
}

GrantStream::Standing GrantStream::admit(const SecretKey& key) {
    const ssize_t size = gather(sizeof(Hello), MSG_DONTWAIT);
    if (size <= 0) {
        const bool waits = size < 0 && (errno == EAGAIN || errno == EINTR) && wall_now() < prove_until_;
        return waits ? Standing::kUnproved : Standing::kTurnedAway;
    }
    Hello hello;
    std::memcpy(&hello, came_.data(), sizeof hello);
    const GrantMark right = proof_of(key, asked_, plain_bytes(hello).first(sizeof hello - kMarkBytes));
    if (!same_bytes(right, hello.proof) || hello.version != kLockStepVersion) return Standing::kTurnedAway;
    agree(key, hello);
    program_.assign(hello.program.begin(), std::find(hello.program.begin(), hello.program.end(), '\0'));
    limit_waits(descriptor_.get(), SO_RCVTIMEO, kLockStepLook);
    return Standing::kProved;
}

// The number keeps a message from standing in for a later one.
void GrantStream::mark(Marked& marked, Sender sender, std::uint64_t number) const {
    KeyedHash(key_.bytes, kMarkBytes)
        .add(plain_bytes(sender))
        .add(plain_bytes(number))
        .add(plain_bytes(marked.message))
        .finish(marked.mark);
}

bool GrantStream::send(const LockStepMessage& message) {
    Marked marked{message, {}};
    mark(marked, self_, sent_++);
    return write_all(descriptor_.get(), &marked, sizeof marked);
}

ssize_t GrantStream::gather(std::size_t wanted, int flags) {
    while (came_bytes_ < wanted) {
        const ssize_t size = recv(descriptor_.get(), came_.data() + came_bytes_, wanted - came_bytes_, flags);
        if (size < 0 && errno == ECONNRESET) return 0;
        if (size <= 0) return size;
        came_bytes_ += static_cast<std::size_t>(size);
    }
    came_bytes_ = 0;
    return static_cast<ssize_t>(wanted);
}

ssize_t GrantStream::receive(LockStepMessage& message) {
    const ssize_t size = gather(sizeof(Marked), 0);
    if (size == 0 && self_ == Sender::kNode && received_ == 0)
        throw Error(ExitCode::kNetwork,
                    "the lock-step controller rejected this program: it has another key or version, or the "
                    "run had already ended; use programs of one build, and read the messages of 'thimble "
                    "run' (docs/clocks.md)");
    if (size <= 0) return size;
    Marked marked, right;
    std::memcpy(&marked, came_.data(), sizeof marked);
    right.message = marked.message;
    mark(right, self_ == Sender::kNode ? Sender::kConductor : Sender::kNode, received_++);
    if (!same_bytes(marked.mark, right.mark))
        throw Error(ExitCode::kNetwork,
                    "a lock-step message that fails the check with the run's key: it was changed on the way "
                    "(docs/clocks.md)");
    message = marked.message;
    return sizeof message;
}

GrantDoor::GrantDoor(const Endpoint& here) : descriptor_(open_tcp(SOCK_NONBLOCK)) {
    prepare_security();
    system_random_bytes()(key_.bytes);
    const sockaddr_in address = conductor_at(here);
    const int again = 1;  // the connections of the last run may linger
    setsockopt(descriptor_.get(), SOL_SOCKET, SO_REUSEADDR, &again, sizeof again);
    if (bind(descriptor_.get(), raw(address), sizeof address) == 0 &&
        listen(descriptor_.get(), SOMAXCONN) == 0)
        return;
    throw Error(ExitCode::kNetwork,
                "cannot listen on TCP {}:{}, where programs on other machines connect: {}; choose another "
                "base_port, or check host_session, in [network]",
                here.host, here.port, std::strerror(errno));
}

// An unproved one gives its place up where too many come: a node with the key has proved it by then.
void GrantDoor::accept_all() {
    for (int came = 0; (came = accept4(descriptor_.get(), nullptr, nullptr, SOCK_CLOEXEC)) >= 0;) {
        std::unique_ptr<GrantStream> stream(new GrantStream(came, GrantStream::Sender::kConductor));
        if (!stream->ask()) continue;
        if (unproved_.size() == kMostUnproved) unproved_.pop_front();
        unproved_.push_back(std::move(stream));
    }
}

std::unique_ptr<GrantStream> GrantDoor::take() {
    accept_all();
    for (auto next = unproved_.begin(); next != unproved_.end();) {
        const auto standing = (*next)->admit(key_);
        if (standing == GrantStream::Standing::kUnproved) {
            ++next;
            continue;
        }
        std::unique_ptr<GrantStream> stream = std::move(*next);
        next = unproved_.erase(next);
        if (standing == GrantStream::Standing::kProved) return stream;
    }
    return nullptr;
}

}  // namespace thimble
