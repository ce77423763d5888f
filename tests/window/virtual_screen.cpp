#include "tests/window/virtual_screen.hpp"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <thread>
#include <unistd.h>

#include "common/error.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;

// Xvfb writes the number when it can be used.
std::string read_display(int descriptor) {
    std::string number;
    char digit = 0;
    while (read(descriptor, &digit, 1) == 1 && digit != '\n') number += digit;
    return number;
}

// A number that no other test's server gets, also not when this one is gone: what waits for its screen to come back would find
// that one's, with another person's keys. Xvfb's own choice is the lowest free one.
std::string own_number() {
    static int servers = 0;
    return std::to_string(1000 + 10 * (getpid() % 5000) + servers++ % 10);
}

}  // namespace

VirtualScreen::VirtualScreen() : number_(own_number()) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    try {
        const ChildPlace place{{}, "deploy/packages.txt, [test], names its package"};
        Child("xdotool", {"version"}, folder_ / "xdotool", {}, place).wait(kPatience);
        server_.emplace("Xvfb",
                        std::vector<std::string>{":" + number_, "-displayfd", "1", "-screen", "0",
                                                 "1280x1024x24", "-nolisten", "tcp", "-noreset"},
                        folder_ / "server", ChildStreams{-1, ends[1]}, place);
    } catch (const Error& error) {
        missing_ = error.what();
    }
    close(ends[1]);
    const bool up = read_display(ends[0]) == number_;
    close(ends[0]);
    if (!up && missing_.empty()) missing_ = "Xvfb does not start: " + server_->last_lines();
    if (missing_.empty()) setenv("DISPLAY", (":" + number_).c_str(), 1);
}

VirtualScreen::~VirtualScreen() {
    unsetenv("DISPLAY");
    server_.reset();
    for (const std::string& left : {"/tmp/.X" + number_ + "-lock", "/tmp/.X11-unix/X" + number_}) {
        std::error_code absent;
        std::filesystem::remove(left, absent);  // by a killed one
    }
}

void VirtualScreen::kill() {
    server_->signal(SIGKILL);
    server_->wait(milliseconds{500});  // in a death test it is not this program's child
}

bool VirtualScreen::hand(const std::vector<std::string>& words) const {
    return Child("xdotool", words, folder_ / "xdotool").wait(kPatience) == 0;
}

bool VirtualScreen::wait_for_window(const std::string& title) {
    return wait_until([&] {
        window_ = first_line({"search", "--onlyvisible", "--name", title});
        return !window_.empty() && first_line({"windowfocus", window_, "getwindowfocus"}) == window_;
    });
}

std::string VirtualScreen::first_line(const std::vector<std::string>& words) const {
    std::filesystem::remove(folder_ / "found");  // a program's words are added to a file
    if (Child("xdotool", words, folder_ / "found").wait(kPatience) != 0) return {};
    const std::string found = read_text(folder_ / "found");
    return found.substr(0, found.find('\n'));
}

bool VirtualScreen::press_until(const std::string& key, const std::function<bool()>& done) const {
    return wait_until([&] { return press(key) && done(); });
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
