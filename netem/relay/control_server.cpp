#include "netem/relay/control_server.hpp"

#include <cerrno>
#include <cstring>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <vector>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/relay/control_text.hpp"
#include "netem/relay/relay_report.hpp"

namespace thimble {
namespace {

constexpr std::size_t kLongestAnswerBytes = 65536;
constexpr int kPatience_ms = 5000;
constexpr Duration kAskerPatience = std::chrono::seconds{2};

struct Address {
    sockaddr_un name{};
    socklen_t size = sizeof(sockaddr_un);
    sockaddr* raw() { return static_cast<sockaddr*>(static_cast<void*>(&name)); }
};

Address address_of(const std::filesystem::path& path) {
    Address address;
    address.name.sun_family = AF_UNIX;
    const std::string text = path.string();
    if (text.empty() || text.size() >= sizeof address.name.sun_path) {
        throw Error(ExitCode::kUsage, "--control: '{}' must have 1 to {} characters", text,
                    sizeof address.name.sun_path - 1);
    }
    std::memcpy(address.name.sun_path, text.c_str(), text.size() + 1);
    return address;
}

int open_socket() {
    const int opened = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (opened < 0) {
        throw Error(ExitCode::kNetwork, "cannot open a control socket: {}", std::strerror(errno));
    }
    return opened;
}

// Only a socket without a listener may be replaced.
void remove_stale(const std::filesystem::path& path) {
    struct stat found {};
    if (lstat(path.c_str(), &found) != 0) return;
    if (S_ISSOCK(found.st_mode)) {
        Address address = address_of(path);
        const int probe = open_socket();
        const bool refused = connect(probe, address.raw(), address.size) != 0;
        const bool dead = refused && errno == ECONNREFUSED;  // EPROTOTYPE: it lives, and is of another kind
        close(probe);
        if (dead && unlink(path.c_str()) == 0) return;
    }
    throw Error(ExitCode::kNetwork,
                "--control: '{}' exists and is in use or not a socket: choose another path", path.string());
}

// The kernel gives the file the mode of the socket it is bound from: never open to others, not even for a moment.
bool bind_and_listen(int opened, const std::filesystem::path& path) {
    Address address = address_of(path);
    return fchmod(opened, 0600) == 0 && bind(opened, address.raw(), address.size) == 0 &&
           chmod(path.c_str(), 0600) == 0 && listen(opened, kMostVisitors) == 0;
}

// The socket listens before it has its name, so no program finds it without a listener. link() never replaces a file, as rename() would.
int listen_at(const std::filesystem::path& path) {
    address_of(path);
    remove_stale(path);
    const std::filesystem::path nameless = path.parent_path() / fmt::format(".{}", getpid());
    const int opened = open_socket();
    const bool made = bind_and_listen(opened, nameless) && link(nameless.c_str(), path.c_str()) == 0;
    const std::string why = std::strerror(errno);
    unlink(nameless.c_str());
    if (made) return opened;
    close(opened);
    throw Error(ExitCode::kNetwork, "--control: cannot make '{}': {}", path.string(), why);
}

bool readable(int descriptor, int timeout_ms) {
    pollfd wanted{descriptor, POLLIN, 0};
    return poll(&wanted, 1, timeout_ms) > 0;
}

}  // namespace

ControlServer::ControlServer(const std::filesystem::path& path)
    : path_(path),
      server_(listen_at(path), kAskerPatience, kLongestRequestBytes,
              [this](std::string_view said) { return answer(said); }) {}

ControlServer::~ControlServer() { unlink(path_.c_str()); }

std::string ControlServer::answer(std::string_view request) {
    nlohmann::ordered_json json{{"ok", true}};
    try {
        const ControlRequest wanted = parse_request(request);
        RelayState state = mailbox_.ask([](SteeredRelay& relay) { return relay.state(wall_now()); });
        if (wanted.verb == ControlRequest::Verb::kSet) {
            const LinkPair links = assign(state.links, wanted.assignments);
            state = mailbox_.ask([&](SteeredRelay& relay) {
                relay.change(wall_now(), links);
                return relay.state(wall_now());
            });
        }
        json.update(describe(state));
    } catch (const std::exception& error) {
        json = {{"ok", false}, {"error", error.what()}};
    }
    // Text from outside may stand in the error: what is not UTF-8 is replaced.
    return json_text(json);
}

nlohmann::ordered_json ask_relay(const std::filesystem::path& path, const std::string& request) {
    Address address = address_of(path);
    struct Closer {
        int descriptor;
        ~Closer() { close(descriptor); }
    } mine{open_socket()};
    std::vector<char> answer(kLongestAnswerBytes);
    if (connect(mine.descriptor, address.raw(), address.size) != 0 ||
        send(mine.descriptor, request.data(), request.size(), MSG_NOSIGNAL) < 0) {
        throw Error(ExitCode::kNetwork, "no relay listens at '{}': {}; start one with --control {}",
                    path.string(), std::strerror(errno), path.string());
    }
    const auto size =
        readable(mine.descriptor, kPatience_ms) ? recv(mine.descriptor, answer.data(), answer.size(), 0) : -1;
    if (size <= 0) {
        throw Error(ExitCode::kNetwork, "the relay at '{}' does not answer: is it running?", path.string());
    }
    auto json = nlohmann::ordered_json::parse(answer.data(), answer.data() + size, nullptr, false);
    if (!json.is_object() || !json.value("ok", false)) {
        throw Error(ExitCode::kUsage,
                    json.is_object() ? json.value("error", "refused") : "the answer is not JSON");
    }
    return json;
}

}  // namespace thimble
