#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <list>
#include <mutex>
#include <optional>
#include <poll.h>
#include <spawn.h>
#include <string>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "common/control/built_in_controllers.hpp"
#include "common/control/control_settings.hpp"
#include "common/error.hpp"
#include "common/text_file.hpp"

extern char** environ;

namespace thimble {
namespace {

// examples/controller/thimble_controller.py reads these.
enum class Call : std::uint64_t { kCreate = 1, kStart, kNetworkChanged, kSample, kReceive, kForget, kForce };
constexpr std::size_t kMostPythonKeys = 8;
constexpr std::string_view kPythonGreeting = "thimble controller 1";  // first line of a description
struct Record {
    Call call;
    std::array<double, 13> numbers;
};
static_assert(sizeof(Record) == 112);
constexpr int kMostSecondsToDescribe = 10, kMostMillisecondsToEnd = 1000;
constexpr std::size_t kMostDescription = 65536;

// Blocks the terminal's signals in the program that is started: Thimble ends it.
class SpawnAttributes {
  public:
    SpawnAttributes() {
        sigset_t blocked;
        pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
        for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&blocked, number);
        posix_spawnattr_init(&attributes_);
        posix_spawnattr_setsigmask(&attributes_, &blocked);
        posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK);
    }
    ~SpawnAttributes() { posix_spawnattr_destroy(&attributes_); }
    SpawnAttributes(const SpawnAttributes&) = delete;
    SpawnAttributes& operator=(const SpawnAttributes&) = delete;
    const posix_spawnattr_t* get() const { return &attributes_; }

  private:
    posix_spawnattr_t attributes_{};
};

