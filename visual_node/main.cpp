// thimble-visual: what the operator may see.
#include "common/runtime/node_program.hpp"
#include "visual_node/recording_display.hpp"
#include "visual_node/visual_process.hpp"
#ifdef THIMBLE_GUI
#include "visual_node/views/experimenter_program.hpp"
#endif

namespace {

using namespace thimble;

class Visual final : public NodeInstance {
  public:
    Visual(const ConfigFile& file, Sockets& sockets, std::uint64_t instance)
        : settings_(read_visual_settings(file.table("visual"))),
          display_(settings_.pipeline),
          process_(
              instance, settings_,
              {sockets.between(Port::kVisualControl, Port::kSessionVisual),
               sockets.inlet(Port::kVisualForce, Role::kNetem),
               sockets.inlet(Port::kVisualBeep, Role::kSlaveSim), sockets.outlet(Port::kMasterPerceptVisual)},
              display_) {}

    NodeProcess& process() override { return process_; }

  private:
    VisualSettings settings_;
    RecordingDisplay display_;
    VisualProcess process_;
};

}  // namespace

int main(int argc, char** argv) {
#ifdef THIMBLE_GUI
    if (asks_for_experimenter_view(argc, argv)) return run_experimenter_view(argc, argv);
#endif
    NodeProgram program;
    program.name = "thimble-visual";
    program.description =
        "Shows the needle outside the tissue and the surface, in VF the bar of the resisting force, and "
        "gives the beep. "
        "Never shows the fixture or the inserted part of the needle. The display records frames.";
    program.example = "thimble-visual --config deploy/sessions/delay50.toml";
    program.tables = {"network", "runtime", "visual"};
    program.build = [](const ConfigFile& file, Sockets& sockets, std::uint64_t instance) {
        return std::make_unique<Visual>(file, sockets, instance);
    };
    return run_node_program(program, argc, argv);
}
