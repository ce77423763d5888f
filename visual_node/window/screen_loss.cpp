#include "visual_node/window/screen_loss.hpp"

#include <atomic>
#include <dlfcn.h>

namespace thimble {
namespace {

std::atomic<bool> lost{false};

void remember_loss(void* /*display*/, void* /*data*/) { lost = true; }

template <class Function>
Function find(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
}

}  // namespace

// Looked up by name: GLFW for Wayland has no X11 display, and Xlib before 1.7 no such handler (it then ends the program).
void survive_screen_loss() {
    using Handler = void (*)(void* display, void* data);
    const auto display_of_glfw = find<void* (*)()>("glfwGetX11Display");
    const auto set_handler =
        find<void (*)(void* display, Handler handler, void* data)>("XSetIOErrorExitHandler");
    if (display_of_glfw == nullptr || set_handler == nullptr) return;
    if (void* const display = display_of_glfw(); display != nullptr)
        set_handler(display, remember_loss, nullptr);
}

bool screen_lost() { return lost; }

}  // namespace thimble
