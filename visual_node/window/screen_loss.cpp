#include "visual_node/window/screen_loss.hpp"

#include <atomic>
#include <dlfcn.h>

namespace thimble {
namespace {

std::atomic<bool> lost{false};

// Xlib asks the first what to say and the second how to end.
int say_nothing(void* /*display*/) { return 0; }
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
    const auto set_words = find<void* (*)(int (*words)(void* display))>("XSetIOErrorHandler");
    if (display_of_glfw == nullptr || set_handler == nullptr || set_words == nullptr) return;
    void* const display = display_of_glfw();
    if (display == nullptr) return;
    set_words(say_nothing);
    set_handler(display, remember_loss, nullptr);
}

bool screen_lost() { return lost; }

}  // namespace thimble
