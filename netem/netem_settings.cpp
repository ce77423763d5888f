#include "netem/netem_settings.hpp"

namespace thimble {

void set_delay(LinkSettings& link, Timeline& timeline, Duration delay) {
    const Duration before = link.delay;
    link.delay = delay;
    for (LinkChange& change : timeline) {
        if (change.settings.delay != before) break;
        change.settings.delay = delay;
    }
}

NetemSettings read_netem_settings(const ConfigFile& file, const LinkSources& sources) {
    const ConfigTable netem = file.table("netem");
    const ConfigTable needle = netem.table("needle");
    const ConfigTable force = netem.table("force");
    NetemSettings settings;
    settings.needle = read_link_settings(needle, {}, sources);
    settings.needle_timeline = read_timeline(needle, settings.needle, sources);
    settings.force = read_link_settings(force, {}, sources);
    settings.force_timeline = read_timeline(force, settings.force, sources);
    return settings;
}

}  // namespace thimble
