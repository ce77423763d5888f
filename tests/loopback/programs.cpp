#include "tests/loopback/programs.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <sstream>

namespace thimble {
namespace {

namespace fs = std::filesystem;

// Empty for one that has ended and was not yet waited for.
std::vector<std::string> command_line(const fs::path& process) {
    std::ifstream file(process / "cmdline", std::ios::binary);
    std::vector<std::string> words;
    for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
    return words;
}

bool is_node(const std::vector<std::string>& words, std::uint16_t base_port, const std::string& program) {
    const auto flag = std::find(words.begin(), words.end(), "--base-port");
    if (flag == words.end() || std::next(flag) == words.end() ||
        *std::next(flag) != std::to_string(base_port)) {
        return false;
    }
    return std::any_of(words.begin(), flag,
                       [&](const std::string& word) { return fs::path(word).filename() == program; });
}

struct ProcessState {
    char state = 'X';  // as proc(5) has it; X: there is none
    pid_t parent = 0;
};

// Behind the name, which is in brackets and may hold anything.
ProcessState state_of(const fs::path& process) {
    std::ifstream file(process / "stat");
    const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    const auto name_end = text.rfind(')');
    ProcessState found;
    if (name_end == std::string::npos) return found;
    std::istringstream(text.substr(name_end + 1)) >> found.state >> found.parent;
    return found;
}

template <class Use>
void each_process(const Use& use) {
    std::error_code gone;  // processes come and go while we look
    for (fs::directory_iterator it("/proc", gone), end; it != end; it.increment(gone)) {
        const std::string name = it->path().filename();
        pid_t pid = 0;
        const auto parsed = std::from_chars(name.data(), name.data() + name.size(), pid);
        if (parsed.ptr == name.data() + name.size()) use(pid, it->path());
    }
}

}  // namespace

fs::path built_programs() { return THIMBLE_BIN_DIR; }

void install_programs(const fs::path& folder) {
    fs::create_directories(folder);
    fs::copy_file(built_programs() / "thimble", folder / "thimble");
    for (const char* program : kNodePrograms)
        fs::create_symlink(built_programs() / program, folder / program);
}

void replace_program(const fs::path& file, const std::string& shell_script) {
    fs::remove(file);
    std::ofstream(file) << "#!/bin/sh\n" << shell_script << '\n';
    fs::permissions(file, fs::perms::owner_all);
}

// A program that computes gets of the processor what others leave. So only one that hangs is given up, a little before ctest does.
constexpr auto kWholeStudy = 4 * kPatience;

Outcome run_to_end(const fs::path& program, const std::vector<std::string>& arguments) {
    const Folder folder;
    Child child(program, arguments, folder / "words");
    Outcome outcome;
    outcome.code = child.wait(kWholeStudy).value_or(-1);
    outcome.words = read_text(folder / "words");
    return outcome;
}

Outcome run_thimble(const std::vector<std::string>& arguments) {
    return run_to_end(built_programs() / "thimble", arguments);
}

std::vector<pid_t> node_pids(std::uint16_t base_port, const std::string& program) {
    std::vector<pid_t> found;
    each_process([&](pid_t pid, const fs::path& process) {
        if (is_node(command_line(process), base_port, program)) found.push_back(pid);
    });
    return found;
}

std::vector<std::string> nodes_alive(std::uint16_t base_port) {
    std::vector<std::string> names;
    for (const char* program : kNodePrograms) {
        if (!node_pids(base_port, program).empty()) names.emplace_back(program);
    }
    return names;
}

std::vector<pid_t> zombies_of(pid_t parent) {
    std::vector<pid_t> found;
    each_process([&](pid_t pid, const fs::path& process) {
        const ProcessState state = state_of(process);
        if (state.parent == parent && state.state == 'Z') found.push_back(pid);
    });
    return found;
}

bool is_left_over(pid_t pid) {
    const ProcessState state = state_of(fs::path("/proc") / std::to_string(pid));
    return state.state != 'X' && !(state.state == 'Z' && state.parent == 1);
}

}  // namespace thimble
