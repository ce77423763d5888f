#include "tests/views/view_bench.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>

#include "common/runtime/wall_clock.hpp"
#include "visual_node/window/image.hpp"

namespace thimble {
namespace {

// The colour behind text and edges.
constexpr int kColourTolerance = 12;

}  // namespace

bool wait_for(FakeSession& session, OrderKind kind, int count) {
    return wait_until([&] { return session.count(kind) >= count; });
}

ViewBench::ViewBench(const std::vector<std::string>& more_arguments) {
    std::vector<std::string> arguments{"--view",           "experimenter",
                                       "--base-port",      std::to_string(ports_.base()),
                                       "--width",          "800",
                                       "--height",         "600",
                                       "--scale",          "1",
                                       "--screenshot",     folder_ / "last.png",
                                       "--die-with-parent"};
    if (!more_arguments.empty()) {
        arguments.erase(arguments.begin() + 4, arguments.begin() + 10);
        arguments.insert(arguments.end(), more_arguments.begin(), more_arguments.end());
    }
    view_.emplace(std::filesystem::path(THIMBLE_BIN_DIR) / "thimble-visual", arguments, folder_ / "words");
}

bool ViewBench::ready() {
    return screen_.ready() &&
           wait_until([this] { return read_text(folder_ / "words").find("ready") != std::string::npos; }) &&
           screen_.wait_for_window("Thimble, experimenter");
}

Image ViewBench::end() {
    view_->signal(SIGTERM);
    if (view_->wait(kPatience) != 0) return {};
    return read_png(folder_ / "last.png");
}

void view_sleep(double seconds) { wall_sleep(from_seconds(seconds)); }

int distance(const Image& image, int x, int y, Colour colour) {
    const Rgb pixel = image.at(x, y);
    return std::max(
        {std::abs(pixel[0] - colour[0]), std::abs(pixel[1] - colour[1]), std::abs(pixel[2] - colour[2])});
}

int count_pixels(const Image& image, const Rect& rect, Colour colour) {
    int count = 0;
    for (int y = static_cast<int>(rect.y); y < static_cast<int>(std::floor(rect.bottom())); ++y) {
        for (int x = static_cast<int>(rect.x); x < static_cast<int>(std::floor(rect.right())); ++x) {
            count += distance(image, x, y, colour) <= kColourTolerance;
        }
    }
    return count;
}

}  // namespace thimble
