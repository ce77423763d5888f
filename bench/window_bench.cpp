// Frames of the subject's window: how long one takes, in this machine's OpenGL.
//
//   xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" build/release/bin/thimble-bench-window
#include <cmath>

#include <fmt/format.h>

#include "common/runtime/node_program.hpp"
#include "common/runtime/wall_clock.hpp"
#include "visual_node/window/window_loop.hpp"

namespace {

using namespace thimble;

constexpr Duration kTime = std::chrono::seconds{10};

// A needle that presses the tissue in, 0.4 times a second, and the bar with it.
Scene scene_at(SessionTime now, SessionTime start) {
    const double phase = 2 * 3.14159265358979 * 0.4 * to_seconds(now - start);
    Scene scene;
    scene.position_surface_rest_m = 0.02;
    scene.position_needle_m = 0.02 + 0.015 * std::sin(phase);
    scene.position_surface_m = std::max(0.02, scene.position_needle_m);
    scene.bar_shown = true;
    scene.bar_N = 6 + 6 * std::sin(phase);
    scene.sample_time = scene.hand_time = scene.answer_time = now;
    return scene;
}

void print(const char* what, const Histogram& h) {
    const auto ms = [&](double q) { return 1e3 * to_seconds(h.quantile(q)); };
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", what, ms(0.5), ms(0.9), ms(0.99), ms(1));
}

// `paced`: at the window's own pace, else one frame after the other.
void measure(int width, int height, bool paced) {
    WindowSettings settings;
    settings.width = width;
    settings.height = height;
    settings.vsync = false;
    GlWindow window(settings);
    WindowDisplay display(Duration::zero());
    WindowLoop loop({&window, &display}, Duration::zero(), true);
    const SessionTime start = wall_now();
    const auto stop = [&] {
        const SessionTime now = wall_now();
        display.draw(now, scene_at(now, start));
        return now - start > kTime;
    };
    if (paced) {
        loop.run(stop);
    } else {
        while (!stop()) loop.turn();
    }
    print(fmt::format("{}x{}, {}: frame begun to swap returned", width, height, paced ? "paced" : "unpaced")
              .c_str(),
          loop.times().draw);
    print(fmt::format("{}x{}, {}: swap to swap", width, height, paced ? "paced" : "unpaced").c_str(),
          loop.times().interval);
}

}  // namespace

int main() {
    return thimble::guarded_main("thimble-bench-window", [] {
        fmt::print("| ms | median | 90 % | 99 % | worst |\n| --- | --- | --- | --- | --- |\n");
        for (const bool paced : {false, true}) measure(800, 600, paced);
        measure(1280, 1000, true);
        return 0;
    });
}
