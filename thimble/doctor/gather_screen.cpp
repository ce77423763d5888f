#include "thimble/doctor/facts.hpp"

#ifdef THIMBLE_GUI
#include <epoxy/gl.h>
#include <fcntl.h>
#include <unistd.h>

#include "common/error.hpp"
#include "common/runtime/standard_streams.hpp"
#include "visual_node/window/beeper.hpp"
#include "visual_node/window/gl_window.hpp"
#endif

namespace thimble {

#ifdef THIMBLE_GUI

namespace {

// Nothing reaches stderr while it lives.
class QuietErrors {
  public:
    QuietErrors() : kept_(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0)) {
        stderr_written_within(std::chrono::milliseconds{500});  // those of before
        const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
        if (kept_ >= 0 && nowhere >= 0) dup2(nowhere, STDERR_FILENO);
        if (nowhere >= 0) close(nowhere);
    }
    ~QuietErrors() {
        if (kept_ < 0) return;
        dup2(kept_, STDERR_FILENO);
        close(kept_);
    }
    QuietErrors(const QuietErrors&) = delete;
    QuietErrors& operator=(const QuietErrors&) = delete;

  private:
    int kept_;
};

std::string gl_words(GLenum name) {
    const auto* words = reinterpret_cast<const char*>(glGetString(name));
    return words == nullptr ? "unknown" : words;
}

}  // namespace

ScreenFacts gather_screen() {
    ScreenFacts facts;
    try {
        WindowSettings settings;
        settings.visible = false;
        GlWindow window(settings);
        window.begin_frame(kBlack);
        facts.renderer = gl_words(GL_RENDERER);
        facts.version = "OpenGL " + gl_words(GL_VERSION);
    } catch (const Error& error) {
        facts.problem = error.what();
    }
    return facts;
}

SoundFacts gather_sound() {
    if (!Beeper::built()) return {false, ""};
    const QuietErrors quiet;  // the sound libraries' own words, pages of them
    const Beeper beeper;
    return {true, beeper.can_sound() ? "" : beeper.notice()};
}

#else

ScreenFacts gather_screen() { return {false, "", "", ""}; }
SoundFacts gather_sound() { return {false, ""}; }

#endif

}  // namespace thimble
