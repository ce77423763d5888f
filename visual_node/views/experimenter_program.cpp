#include <algorithm>
#include <cstdio>
#include <epoxy/gl.h>
#include <string_view>

#include <CLI/CLI.hpp>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/histogram.hpp"
#include "common/json_text.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "common/runtime/sockets.hpp"
#include "common/runtime/wall_clock.hpp"
#include "common/version.hpp"
#include "visual_node/views/experimenter_panels.hpp"
#include "visual_node/window/gl_window.hpp"
#include "visual_node/window/gui_layer.hpp"
#include "visual_node/window/image.hpp"
#include "visual_node/window/painter.hpp"
// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

namespace thimble {
namespace {

struct ViewOptions {
    std::string role, config, screenshot;
    int base_port = 0;
    double seconds = 0;  // 0: until the user closes it
    double scale = 0;    // 0: the monitor's
    int width = 1000, height = 720;
    bool frame_times = false;
    pid_t launcher = 0;  // for stop_with_parent(); 0: this program outlives its launcher
};

WindowSettings window_settings(const ViewOptions& options) {
    WindowSettings settings;
    settings.title = "Thimble, experimenter";
    settings.width = options.width;
    settings.height = options.height;
    settings.content_scale = options.scale;
    settings.vsync = !options.frame_times;
    return settings;
}

nlohmann::ordered_json percentiles(const Histogram& cost) {
    const auto ms = [](Duration duration) { return static_cast<double>(duration.count()) * 1e-6; };
    return {{"frames", cost.count()},
            {"median_ms", ms(cost.quantile(0.5))},
            {"p95_ms", ms(cost.quantile(0.95))},
            {"p99_ms", ms(cost.quantile(0.99))},
            {"worst_ms", ms(cost.worst())}};
}

class ExperimenterView {
  public:
    explicit ExperimenterView(const ViewOptions& options)
        : options_(options),
          sockets_(observed_network(options.config, static_cast<std::uint16_t>(options.base_port))),
          link_(sockets_.between(Port::kExperimenterMonitor, Port::kSessionOrders)),
          stops_(system_entropy(), stop_outlets(sockets_)),
          panels_(system_entropy(), {link_, link_}, &stops_),
          window_(window_settings(options)),
          gui_(window_),
          period_(from_seconds(1 / window_.refresh_Hz())) {}

    int run();

  private:
    bool turn(SessionTime started);
    void look(SessionTime now) {
        sockets_.tick(now);
        panels_.tick(now);
        if (complained_ || sockets_.security() == nullptr) return;
        const std::string complaint = sockets_.security()->complaint();
        complained_ = !complaint.empty();
        if (complained_) spdlog::error(complaint);
    }
    void paint_scene();
    void draw_view(SessionTime now);
    void draw_empty();
    void finish();
    void hear_stop_key(SessionTime now, std::span<const WindowEvent> events);

