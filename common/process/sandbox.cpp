#include "common/process/sandbox.hpp"

#include <cerrno>
#include <cstring>
#include <unistd.h>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/process/child.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

// Only the inside has it: /run is bwrap's own there.
constexpr const char* kInside = "/run/thimble-sandbox";

std::vector<std::string> own_command() {
    const std::string all = read_text_file("/proc/self/cmdline");
    std::vector<std::string> words;
    for (std::string_view left = all; !left.empty();) words.emplace_back(take_until(left, '\0'));
    words.front() = std::filesystem::read_symlink("/proc/self/exe").string();
    return words;
}

// The sockets of most other programs lie in /run and /tmp: a file that may only be read still connects.
std::vector<std::string> walls() {
    return {"--ro-bind",
            "/",
            "/",
            "--dev",
            "/dev",
            "--proc",
            "/proc",
            "--tmpfs",
            "/run",
            "--tmpfs",
            "/tmp",
            "--dir",
            kInside,
            "--unshare-all",
            "--new-session",
            "--die-with-parent"};
}

std::filesystem::path full(const std::filesystem::path& folder) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(folder));
}

void mount(std::vector<std::string>& words, const char* how, const std::string& place) {
    words.insert(words.end(), {how, place, place});
}

// Back into the empty /run and /tmp. The rest is visible anyhow.
void show(std::vector<std::string>& words, const std::filesystem::path& folder) {
    const std::string place = full(folder).string();
    if (place.starts_with("/run/") || place.starts_with("/tmp/")) mount(words, "--ro-bind", place);
}

}  // namespace

bool in_sandbox() { return std::filesystem::is_directory(kInside); }

std::string why_no_sandbox() {
    if (in_sandbox()) return {};
    std::vector<std::string> words = walls();
    words.emplace_back("true");
    try {
        const ProgramResult tried = run_program("bwrap", words, ".", "install the package bubblewrap");
        return tried.exit_code == 0 ? "" : "bwrap cannot make namespaces here: " + tried.output;
    } catch (const Error& missing) {
        return missing.what();
    }
}

void enter_sandbox(const std::vector<std::filesystem::path>& writable,
                   const std::vector<std::filesystem::path>& readable) {
    if (in_sandbox()) return;
    std::vector<std::string> words = walls();
    show(words, std::filesystem::current_path());
    show(words, program_folder().parent_path());
    for (const std::filesystem::path& folder : readable) {
        if (full(folder) == "/tmp" || full(folder) == "/run")
            throw Error(
                ExitCode::kUsage,
                "--sandbox: a plug-in lies directly in {}, which the sandbox hides: move it into a folder",
                full(folder).string());
        show(words, folder);
    }
    for (const std::filesystem::path& folder : writable) {
        std::filesystem::create_directories(folder);
        mount(words, "--bind", full(folder).string());
    }
    words.emplace_back("--");
    const std::vector<std::string> command = own_command();
    words.insert(words.end(), command.begin(), command.end());
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 2);
    std::string program = "bwrap";
    arguments.push_back(program.data());
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execvp("bwrap", arguments.data());
    throw Error(ExitCode::kRunFailed, "--sandbox: bwrap cannot be started: {}", std::strerror(errno));
}

}  // namespace thimble
