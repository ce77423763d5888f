// Tables [netem.needle] and [netem.force] of a session file: the two directions of the network, each with the
// keys of link_reader.hpp. The paper delays only the force path, from the virtual environment to handle,
// fingertips and bar.
#pragma once

#include "common/config.hpp"
#include "netem/link_settings.hpp"

namespace thimble {

struct NetemSettings {
    LinkSettings needle;  // master -> slave_sim
    LinkSettings force;   // slave_sim -> master, cutaneous_node and visual_node: three links alike
    Timeline needle_timeline{}, force_timeline{};
};

// Another mean delay, as a condition of an experiment or a command line has it: at the start, and in all that the
// timeline changes without changing the delay. The links hold twice the packets that it keeps in flight at 1 kHz.
void set_delay(LinkSettings& link, Timeline& timeline, Duration delay);

// Tell the links of one session apart in every random draw: part of each published seed.
enum Direction : std::uint32_t {
    kDirectionNeedle = 1,
    kDirectionForceMaster = 2,
    kDirectionForceCutaneous = 3,
    kDirectionForceVisual = 4,
};

inline constexpr double kLongestForceDelay_s = 60;  // of [session] delays_s

// The force's delay is that of its table, of the profile there, or the least of [session] delays_s.
// Traces, tables and profiles that are files are sought beside the session file. The needle's link is a profile's way up,
// the force's its way down.
NetemSettings read_netem_settings(const ConfigFile& file);

}  // namespace thimble