    ViewOptions options_;
    Sockets sockets_;
    Channel* link_;
    StopControl stops_;
    unsigned stops_heard_ = 0;  // of emergency_stops()
    bool complained_ = false;   // of another lab key
    ExperimenterPanels panels_;
    GlWindow window_;
    GuiLayer gui_;
    MeshPainter painter_;
    Mesh mesh_;
    Duration period_;
    SessionTime due_{};  // next frame
    // How long frames take to draw: of the view and of an empty window in the same run, because only their ratio means
    // something on a busy machine.
    Histogram empty_cost_, view_cost_;
    Image last_;
};

// Sent directly to every program: the session may hang.
void ExperimenterView::hear_stop_key(SessionTime now, std::span<const WindowEvent> events) {
    for (const WindowEvent& event : events) {
        const bool pressed = event.kind == WindowEvent::Kind::kKey && event.pressed && !event.repeated;
        if (pressed && event.key == GLFW_KEY_BACKSPACE)
            stops_.stop(now, "the stop key in the experimenter's view");
    }
    if (emergency_stops() != stops_heard_) {
        stops_heard_ = emergency_stops();
        stops_.stop(now, "SIGQUIT to the experimenter's view");
    }
    stops_.tick(now);
}

// Without swapping: the compositor's time belongs to neither.
void ExperimenterView::draw_empty() {
    const SessionTime begin = wall_now();
    window_.begin_frame(kBlack);
    glFinish();
    empty_cost_.add(wall_now() - begin);
}

void ExperimenterView::paint_scene() {
    const auto scene = panels_.scene();
    if (!scene) return;
    const int width = window_.width(), height = window_.height();
    const ExperimenterLayout layout = experimenter_layout(width, height, window_.content_scale());
    build_cutaway(*scene, plan_cutaway(layout.scene), mesh_);
    painter_.paint(mesh_, width, height);
}

void ExperimenterView::draw_view(SessionTime now) {
    const SessionTime begin = wall_now();
    window_.begin_frame(kBackground);
    paint_scene();
    gui_.begin();
    panels_.draw(now, {window_, nullptr});
    gui_.end();
    if (!options_.frame_times || window_.lost()) return;
    glFinish();
    view_cost_.add(wall_now() - begin);
}

// One frame, and what comes in until the next is due. False when it is time to end.
bool ExperimenterView::turn(SessionTime started) {
    const SessionTime now = wall_now();
    if (options_.frame_times && !window_.lost()) draw_empty();
    look(now);
    draw_view(now);
    const bool over = stop_requested() || window_.should_close() ||
                      (options_.seconds > 0 && now - started >= from_seconds(options_.seconds));
    if (over && !window_.lost() && !options_.screenshot.empty()) last_ = window_.read_pixels();
    window_.end_frame();
    due_ = std::max(due_ + period_, now);
    for (SessionTime at = wall_now(); at < due_ && !over; at = wall_now()) {
        hear_stop_key(at, window_.wait_events(due_ - at));
        look(at);
        if (window_.should_close() || stop_requested()) break;
    }
    hear_stop_key(wall_now(), window_.poll_events());
    return !over;
}

void ExperimenterView::finish() {
    if (last_.width > 0) write_png(options_.screenshot, last_);
    if (!options_.frame_times) return;
    const nlohmann::ordered_json report{{"width", window_.width()},
                                        {"height", window_.height()},
                                        {"empty", percentiles(empty_cost_)},
                                        {"view", percentiles(view_cost_)}};
    std::printf("%s\n", json_text(report, 2).c_str());
}

int ExperimenterView::run() {
    install_stop_signals(QuitSignal::kStopsEverything);
    spdlog::info("ready");
    const SessionTime started = wall_now();
    due_ = started;
    while (turn(started)) {
    }
    if (window_.lost())
        throw Error(ExitCode::kRunFailed, "the view has lost its screen: start it again on another screen");
    finish();
    return static_cast<int>(ExitCode::kOk);
}

void add_options(CLI::App& app, ViewOptions& options) {
    app.add_option("--role", options.role,
                   "experimenter, for this view; thimble-visual --help shows the others")
        ->required();
    app.add_option("session", options.config, "session file (TOML) of the running session");
    app.add_option("--base-port", options.base_port, "first UDP port, instead of [network] base_port")
        ->check(CLI::Range(1024, 65536 - static_cast<int>(Port::kCount)))
        ->type_name("PORT");
    app.add_option("--screenshot", options.screenshot, "save the last picture to this PNG file")
        ->type_name("FILE");
    app.add_option("--seconds", options.seconds, "end after this time, s; 0: run until the window is closed")
        ->check(CLI::Range(0.0, 1e6));
    app.add_option("--width", options.width, "width of the window, pixels at scale 1")
        ->check(CLI::Range(200, 8000));
    app.add_option("--height", options.height, "height of the window, pixels at scale 1")
        ->check(CLI::Range(150, 8000));
    app.add_option("--scale", options.scale, "scale of text and lines, instead of the monitor's")
        ->check(CLI::Range(0.5, 8.0));
    app.add_flag("--frame-times", options.frame_times,
                 "print drawing times of the view and of an empty window as JSON at the end");
    app.add_flag("--die-with-parent", options.launcher, kDieWithParentHelp);
    app.set_version_flag("--version", std::string(kVersion));
    app.footer(
        "Example:\n  thimble-visual --role experimenter deploy/sessions/delay50.toml\n\n"
        "Exit codes: 0 ok, 1 the screen was lost, 2 usage, configuration or no screen, 3 network, 5 data.");
}

}  // namespace

bool asks_for_experimenter_view(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word == "--role=experimenter") return true;
        if (word == "--role" && i + 1 < argc && std::string_view(argv[i + 1]) == "experimenter") return true;
    }
    return false;
}

int run_experimenter_view(int argc, char** argv) {
    return guarded_main("thimble-visual", [&] {
        CLI::App app(
            "Shows the experimenter what the subject does not see: fixture, needle inside the tissue, "
            "forces, delays, energy. It also sends the session requests: delay, modality, pause, repeat, "
            "exclude. '?' lists the keys; Backspace is the emergency stop.",
            "thimble-visual");
        ViewOptions options;
        add_options(app, options);
        if (const auto exit_code = parse_command_line(app, argc, argv)) return *exit_code;
        if (options.launcher != 0) stop_with_parent(options.launcher);
        return ExperimenterView(options).run();
    });
}

}  // namespace thimble
