#include <charconv>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/decimal_text.hpp"
#include "common/runtime/wall_clock.hpp"
#include "netem/shell/programs.hpp"

namespace thimble {
namespace {

constexpr int kRounds = 300;  // of kRound
constexpr int kPoliteRounds = 100;
constexpr Duration kRound = std::chrono::milliseconds{10};

// Field 4 of /proc/PID/stat; the name before it may hold anything, also brackets.
std::optional<pid_t> parent_of(const std::filesystem::path& folder) {
    std::ifstream file(folder / "stat");
    std::string line;
    std::getline(file, line);
    const std::size_t end = line.rfind(") ");
    if (end == std::string::npos || line.size() < end + 5) return std::nullopt;
    if (line[end + 2] == 'Z') return std::nullopt;  // has ended
    pid_t parent = 0;
    std::from_chars(line.data() + end + 4, line.data() + line.size(), parent);
    return parent;
}

std::map<pid_t, pid_t> all_parents() {
    std::map<pid_t, pid_t> parents;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
        const auto process = parse_whole<pid_t>(entry.path().filename().string());
        if (!process) continue;
        if (const auto parent = parent_of(entry.path())) parents[*process] = *parent;
    }
    return parents;
}

std::vector<pid_t> descendants(pid_t spared) {
    const auto parents = all_parents();
    std::vector<pid_t> found{getpid()};
    for (std::size_t i = 0; i < found.size(); ++i) {
        for (const auto& [process, parent] : parents) {
            if (parent == found[i] && process != spared) found.push_back(process);
        }
    }
    found.erase(found.begin());
    return found;
}

}  // namespace

void adopt_orphans() { prctl(PR_SET_CHILD_SUBREAPER, 1UL, 0UL, 0UL, 0UL); }

void signal_descendants(int number, pid_t spared) {
    for (const pid_t process : descendants(spared)) kill(process, number);
}

void end_descendants(pid_t spared) {
    for (int round = 0; round < kRounds; ++round) {
        const std::vector<pid_t> left = descendants(spared);
        if (left.empty()) break;
        if (round == 0 || round >= kPoliteRounds) {
            for (const pid_t process : left) kill(process, round == 0 ? SIGTERM : SIGKILL);
        }
        wall_sleep(kRound);
        // `spared` must stay for its own waiter.
        for (const pid_t process : left) waitpid(process, nullptr, WNOHANG);
    }
}

}  // namespace thimble
