// thimble-visual: what the operator may see.
#include <utility>

#include <CLI/CLI.hpp>

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
    std::string view = "subject", scene = "cutaway", screenshot;
};

// Frames go nowhere but into memory: no screen is needed.
class RecordingVisual final : public NodeInstance {
  public:
    RecordingVisual(const VisualSettings& settings, Sockets& sockets, std::uint64_t instance)
        : display_(settings.pipeline),
          stale_(settings.stale),
          process_(instance, settings, sockets, display_) {}

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
    const bool player = choices.view == "player";
    // The screen has its own rate; a scene that waits for a second clock would only be older.
    if (!settings.refresh_given) settings.refresh_Hz = 1000;
    if (player) settings.fingertip = settings.pointer = true;
    settings.cut_away = player && choices.scene == "cutaway";
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
                "this build has no windows (THIMBLE_GUI is off): use [visual] display = \"recording\", "
                "without --window and --view");
}

#endif

std::unique_ptr<NodeInstance> build(const Choices& choices, const ConfigFile& file, Sockets& sockets,
                                    std::uint64_t instance) {
    const VisualSettings settings = read_visual_settings(file);
    PageSet pages = read_pages(file);
    if (settings.window || choices.window || choices.view != "subject") {
        return build_window(settings, std::move(pages), choices, sockets, instance);
    }
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
        "Shows the needle outside the tissue and the surface, in VF the bar of the resisting force, and "
        "gives the beep. "
        "Never shows a subject the fixture or the inserted part of the needle. Without a window, the display "
        "records "
        "frames.";
    program.example = "thimble-visual deploy/sessions/delay50.toml --window";
    program.tables = {"network", "runtime", "visual", "instructions"};
    program.add_options = [&choices](CLI::App& app) {
        app.add_flag("--window", choices.window, "open a window, whatever [visual].display says");
        app.add_flag("--fullscreen", choices.fullscreen, "the window fills the screen");
        app.add_option("--view", choices.view,
                       "subject: the scene alone, and the pointer as the hand where [handle] device says so; "
                       "player: the pointer and a panel (implies --window)")
            ->check(CLI::IsMember({"subject", "player"}));
        app.add_option(
               "--scene", choices.scene,
               "of --view player: cutaway, with the inserted needle and the fixture, or subject, without")
            ->check(CLI::IsMember({"cutaway", "subject"}));
        app.add_option("--screenshot", choices.screenshot, "save the last picture to this PNG file");
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
