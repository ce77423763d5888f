// A shell or a pair from start to end: namespaces, programs, signals, link, log and control socket.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/runtime/runtime_settings.hpp"
#include "netem/relay/relay_settings.hpp"
#include "netem/shell/tun_device.hpp"

namespace thimble {

struct ShellSettings {
    std::vector<std::vector<std::string>> commands;  // one: a shell. Two: a pair
    LinkPair links;                                  // up: from the first program
    TimelinePair timelines;
    std::uint64_t seed = 1;
    bool precise = false;
    RuntimeSettings runtime;
    std::filesystem::path log, control;  // "": none
};

struct ShellResult {
    int exit_code = 0;              // of the program; of a pair the first that is not 0
    nlohmann::ordered_json report;  // relay_report.hpp, and "shell"
    std::string log_fault{};        // empty: the packet log has all
};

// Of the first and the second program of a pair.
TunAddress pair_address(std::size_t i);

// Throws Error: network, with what to switch on, usage for a program that is not there, data for the log.
ShellResult run_shell(const ShellSettings& settings);

}  // namespace thimble
