// thimble-visual: what the operator may see.
#include <utility>

#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/node_report.hpp"
#include "visual_node/page_set.hpp"
#include "visual_node/recording_display.hpp"
#include "visual_node/visual_process.hpp"
#ifdef THIMBLE_GUI
#include "visual_node/views/experimenter_panels.hpp"
#include "visual_node/views/player_panel.hpp"
#include "visual_node/window/gui_layer.hpp"
#include "visual_node/window/visual_window.hpp"
#endif

namespace {

using namespace thimble;

struct Choices {
    bool window = false, fullscreen = false;
    std::string role = "subject", view = "cutaway", screenshot;
};

// Frames go nowhere but into memory: no screen is needed.
class RecordingVisual final : public NodeInstance {
  public:
    RecordingVisual(const VisualSettings& settings, Sockets& sockets, std::uint64_t instance)
        : display_(settings), stale_(settings.stale), process_(instance, settings, sockets, display_) {}

    NodeProcess& process() override { return process_; }
    void describe(nlohmann::ordered_json& report) const override {
        describe_stale(report, stale_, process_.stale_record());
    }

  private:
    RecordingDisplay display_;
    StalePolicy stale_;
    VisualProcess process_;
};

#ifdef THIMBLE_GUI

std::unique_ptr<NodeInstance> build_window(VisualSettings settings, PageSet pages, const Choices& choices,
                                           Sockets& sockets, std::uint64_t instance) {
    check_drawable(pages.text());
    const bool player = choices.role == "player";
    // The screen has its own rate; a scene that waits for a second clock would only be older.
    if (!settings.refresh_given) settings.refresh_Hz = 1000;
    if (player) settings.fingertip = settings.pointer = true;
    settings.cut_away = player && choices.view == "cutaway";
    settings.fullscreen = settings.fullscreen || choices.fullscreen;
    std::unique_ptr<Overlay> overlay;
    // Its sockets are its own: the node's wake the node's thread.
    if (player) overlay = std::make_unique<PlayerOverlay>(instance, sockets.settings());
    return open_visual_window(settings, {player, choices.screenshot, std::move(overlay), std::move(pages)},
                              sockets, instance);
}

#else

std::unique_ptr<NodeInstance> build_window(const VisualSettings&, PageSet, const Choices&, Sockets&,
                                           std::uint64_t) {
    throw Error(ExitCode::kUsage,
                "this build has no windows (THIMBLE_GUI is off): set [visual] display = \"recording\", and "
                "leave out --window and --role");
}

#endif

std::unique_ptr<NodeInstance> build(const Choices& choices, const ConfigFile& file, Sockets& sockets,
                                    std::uint64_t instance) {
    const VisualSettings settings = read_visual_settings(file);
    PageSet pages = read_pages(file);
    if (settings.window || choices.window || choices.role != "subject") {
        return build_window(settings, std::move(pages), choices, sockets, instance);
    }
    if (choices.fullscreen || !choices.screenshot.empty())
        throw Error(ExitCode::kUsage,
                    "--fullscreen and --screenshot need a window: add --window, or set [visual] display = "
                    "\"window\"");
    return std::make_unique<RecordingVisual>(settings, sockets, instance);
}

}  // namespace

int main(int argc, char** argv) {
#ifdef THIMBLE_GUI
    if (asks_for_experimenter_view(argc, argv)) return run_experimenter_view(argc, argv);
#endif
    Choices choices;
    NodeProgram program;
    program.name = "thimble-visual";
    program.description =
        "Shows the needle and the tissue surface in a window, the bar of the force in VF, and gives the "
        "beep. A subject never sees the fixture or the needle inside the tissue. Without a window, the "
        "program counts frames only.";
    program.example = "thimble-visual deploy/sessions/delay50.toml --window";
    program.tables = {"network", "runtime", "visual", "instructions"};
    program.add_options = [&choices](CLI::App& app) {
        add_flag(app, "--window", choices.window, "open a window, even if [visual] display is \"recording\"");
        add_flag(app, "--fullscreen", choices.fullscreen, "fill the screen with the window");
        add_word_option(app, "--role", choices.role, {"subject", "player"},
                        "person at the window. subject: the picture of the paper's subjects; player: the "
                        "mouse moves the needle, a panel sets force and delay; experimenter: a view of a "
                        "running session (see --role experimenter --help)");
        add_word_option(app, "--view", choices.view, {"cutaway", "subject"},
                        "with --role player. cutaway: also shows the needle inside the tissue and the "
                        "fixture; subject: the picture of the paper's subjects",
                        "--role");
        add_file_option(app, "--screenshot", choices.screenshot, "save the last picture to this PNG file");
    };
    program.read = [](const ConfigFile& file) {
        read_visual_settings(file);
        read_pages(file);
    };
    program.build = [&choices](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        return build(choices, file, sockets, instance);
    };
    return run_node_program(program, argc, argv);
}
