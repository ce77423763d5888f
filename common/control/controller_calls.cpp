#include "common/control/controller_calls.hpp"

#include <csignal>
#include <cstring>
#include <iterator>
#include <unistd.h>

namespace thimble {
namespace {

// Only what a signal handler may call.
void say(const char* text) {
    if (write(STDERR_FILENO, text, std::strlen(text)) < 0) return;
}

void on_crash(int number) {
    const PluginPlace place = plugin_place();
    if (place.file != nullptr) {
        say("plug-in ");
        say(place.file);
        say(number == SIGXCPU ? ": did not come back from " : ": crashed in ");
        say(place.function);
        say("()\n");
    }
    std::signal(number, SIG_DFL);
    std::raise(number);
}

// One that another part of the program has set, a sanitizer for instance, stays.
void watch(int number) {
    struct sigaction now {};
    if (sigaction(number, nullptr, &now) != 0 || now.sa_handler != SIG_DFL) return;
    std::signal(number, on_crash);
}

}  // namespace

PluginPlace& plugin_place() {
    static thread_local PluginPlace place;
    return place;
}

void name_crashes_of_plugins() {
    static const bool once = [] {
        plugin_place();  // made before a handler needs it
        for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU}) watch(number);
        return true;
    }();
    static_cast<void>(once);
}

}  // namespace thimble
