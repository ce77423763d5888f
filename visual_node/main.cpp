// thimble-visual: what the operator may see.
#include "common/error.hpp"
#include "common/runtime/node_program.hpp"
#include "visual_node/recording_display.hpp"
#include "visual_node/visual_process.hpp"
#ifdef THIMBLE_GUI
#include "visual_node/views/experimenter_program.hpp"
#include "visual_node/views/player_overlay.hpp"
#include "visual_node/window/visual_window.hpp"
#endif

namespace {

using namespace thimble;

struct Choices {
    bool window = false, fullscreen = false;
    std::string view = "subject", screenshot;
};

VisualProcess::Channels open_channels(Sockets& sockets, bool hand) {
    return {sockets.between(Port::kVisualControl, Port::kSessionVisual),
            sockets.inlet(Port::kVisualForce, Role::kNetem),
            sockets.inlet(Port::kVisualBeep, Role::kSlaveSim), sockets.outlet(Port::kMasterPerceptVisual),
            hand ? sockets.outlet(Port::kMasterHand) : nullptr};
}

// Frames go nowhere but into memory: no screen is needed.
class RecordingVisual final : public NodeInstance {
  public:
    RecordingVisual(const VisualSettings& settings, Sockets& sockets, std::uint64_t instance)
        : display_(settings.pipeline),
          process_(instance, settings, open_channels(sockets, false), display_) {}

    NodeProcess& process() override { return process_; }

  private:
    RecordingDisplay display_;
    VisualProcess process_;
};

#ifdef THIMBLE_GUI

// What a view puts over the scene. Its sockets are its own: the node's wake the node's thread.
std::unique_ptr<Overlay> make_overlay(const Choices& choices, const NetworkSettings& network,
                                      std::uint64_t instance) {
    if (choices.view != "player") return nullptr;
    return std::make_unique<PlayerOverlay>(instance, network);
}

class WindowVisual final : public NodeInstance {
  public:
    WindowVisual(const VisualSettings& settings, const Choices& choices, Sockets& sockets,
                 std::uint64_t instance)
        : window_(settings,
                  {choices.view == "player", choices.fullscreen, choices.screenshot,
                   make_overlay(choices, sockets.settings(), instance)},
                  sockets.settings()),
          process_(instance, settings, open_channels(sockets, window_.hand() != nullptr), window_.display(),
                   window_.hand()) {}

    NodeProcess& process() override { return process_; }
    void describe(nlohmann::ordered_json& report) const override { window_.describe(report); }
    bool has_foreground() const override { return true; }
    void foreground(const std::function<bool()>& stopped) override { window_.run(stopped); }

  private:
    VisualWindow window_;
    VisualProcess process_;
};

std::unique_ptr<NodeInstance> build_window(VisualSettings settings, const Choices& choices, Sockets& sockets,
                                           std::uint64_t instance) {
    // The screen has its own rate; a scene that waits for a second clock would only be older.
    if (!settings.refresh_given) settings.refresh_Hz = 1000;
    if (choices.view == "player") settings.fingertip = true;
    return std::make_unique<WindowVisual>(settings, choices, sockets, instance);
}

#else

std::unique_ptr<NodeInstance> build_window(const VisualSettings&, const Choices&, Sockets&, std::uint64_t) {
    throw Error(ExitCode::kUsage,
                "this build has no windows (THIMBLE_GUI is off): use [visual] display = \"recording\", "
                "without --window "
                "and --view");
}

#endif

std::unique_ptr<NodeInstance> build(const Choices& choices, const ConfigFile& file, Sockets& sockets,
                                    std::uint64_t instance) {
    const VisualSettings settings = read_visual_settings(file.table("visual"));
    if (settings.window || choices.window || choices.view != "subject") {
        return build_window(settings, choices, sockets, instance);
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
    program.tables = {"network", "runtime", "visual"};
    program.flags = {{"--window", "open a window, whatever [visual].display says", &choices.window},
                     {"--fullscreen", "the window fills the screen", &choices.fullscreen}};
    program.texts = {{"--view",
                      "subject: the scene alone; player: also the pointer as the hand (implies --window)",
                      &choices.view,
                      {"subject", "player"}},
                     {"--screenshot", "save the last picture to this PNG file", &choices.screenshot}};
    program.build = [&choices](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        return build(choices, file, sockets, instance);
    };
    return run_node_program(program, argc, argv);
}
