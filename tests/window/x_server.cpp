#include "tests/window/x_server.hpp"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <unistd.h>

#include "common/error.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

// Xvfb writes the number when it can be used.
std::string read_display(int descriptor) {
    std::string number;
    char digit = 0;
    while (read(descriptor, &digit, 1) == 1 && digit != '\n') number += digit;
    return number;
}

fs::path fresh_folder() {
    std::string name = (fs::temp_directory_path() / "thimble_window_XXXXXX").string();
    return mkdtemp(name.data());
}

// A number that no other test's server gets, also not when this one is gone: what waits for its screen to come back would find
// that one's, with another person's keys. Xvfb's own choice is the lowest free one.
std::string own_number() {
    static int servers = 0;
    return std::to_string(1000 + 10 * (getpid() % 5000) + servers++ % 10);
}

}  // namespace

XServer::XServer() : folder_(fresh_folder()), number_(own_number()) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    try {
        server_.emplace("Xvfb",
                        std::vector<std::string>{":" + number_, "-displayfd", "1", "-screen", "0",
                                                 "1280x1024x24", "-nolisten", "tcp", "-noreset"},
                        folder_ / "server", ChildStreams{-1, ends[1]});
    } catch (const Error&) {
        missing_ = "Xvfb is not installed (deploy/packages.txt, [test])";
    }
    close(ends[1]);
    const bool up = read_display(ends[0]) == number_;
    close(ends[0]);
    if (!up && missing_.empty()) missing_ = "Xvfb does not start: " + server_->last_lines();
    if (missing_.empty()) setenv("DISPLAY", (":" + number_).c_str(), 1);
}

XServer::~XServer() {
    unsetenv("DISPLAY");
    server_.reset();
    for (const std::string& left : {"/tmp/.X" + number_ + "-lock", "/tmp/.X11-unix/X" + number_}) {
        std::error_code absent;
        fs::remove(left, absent);  // by a killed one
    }
    fs::remove_all(folder_);
}

void XServer::kill() {
    server_->signal(SIGKILL);
    server_->wait(std::chrono::milliseconds{500});  // in a death test it is not this program's child
}

}  // namespace thimble
