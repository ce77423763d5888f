#include "common/process/sandbox.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <unistd.h>

#include "common/error.hpp"
#include "common/process/child.hpp"
#include "common/text_file.hpp"

namespace thimble {
namespace {

constexpr const char* kInside = "THIMBLE_SANDBOX";

std::vector<std::string> own_command() {
    std::ifstream file("/proc/self/cmdline", std::ios::binary);
    const std::string all(std::istreambuf_iterator<char>(file), {});
    std::vector<std::string> words;
    for (std::string_view left = all; !left.empty();) words.emplace_back(take_until(left, '\0'));
    words.front() = std::filesystem::read_symlink("/proc/self/exe").string();
    return words;
}

std::vector<std::string> walls() {
    return {"--ro-bind", "/", "/", "--dev", "/dev", "--proc", "/proc", "--unshare-all", "--die-with-parent"};
}

}  // namespace

bool in_sandbox() { return std::getenv(kInside) != nullptr; }

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

void enter_sandbox(const std::vector<std::filesystem::path>& writable) {
    if (in_sandbox()) return;
    std::vector<std::string> words = walls();
    for (const std::filesystem::path& folder : writable) {
        std::filesystem::create_directories(folder);
        const std::string place = std::filesystem::absolute(folder).string();
        words.insert(words.end(), {"--bind", place, place});
    }
    words.insert(words.end(), {"--setenv", kInside, "1", "--"});
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
