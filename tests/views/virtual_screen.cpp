#include "tests/views/virtual_screen.hpp"

#include <cstdlib>
#include <thread>
#include <unistd.h>

namespace thimble {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

bool in_path(const std::string& program) {
    const char* path = std::getenv("PATH");
    std::string folders = path == nullptr ? "" : path;
    for (std::size_t begin = 0; begin <= folders.size();) {
        const std::size_t end = std::min(folders.find(':', begin), folders.size());
        if (access((fs::path(folders.substr(begin, end - begin)) / program).c_str(), X_OK) == 0) return true;
        begin = end + 1;
    }
    return false;
}

}  // namespace

std::string missing_for_windows() {
    for (const char* program : {"Xvfb", "xdotool"}) {
        if (!in_path(program))
            return std::string(program) + " is not installed (deploy/packages.txt, [test])";
    }
    return "";
}

bool VirtualScreen::hand(const std::vector<std::string>& words) const {
    Child tool("xdotool", words, folder_ / "xdotool");
    return tool.wait(kPatience) == 0;
}

bool VirtualScreen::wait_for_window(const std::string& title) {
    // xdotool prints the window's number, and nothing else.
    Child tool("xdotool", {"search", "--sync", "--onlyvisible", "--name", title}, folder_ / "found");
    if (tool.wait(kPatience) != 0) return false;
    const std::string found = read_text(folder_ / "found");
    window_ = found.substr(0, found.find('\n'));
    return hand({"windowfocus", "--sync", window_});
}

bool VirtualScreen::click(int x, int y) const {
    if (!hand({"mousemove", "--sync", "--window", window_, std::to_string(x), std::to_string(y)}))
        return false;
    std::this_thread::sleep_for(milliseconds{100});
    if (!hand({"mousedown", "1"})) return false;
    std::this_thread::sleep_for(milliseconds{100});
    return hand({"mouseup", "1"});
}

bool VirtualScreen::resize(int width, int height) const {
    return hand({"windowsize", "--sync", window_, std::to_string(width), std::to_string(height)});
}

}  // namespace thimble
