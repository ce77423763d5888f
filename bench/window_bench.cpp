// Frames of the window, of the subject's screen and of the cut-away view, in this machine's OpenGL. It prints how long a frame takes, how
// much processor time it uses, and how old the hand's newest sample is on the screen. A busy machine changes the processor time little.
//
//   xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" build/release/bin/thimble-bench-window
#include <cmath>
#include <ctime>

#include <fmt/format.h>

#include "common/runtime/node_program.hpp"
#include "common/runtime/wall_clock.hpp"
#include "visual_node/window/window_loop.hpp"

namespace {

using namespace thimble;

constexpr Duration kTime = std::chrono::seconds{10};

// A needle that presses the tissue in, 0.4 times a second, and the bar with it. Cut away, it goes to the fixture.
Scene scene_at(SessionTime now, SessionTime start, bool cut_away) {
    const double phase = 2 * 3.14159265358979 * 0.4 * to_seconds(now - start);
    Scene scene;
    scene.position_surface_rest_m = 0.02;
    scene.position_needle_m = 0.02 + 0.015 * std::sin(phase);
    scene.position_surface_m = std::max(0.02, scene.position_needle_m);
    scene.bar_shown = true;
    scene.bar_N = 6 + 6 * std::sin(phase);
    if (cut_away) {
        scene.cut_away.emplace();
        scene.cut_away->position_needle_m = 0.07 + 0.06 * std::sin(phase);
        scene.cut_away->position_fixture_m = 0.115;
        scene.cut_away->force_tissue_N = -scene.bar_N;
        scene.cut_away->phase = TissuePhase::kPenetrated;
    }
    scene.sample_time = scene.hand_time = scene.answer_time = now;
    return scene;
}

void print(const char* what, const Histogram& h) {
    const auto ms = [&](double q) { return 1e3 * to_seconds(h.quantile(q)); };
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", what, ms(0.5), ms(0.9), ms(0.99), ms(1));
}

// `paced`: at the window's own pace, else one frame after the other.
void measure(int width, int height, bool paced, bool cut_away) {
    WindowSettings settings;
    settings.width = width;
    settings.height = height;
    settings.vsync = false;
    GlWindow window(settings);
    WindowDisplay display(Duration::zero());
    WindowLoop loop({&window, &display}, Duration::zero(), true);
    const SessionTime start = wall_now();
    const std::clock_t used = std::clock();  // of all threads
    const auto stop = [&] {
        const SessionTime now = wall_now();
        display.draw(now, scene_at(now, start, cut_away));
        return now - start > kTime;
    };
    if (paced) {
        loop.run(stop);
    } else {
        while (!stop()) loop.turn();
    }
    const std::string name = fmt::format("{}x{}, {}, {}", width, height, cut_away ? "cut-away" : "subject",
                                         paced ? "paced" : "unpaced");
    print((name + ": frame begun to swap returned").c_str(), loop.times().draw);
    print((name + ": swap to swap").c_str(), loop.times().interval);
    print((name + ": sample handed over to swap returned").c_str(), loop.times().hand_to_swap);
    const double used_s = static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC;
    fmt::print("| {}: processor time of a frame, mean of {} | {:.2f} | | | |\n", name, loop.frames(),
               1e3 * used_s / static_cast<double>(loop.frames()));
}

}  // namespace

int main() {
    return thimble::guarded_main("thimble-bench-window", [] {
        fmt::print("| ms | median | 90 % | 99 % | worst |\n| --- | --- | --- | --- | --- |\n");
        for (const bool paced : {false, true}) measure(800, 600, paced, false);
        for (const bool cut_away : {false, true}) {
            for (const bool paced : {false, true}) measure(1280, 800, paced, cut_away);
        }
        return 0;
    });
}
