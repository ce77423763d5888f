// Tables [netem.needle] and [netem.force] of a session file: the two directions of the network, each with the
// keys of link_reader.hpp. The paper delays only the force path, from the virtual environment to handle,
// fingertips and bar.
#pragma once

#include "common/config.hpp"
#include "netem/link_reader.hpp"
#include "netem/link_settings.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {

struct NetemSettings {
    LinkSettings needle;  // master -> slave_sim
    LinkSettings force;   // slave_sim -> master, cutaneous_node and visual_node: three links alike
    Timeline needle_timeline{}, force_timeline{};
};

// Another mean delay, as a condition of an experiment or a command line has it: at the start, and in all that the
// timeline changes without changing the delay.
inline void set_delay(LinkSettings& link, Timeline& timeline, Duration delay) {
    const Duration before = link.delay;
    link.delay = delay;
    for (LinkChange& change : timeline) {
        if (change.settings.delay != before) break;
        change.settings.delay = delay;
    }
}

// Tell the links of one session apart in every random draw: part of each published seed.
enum Direction : std::uint32_t {
    kDirectionNeedle = 1,
    kDirectionForceMaster = 2,
    kDirectionForceCutaneous = 3,
    kDirectionForceVisual = 4,
};

// Traces, tables and profiles that are files are sought beside the session file. The needle's link is a profile's way up,
// the force's its way down.
inline NetemSettings read_netem_settings(const ConfigFile& file) {
    const ConfigTable netem = file.table("netem");
    const auto read = [&](std::string_view name, Way way, LinkSettings& link, Timeline& timeline) {
        const ConfigTable table = netem.table(name);
        const LinkSources sources =
            session_sources(file.folder(), way, [&file](std::string_view used) { file.uses(used); });
        link = read_link_settings(table, {}, sources);
        timeline = read_timeline(table, link, sources);
    };
    NetemSettings settings;
    read("needle", Way::kUp, settings.needle, settings.needle_timeline);
    read("force", Way::kDown, settings.force, settings.force_timeline);
    return settings;
}

}  // namespace thimble
