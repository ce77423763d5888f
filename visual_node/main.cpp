// thimble-visual: what the operator may see.
#include <csignal>

#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "common/runtime/node_report.hpp"
#include "visual_node/recording_display.hpp"
#include "visual_node/visual_process.hpp"
#ifdef THIMBLE_GUI
#include "visual_node/views/experimenter_program.hpp"
#include "visual_node/views/player_overlay.hpp"
#include "visual_node/window/fonts.hpp"
#include "visual_node/window/visual_window.hpp"
#endif
#include "visual_node/instructions.hpp"

namespace {

using namespace thimble;

struct Choices {
    bool window = false, fullscreen = false;
    std::string view = "subject", screenshot;
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

// The overlay of a view. Its sockets are its own: the node's wake the node's thread.
std::unique_ptr<Overlay> make_overlay(const Choices& choices, const NetworkSettings& network,
                                      std::uint64_t instance) {
    if (choices.view != "player") return nullptr;
    return std::make_unique<PlayerOverlay>(instance, network);
}

class WindowVisual final : public NodeInstance {
  public:
    WindowVisual(const VisualSettings& settings, const Instructions& instructions, const Choices& choices,
                 Sockets& sockets, std::uint64_t instance)
        : subject_points_(settings.pointer && choices.view != "player"),
          window_(settings,
                  {choices.view == "player", settings.pointer, settings.fullscreen, choices.screenshot,
                   make_overlay(choices, sockets.settings(), instance), instructions},
                  sockets.settings()),
          stale_(settings.stale),
          process_(instance, settings, sockets, window_.display(), window_.hand()) {}

    NodeProcess& process() override { return process_; }
    void describe(nlohmann::ordered_json& report) const override {
        describe_stale(report, stale_, process_.stale_record());
        window_.describe(report);
    }
    bool has_foreground() const override { return true; }
    void foreground(const std::function<bool()>& stopped) override {
        if (window_.run(stopped) != WindowEnd::kScreenLost || !subject_points_) return;
        // A subject without eyes and hand only waits for the trial's timeout: let the session know.
        static_cast<void>(std::raise(SIGTERM));
        throw Error(ExitCode::kRunFailed, "the subject's screen is gone, and with it the pointer");
    }

  private:
    bool subject_points_;
    VisualWindow window_;
    StalePolicy stale_;
    VisualProcess process_;
};

std::unique_ptr<NodeInstance> build_window(VisualSettings settings, const Instructions& instructions,
                                           const Choices& choices, Sockets& sockets, std::uint64_t instance) {
    check_drawable(instructions.text());
    // The screen has its own rate; a scene that waits for a second clock would only be older.
    if (!settings.refresh_given) settings.refresh_Hz = 1000;
    if (choices.view == "player") settings.fingertip = settings.pointer = true;
    settings.fullscreen = settings.fullscreen || choices.fullscreen;
    return std::make_unique<WindowVisual>(settings, instructions, choices, sockets, instance);
}

#else

std::unique_ptr<NodeInstance> build_window(const VisualSettings&, const Instructions&, const Choices&,
                                           Sockets&, std::uint64_t) {
    throw Error(ExitCode::kUsage,
                "this build has no windows (THIMBLE_GUI is off): use [visual] display = \"recording\", "
                "without --window "
                "and --view");
}

#endif

std::unique_ptr<NodeInstance> build(const Choices& choices, const ConfigFile& file, Sockets& sockets,
                                    std::uint64_t instance) {
    const VisualSettings settings = read_visual_settings(file);
    const Instructions instructions = read_instructions(file.table("instructions"));
    if (settings.window || choices.window || choices.view != "subject") {
        return build_window(settings, instructions, choices, sockets, instance);
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
        "Never shows the fixture or the inserted part of the needle. Without a window, the display records "
        "frames.";
    program.example = "thimble-visual --config deploy/sessions/delay50.toml --window";
    program.tables = {"network", "runtime", "visual", "instructions"};
    program.flags = {{"--window", "open a window, whatever [visual].display says", &choices.window},
                     {"--fullscreen", "the window fills the screen", &choices.fullscreen}};
    program.texts = {
        {"--view",
         "subject: the scene alone, and the pointer as the hand where [handle] device says so; player: the "
         "pointer and a panel (implies --window)",
         &choices.view,
         {"subject", "player"}},
        {"--screenshot", "save the last picture to this PNG file", &choices.screenshot}};
    program.build = [&choices](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        return build(choices, file, sockets, instance);
    };
    return run_node_program(program, argc, argv);
}
