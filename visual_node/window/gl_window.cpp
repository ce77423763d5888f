// epoxy must come before GLFW, which would bring OpenGL headers of its own.
#include <epoxy/gl.h>
// clang-format off
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
// clang-format on

#include <algorithm>
#include <atomic>
#include <cmath>
#include <dlfcn.h>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/runtime/wall_clock.hpp"
#include "visual_node/window/gl_window.hpp"

namespace thimble {
namespace {

// GLFW's own words about its last failure.
std::string glfw_reason() {
    const char* words = nullptr;
    glfwGetError(&words);
    return words == nullptr ? "no reason is known" : words;
}

void start_glfw() {
    if (environment_text("DISPLAY").empty() && environment_text("WAYLAND_DISPLAY").empty()) {
        throw Error(ExitCode::kUsage,
                    "no screen: DISPLAY and WAYLAND_DISPLAY are not set; start this in a desktop session, "
                    "with 'ssh -X', or under 'xvfb-run -a', or set [visual] display = \"recording\"");
    }
    if (glfwInit() == GLFW_TRUE) return;
    throw Error(ExitCode::kUsage,
                "no screen: {}; does the display in DISPLAY exist, and may this user draw on it? [visual] "
                "display = \"recording\" needs no screen",
                glfw_reason());
}

void set_hints(const WindowSettings& settings) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CLIENT_API, settings.embedded ? GLFW_OPENGL_ES_API : GLFW_OPENGL_API);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, settings.embedded ? 0 : 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE,
                   settings.embedded ? GLFW_OPENGL_ANY_PROFILE : GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, settings.embedded ? GLFW_FALSE : GLFW_TRUE);
    glfwWindowHint(GLFW_VISIBLE, settings.visible ? GLFW_TRUE : GLFW_FALSE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, settings.content_scale > 0 ? GLFW_FALSE : GLFW_TRUE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);  // a subject's screen stays when another gets the keyboard
}

GLFWwindow* open_window(const WindowSettings& settings) {
    set_hints(settings);
    const double scale = settings.content_scale > 0 ? settings.content_scale : 1;
    int width = static_cast<int>(std::lround(settings.width * scale));
    int height = static_cast<int>(std::lround(settings.height * scale));
    GLFWmonitor* const monitor = settings.fullscreen ? glfwGetPrimaryMonitor() : nullptr;
    if (const GLFWvidmode* mode = monitor == nullptr ? nullptr : glfwGetVideoMode(monitor); mode != nullptr) {
        width = mode->width;
        height = mode->height;
    }
    GLFWwindow* const window = glfwCreateWindow(width, height, settings.title.c_str(), monitor, nullptr);
    if (window != nullptr) return window;
    throw Error(ExitCode::kUsage,
                "no window with OpenGL 3.3: {}; install a driver (libgl1-mesa-dri in Debian draws in "
                "software) or set [visual] display = \"recording\"",
                glfw_reason());
}

std::atomic<bool> screen_lost{false};

// Xlib asks the first what to say and the second how to end.
int say_nothing(void* /*display*/) { return 0; }
void remember_loss(void* /*display*/, void* /*data*/) { screen_lost = true; }

template <class Function>
Function find(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
}

// Xlib ends the program at the end of the X server, by default. Here it only remembers. Nothing to do under Wayland.
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

}  // namespace

struct GlWindow::Impl {
    GLFWwindow* window = nullptr;
    std::vector<WindowEvent> events;
    int width = 0, height = 0;
    double content_scale = 1;
    int scale_from_width = 0, scale_from_height = 0;
    bool fixed_scale = false, grabbed = false;
    double pointer_x = 0, pointer_y = 0;
    double pixels_per_unit = 1;  // of window coordinates

    static Impl& of(GLFWwindow* window) { return *static_cast<Impl*>(glfwGetWindowUserPointer(window)); }

    WindowEvent* add(WindowEvent::Kind kind) {
        if (events.size() == kMaxEvents) return nullptr;
        WindowEvent& event = events.emplace_back();
        event.kind = kind;
        event.time = wall_now();
        event.x = pointer_x;
        event.y = pointer_y;
        return &event;
    }

    void moved(double x, double y) {
        x *= pixels_per_unit;
        y *= pixels_per_unit;
        if (WindowEvent* const event = add(WindowEvent::Kind::kMotion); event != nullptr) {
            event->x = grabbed ? x - pointer_x : x;
            event->y = grabbed ? y - pointer_y : y;
        }
        pointer_x = x;
        pointer_y = y;
    }

    void measure() {
        int units = 0;
        glfwGetFramebufferSize(window, &width, &height);
        glfwGetWindowSize(window, &units, nullptr);
        pixels_per_unit = units > 0 ? static_cast<double>(width) / units : 1;
        if (fixed_scale) return;
        if (scale_from_width > 0 && scale_from_height > 0) {
            content_scale = scale_of_size();
            return;
        }
        float scale_x = 1, scale_y = 1;
        glfwGetWindowContentScale(window, &scale_x, &scale_y);
        content_scale = std::max(1.0, static_cast<double>(scale_y));
    }

    // In steps, because each one makes the fonts anew.
    double scale_of_size() const {
        const double fit = std::min(static_cast<double>(width) / scale_from_width,
                                    static_cast<double>(height) / scale_from_height);
        return std::clamp(std::floor(20 * fit) / 20, 0.5, 8.0);
    }

    void listen();
};

