// Calls of a plug-in's functions: how long they take, and whose fault it is if one throws or crashes.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <string>
#include <utility>

#include "common/control/control_settings.hpp"
#include "common/error.hpp"

namespace thimble {

// Of one end, since the program began.
struct ControllerTally {
    std::uint64_t samples = 0;
    std::uint64_t not_numbers = 0;   // forces, positions and packets that were replaced
    std::uint64_t late_samples = 0;  // in which its calls took longer than a sample period
    Duration longest_call{};         // zero without a clock
};

// This thread is inside this function of this plug-in; null: in none. A crash is then the plug-in's.
struct PluginPlace {
    static constexpr std::uint64_t kGivenUp = ~std::uint64_t{0};
    std::atomic<const char*> file = nullptr, function = nullptr;
    // Each call has another number; 0: in none. Another thread (runtime/plugin_watch.hpp) sets kGivenUp.
    std::atomic<std::uint64_t> call = 0;

    void enter(const char* of, const char* name) {
        file = of;
        function = name;
        call = ++calls_;
    }
    void leave() {
        if (call.exchange(0) == kGivenUp) wait_for_end();
        file = function = nullptr;
    }

  private:
    [[noreturn]] static void wait_for_end();
    std::uint64_t calls_ = 0;
};
PluginPlace& plugin_place();

// A crash inside a plug-in ends the program as any does, after a line that names plug-in and function. SIGXCPU asks for that line of
// one that does not come back.
void name_crashes_of_plugins();

class ControllerCalls {
  public:
    // An empty file: one of Thimble's own, which is called without ado.
    ControllerCalls(std::string file, ReadClock clock) : file_(std::move(file)), clock_(clock) {
        if (!file_.empty()) name_crashes_of_plugins();
    }
    const std::string& file() const { return file_; }

    // Throws Error (run failed) if the function throws.
    template <class Result, class... Takes, class... Gives>
    Result operator()(const char* name, Result (*function)(Takes...), Gives&&... gives) {
        if (file_.empty()) return function(std::forward<Gives>(gives)...);
        const Inside inside(*this, name);
        try {
            return function(std::forward<Gives>(gives)...);
        } catch (const std::exception& thrown) {
            throw Error(ExitCode::kRunFailed, "plug-in {}: {}() threw an exception: {}", file_, name,
                        thrown.what());
        } catch (...) {
            throw Error(ExitCode::kRunFailed, "plug-in {}: {}() threw an exception", file_, name);
        }
    }

    Duration longest() const { return longest_; }
    // Of the calls since the last time this was asked.
    Duration take_spent() { return std::exchange(spent_, Duration{}); }

  private:
    class Inside {
      public:
        Inside(ControllerCalls& calls, const char* name)
            : calls_(calls), began_(calls.clock_ == nullptr ? SessionTime{} : calls.clock_()) {
            plugin_place().enter(calls.file_.c_str(), name);
        }
        ~Inside() {
            plugin_place().leave();
            if (calls_.clock_ != nullptr) calls_.spend(calls_.clock_() - began_);
        }
        Inside(const Inside&) = delete;
        Inside& operator=(const Inside&) = delete;

      private:
        ControllerCalls& calls_;
        SessionTime began_;
    };
    void spend(Duration time) {
        spent_ += time;
        longest_ = std::max(longest_, time);
    }

    std::string file_;
    ReadClock clock_;
    Duration spent_{}, longest_{};
};

}  // namespace thimble
