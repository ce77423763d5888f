// One case of the swarm: a session and what fails in it, drawn from a number.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/network_settings.hpp"
#include "study/swarm/drawn_keys.hpp"

namespace thimble {

enum class FaultKind : std::uint8_t {
    kStall,      // of a program, as by SIGSTOP
    kDeath,      // of a program, for good
    kRestart,    // of a node, which was dead for a while
    kCut,        // these are of one wire, named by the port that it ends at
    kLoss,       //
    kDouble,     //
    kReorder,    //
    kLate,       //
    kClock,      // the sender's stamps are off by an hour
    kCorrupt,    // bits flip
    kStop,       // an emergency stop at a program
    kRelease,    // of all stops, by the session
    kButton,     // the stop button at the handle
    kBroken,     // the handle fails
    kNoNumber,   // the handle measures NaN
    kDelay,      // the force path gets another delay
    kProfile,    // both ways get another network
    kInterrupt,  // of the trial, as by Ctrl-C
    kCount,
};
inline constexpr std::array<std::string_view, static_cast<std::size_t>(FaultKind::kCount)> kFaultNames{
    "stall", "death", "restart", "cut",    "loss",   "double", "reorder", "late",    "clock",
    "flip",  "stop",  "release", "button", "broken", "nan",    "delay",   "network", "interrupt"};

// A wire's fault, which acts on one port.
constexpr bool of_wire(FaultKind kind) { return kind >= FaultKind::kCut && kind <= FaultKind::kCorrupt; }
// A program's fault, in which it does not run.
constexpr bool of_program(FaultKind kind) { return kind <= FaultKind::kRestart; }

// Of a session in virtual time.
inline constexpr std::array kSwarmPrograms{Role::kSession,   Role::kMaster, Role::kSlaveSim,
                                           Role::kCutaneous, Role::kVisual, Role::kNetem};

struct SwarmFault {
    FaultKind kind = FaultKind::kStall;
    Role role = Role::kMaster;       // of a program
    Port port = Port::kMasterForce;  // of a wire
    SessionTime at{};                // of the case's clock
    Duration length{};
    double value = 0;  // a share of datagrams, a delay in seconds, or which profile
};
// "cut, port 11, at 1.25 s for 0.3 s"
std::string fault_text(const SwarmFault& fault);

struct SwarmCase {
    std::uint64_t seed = 0;
    DrawnKeys keys;
    std::vector<SwarmFault> faults;
    std::uint32_t trials = 1;
    bool sealed = false;             // under a lab key
    std::filesystem::path plugin{};  // that its keys were drawn with; empty: none
};

// "thimble swarm --seed 17"
std::string repeat_command(const SwarmCase& one);

SwarmCase draw_case(const std::vector<KeyDeclaration>& keys, std::uint64_t seed);

// A session file, whose comments say what else belongs to the case.
std::string case_text(const SwarmCase& one);

}  // namespace thimble
