// The parts of the Python module, and what they share. Each add_*() adds classes and functions to the module.
#pragma once

#include <atomic>
#include <future>
#include <map>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <string>
#include <vector>

#include "session/settings/system_settings.hpp"

namespace thimble {

void add_link(pybind11::module_& module);
void add_scene(pybind11::module_& module);
void add_session(pybind11::module_& module);
void add_study(pybind11::module_& module);
void add_board(pybind11::module_& module);
void add_logs(pybind11::module_& module);

// A dictionary as TOML for the reader of session files: dictionaries become tables, numpy's numbers numbers and its arrays lists.
// Throws Error (usage) for a value that TOML does not have.
std::string toml_text(const pybind11::dict& table);

// A session as Python gives it: None (the defaults), the path of a file, or a dictionary of its tables. `changes`: dotted keys with
// numbers. Throws Error as the reader of session files.
SystemSettings settings_from(const pybind11::object& session, const std::map<std::string, double>& changes);

using Numbers = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

inline pybind11::array_t<double> to_array(const std::vector<double>& values) {
    return pybind11::array_t<double>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

// As --jobs. Throws Error (usage).
void require_jobs(unsigned jobs);

// Throws KeyboardInterrupt where Ctrl-C was pressed. With the interpreter's lock.
inline void check_signals() {
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

// Runs long work in a thread of its own, while other threads of Python go on. Ctrl-C sets `stop`, and is thrown once the work has
// ended.
template <class Work>
auto interruptible(std::atomic<bool>& stop, Work work) {
    auto done = std::async(std::launch::async, work);
    const auto is_done = [&] {
        const pybind11::gil_scoped_release others_go_on;
        return done.wait_for(std::chrono::milliseconds{50}) == std::future_status::ready;
    };
    while (!is_done()) {
        if (PyErr_CheckSignals() == 0) continue;
        pybind11::error_already_set interrupt;
        stop = true;
        while (!is_done()) {
        }
        throw interrupt;
    }
    return done.get();
}

}  // namespace thimble