void GlWindow::Impl::listen() {
    glfwSetWindowUserPointer(window, this);
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int) {
        if (WindowEvent* const event = of(w).add(WindowEvent::Kind::kKey); event != nullptr) {
            event->key = key;
            event->pressed = action != GLFW_RELEASE;
            event->repeated = action == GLFW_REPEAT;
        }
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) { of(w).moved(x, y); });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int, int action, int) {
        if (WindowEvent* const event = of(w).add(WindowEvent::Kind::kButton); event != nullptr) {
            event->pressed = action == GLFW_PRESS;
        }
    });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int wide, int high) {
        of(w).measure();
        if (WindowEvent* const event = of(w).add(WindowEvent::Kind::kResize); event != nullptr) {
            event->x = wide;
            event->y = high;
        }
    });
    glfwSetWindowContentScaleCallback(window, [](GLFWwindow* w, float, float) { of(w).measure(); });
    glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) {
        WindowEvent* const event = of(w).add(WindowEvent::Kind::kFocus);
        if (event != nullptr) event->pressed = focused == GLFW_TRUE;
    });
}

GlWindow::GlWindow(const WindowSettings& settings) : impl_(std::make_unique<Impl>()) {
    start_glfw();
    Impl& impl = *impl_;
    impl.events.reserve(kMaxEvents);
    impl.scale_from_width = settings.scale_from_width;
    impl.scale_from_height = settings.scale_from_height;
    impl.fixed_scale = settings.content_scale > 0;
    impl.content_scale = impl.fixed_scale ? settings.content_scale : 1;
    try {
        impl.window = open_window(settings);
    } catch (...) {
        glfwTerminate();
        throw;
    }
    survive_screen_loss();
    impl.listen();
    impl.measure();
    glfwMakeContextCurrent(impl.window);
    glfwSwapInterval(settings.vsync ? 1 : 0);
}

GlWindow::~GlWindow() {
    if (lost()) return;  // to say goodbye needs a screen as well
    glfwDestroyWindow(impl_->window);
    glfwTerminate();
}

std::span<const WindowEvent> GlWindow::poll_events() {
    impl_->events.clear();
    if (!lost()) glfwPollEvents();
    return impl_->events;
}

std::span<const WindowEvent> GlWindow::wait_events(Duration longest) {
    impl_->events.clear();
    if (lost()) {
        wall_sleep(longest);
    } else if (longest > Duration::zero()) {
        glfwWaitEventsTimeout(to_seconds(longest));
    } else {
        glfwPollEvents();
    }
    return impl_->events;
}

void GlWindow::begin_frame(const Rgb& ground) {
    if (lost()) return;
    glfwMakeContextCurrent(impl_->window);
    glViewport(0, 0, impl_->width, impl_->height);
    const auto channel = [&](std::size_t i) { return static_cast<float>(ground[i]) / 255; };
    glClearColor(channel(0), channel(1), channel(2), 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void GlWindow::end_frame() {
    if (!lost()) glfwSwapBuffers(impl_->window);
}

bool GlWindow::should_close() const { return lost() || glfwWindowShouldClose(impl_->window) == GLFW_TRUE; }
void GlWindow::ask_to_close() {
    if (!lost()) glfwSetWindowShouldClose(impl_->window, GLFW_TRUE);
}
void GlWindow::stay_open() {
    if (!lost()) glfwSetWindowShouldClose(impl_->window, GLFW_FALSE);
}
bool GlWindow::lost() const { return screen_lost; }
int GlWindow::width() const { return impl_->width; }
int GlWindow::height() const { return impl_->height; }
double GlWindow::content_scale() const { return impl_->content_scale; }

double GlWindow::refresh_Hz() const {
    GLFWmonitor* const monitor = lost() ? nullptr : glfwGetPrimaryMonitor();
    const GLFWvidmode* const mode = monitor == nullptr ? nullptr : glfwGetVideoMode(monitor);
    return mode == nullptr || mode->refreshRate <= 0 ? 60 : mode->refreshRate;
}

void GlWindow::grab_pointer(bool grabbed) {
    if (lost() || grabbed == impl_->grabbed) return;
    glfwSetInputMode(impl_->window, GLFW_CURSOR, grabbed ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    if (glfwRawMouseMotionSupported() == GLFW_TRUE) {
        glfwSetInputMode(impl_->window, GLFW_RAW_MOUSE_MOTION, grabbed ? GLFW_TRUE : GLFW_FALSE);
    }
    glfwGetCursorPos(impl_->window, &impl_->pointer_x, &impl_->pointer_y);
    impl_->pointer_x *= impl_->pixels_per_unit;
    impl_->pointer_y *= impl_->pixels_per_unit;
    impl_->grabbed = grabbed;
}

bool GlWindow::pointer_grabbed() const { return impl_->grabbed; }

Image GlWindow::read_pixels() const {
    Image image;
    if (lost()) return image;
    image.width = impl_->width;
    image.height = impl_->height;
    const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
    std::vector<std::uint8_t> upwards(4 * width * height);  // OpenGL ES need not give three bytes
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadBuffer(GL_BACK);
    glReadPixels(0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, upwards.data());
    image.rgb.resize(3 * width * height);
    auto to = image.rgb.begin();
    for (std::size_t y = height; y-- > 0;) {
        auto from = upwards.cbegin() + static_cast<std::ptrdiff_t>(4 * width * y);
        for (std::size_t x = 0; x < width; ++x, from += 4) to = std::copy_n(from, 3, to);
    }
    return image;
}

GLFWwindow* GlWindow::handle() const { return impl_->window; }

}  // namespace thimble
