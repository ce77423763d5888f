#include "tests/window/x_server.hpp"

#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <unistd.h>

#include "common/error.hpp"

namespace thimble {
namespace {

// Xvfb writes the number of the display it found free.
std::string read_display(int descriptor) {
    std::string number;
    char digit = 0;
    while (read(descriptor, &digit, 1) == 1 && digit != '\n') number += digit;
    return number;
}

std::filesystem::path fresh_folder() {
    std::string name = (std::filesystem::temp_directory_path() / "thimble_window_XXXXXX").string();
    return mkdtemp(name.data());
}

}  // namespace

XServer::XServer() : folder_(fresh_folder()) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    try {
        server_.emplace("Xvfb",
                        std::vector<std::string>{"-displayfd", "1", "-screen", "0", "1280x1024x24",
                                                 "-nolisten", "tcp", "-noreset"},
                        folder_ / "server", ChildStreams{-1, ends[1]});
    } catch (const Error&) {
        missing_ = "Xvfb is not installed (deploy/packages.txt, [test])";
    }
    close(ends[1]);
    const std::string number = read_display(ends[0]);
    close(ends[0]);
    if (number.empty() && missing_.empty()) missing_ = "Xvfb does not start: " + server_->last_words();
    if (missing_.empty()) setenv("DISPLAY", (":" + number).c_str(), 1);
}

XServer::~XServer() {
    unsetenv("DISPLAY");
    server_.reset();
    std::filesystem::remove_all(folder_);
}

void XServer::kill() {
    server_->signal(SIGKILL);
    server_->wait(std::chrono::milliseconds{500});  // in a death test it is not this program's child
}

}  // namespace thimble
