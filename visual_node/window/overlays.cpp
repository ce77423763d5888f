#include "visual_node/window/overlays.hpp"

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "visual_node/window/window_loop.hpp"

namespace thimble {

View find_view(const std::string& name) {
    if (name == "player") return View::kPlayer;
    return name == "experimenter" ? View::kExperimenter : View::kSubject;
}

std::unique_ptr<Overlay> make_overlay(View /*view*/, const ConfigFile& /*file*/,
                                      const NetworkSettings& /*network*/, std::uint64_t /*instance*/) {
    return nullptr;
}

void run_watching_view(View view, const ConfigFile& file, const NetworkSettings& network,
                       std::uint64_t instance, bool fullscreen) {
    const auto overlay = make_overlay(view, file, network, instance);
    if (overlay == nullptr) {
        throw Error(ExitCode::kUsage,
                    "--view experimenter: this build has no such view; use subject or player");
    }
    WindowSettings settings;
    settings.title = "Thimble: experiment";
    settings.width = 1280;
    settings.height = 800;
    settings.fullscreen = fullscreen;
    GlWindow window(settings);
    WindowLoop loop({&window, nullptr, nullptr, overlay.get(), nullptr}, Duration::zero(), false);
    loop.run([&] { return stop_requested().load() || overlay->done(); });
}

}  // namespace thimble
