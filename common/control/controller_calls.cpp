#include "common/control/controller_calls.hpp"

#include <array>
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

std::array<struct sigaction, 65> handlers_before{};  // by signal

void on_crash(int number) {
    const PluginPlace& place = plugin_place();
    if (place.file != nullptr) {
        say("plug-in ");
        say(place.file);
        say(number == SIGXCPU ? ": did not return from " : ": crashed in ");
        say(place.function);
        say("()\n");
    }
    sigaction(number, &handlers_before.at(static_cast<std::size_t>(number)), nullptr);
    std::raise(number);
}

// The handler that was there, of a sanitizer for instance, has the signal next.
void watch(int number) {
    struct sigaction ours {};
    ours.sa_handler = on_crash;
    sigaction(number, &ours, &handlers_before.at(static_cast<std::size_t>(number)));
}

}  // namespace

// The program ends while it waits.
void PluginPlace::wait_for_end() {
    for (;;) pause();
}

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