// Its standard input and output are this end's socket.
class PythonChild {
  public:
    PythonChild(const std::string& file, const char* option) {
        std::array<int, 2> ends{};
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
            throw Error(ExitCode::kRunFailed, "plug-in {}: no socket: {}", file, std::strerror(errno));
        ours_.emplace(ends[0]);
        const FileDescriptor theirs(ends[1]);
        posix_spawn_file_actions_t files;
        posix_spawn_file_actions_init(&files);
        posix_spawn_file_actions_adddup2(&files, theirs.get(), STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&files, theirs.get(), STDOUT_FILENO);
        std::array<std::string, 5> words{"python3", "-B", "-u", file, option};
        std::array<char*, 6> arguments{};
        for (std::size_t i = 0; i < words.size(); ++i) arguments.at(i) = words.at(i).data();
        const SpawnAttributes attributes;
        const int failed =
            posix_spawnp(&pid_, "python3", &files, attributes.get(), arguments.data(), environ);
        posix_spawn_file_actions_destroy(&files);
        if (failed != 0)
            throw Error(ExitCode::kUsage, "plug-in {}: python3 cannot be started: {}", file,
                        std::strerror(failed));
    }
    ~PythonChild() {
        ours_.reset();  // the child reads the end of its input
        if (pid_ <= 0) return;
        for (int i = 0; i < kMostMillisecondsToEnd; ++i) {
            if (waitpid(pid_, nullptr, WNOHANG) != 0) return;
            poll(nullptr, 0, 1);
        }
        kill(pid_, SIGKILL);
        while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
    PythonChild(const PythonChild&) = delete;
    PythonChild& operator=(const PythonChild&) = delete;

    void give(const Record& record) const {
        if (send(ours_->get(), &record, sizeof record, MSG_NOSIGNAL) != ssize_t{sizeof record}) fail();
    }
    double take() const {
        double answer = 0;
        if (recv(ours_->get(), &answer, sizeof answer, MSG_WAITALL) != ssize_t{sizeof answer}) fail();
        return answer;
    }
    // Until its end. False: it took too long, or said too much.
    bool take_all(std::string& all) const {
        const timeval limit{kMostSecondsToDescribe, 0};
        setsockopt(ours_->get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
        std::array<char, 4096> block{};
        ssize_t got = 0;
        while ((got = recv(ours_->get(), block.data(), block.size(), 0)) > 0) {
            all.append(block.data(), static_cast<std::size_t>(got));
            if (all.size() > kMostDescription) return false;
        }
        return got == 0;
    }

  private:
    [[noreturn]] static void fail() {
        throw Error(ExitCode::kRunFailed, "its Python program has ended: see its messages above");
    }

    std::optional<FileDescriptor> ours_;
    pid_t pid_ = -1;
};

// The handle's end. Only create and force wait for an answer.
class PythonEnd {
  public:
    explicit PythonEnd(const thimble_controller_settings& s) : child_(s.file, "--serve") {
        Record record{Call::kCreate, {s.sample_period_s, s.position_scale, s.force_scale, s.force_limit_N}};
        std::copy_n(s.values, s.value_count, record.numbers.begin() + 4);
        child_.give(record);
        child_.take();
    }
    void start(double delay_s) const { child_.give({Call::kStart, {delay_s}}); }
    void network_changed(double delay_s) const { child_.give({Call::kNetworkChanged, {delay_s}}); }
    void sample(const thimble_handle& h, thimble_packet& /*out*/) const {
        child_.give({Call::kSample,
                     {h.time_s, h.elapsed_s, h.position_hand_m, h.velocity_hand_m_per_s, h.force_hand_N}});
    }
    void receive(const thimble_feedback& f) const { child_.give({Call::kReceive, numbers(f)}); }
    void forget() const { child_.give({Call::kForget, {}}); }
    double force_N(const thimble_feedback& f) const {
        child_.give({Call::kForce, numbers(f)});
        return child_.take();
    }

  private:
    static std::array<double, 13> numbers(const thimble_feedback& f) {
        return {f.position_hand_m, f.force_total_hand_N,        f.force_fixture_hand_N, f.force_tissue_hand_N,
                f.age_s,           static_cast<double>(f.known)};
    }

    PythonChild child_;
};

// A table with the texts and keys that it points to.
struct PythonTable {
    std::string file, name;
    std::list<std::string> texts;
    std::vector<thimble_controller_key> keys;
    thimble_controller table{};
};

double number(const std::string& file, std::string_view text) {
    const std::string copy(text);
    char* end = nullptr;
    const double value = std::strtod(copy.c_str(), &end);
    if (end != copy.c_str() && *end == '\0') return value;
    throw Error(ExitCode::kUsage, "plug-in {}: '{}' in its KEYS is not a number", file, copy);
}

// Greeting, name, then a line for each key: name, default, least, most, help, with tabs between.
void describe(std::string_view text, PythonTable& python) {
    if (take_until(text, '\n') != kPythonGreeting)
        throw Error(ExitCode::kUsage,
                    "plug-in {}: it does not describe itself: it must call serve() of this version's "
                    "thimble_controller.py, and print nothing before the import (examples/controller)",
                    python.file);
    python.name = std::string(take_until(text, '\n'));
    while (!text.empty() && python.keys.size() < kMostPythonKeys) {
        std::string_view line = take_until(text, '\n');
        thimble_controller_key key{};
        key.name = python.texts.emplace_back(take_until(line, '\t')).c_str();
        key.fallback = number(python.file, take_until(line, '\t'));
        key.low = number(python.file, take_until(line, '\t'));
        key.high = number(python.file, take_until(line, '\t'));
        key.help = python.texts.emplace_back(line).c_str();
        python.keys.push_back(key);
    }
    if (!text.empty())
        throw Error(ExitCode::kUsage, "plug-in {}: it has more than {} keys", python.file, kMostPythonKeys);
}

void fill_in(PythonTable& python) {
    using To = ControllerFunctions<PythonEnd>;
    python.table = with_memory<PythonEnd>(with_handle<PythonEnd>({}));
    python.table.create = [](const thimble_controller_settings* settings) -> void* {
        return new PythonEnd(*settings);
    };
    python.table.network_changed = [](void* self, double delay_s) { To::of(self).network_changed(delay_s); };
    python.table.name = python.name.c_str();
    python.table.keys = python.keys.data();
    python.table.key_count = static_cast<std::uint32_t>(python.keys.size());
}

}  // namespace

const thimble_controller* python_controller(const std::filesystem::path& file) {
    static std::mutex mutex;
    static std::list<PythonTable> known;  // a plug-in stays loaded until the program ends
    PythonTable python;
    python.file = file.string();
    std::string text;
    if (!PythonChild(python.file, "--describe").take_all(text))
        throw Error(
            ExitCode::kUsage,
            "plug-in {}: it does not describe itself within {} s: call serve() first (examples/controller)",
            python.file, kMostSecondsToDescribe);
    describe(text, python);
    const std::lock_guard lock(mutex);
    PythonTable& kept = known.emplace_back(std::move(python));
    fill_in(kept);
    return &kept.table;
}

}  // namespace thimble
