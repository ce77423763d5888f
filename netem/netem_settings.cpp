#include "netem/netem_settings.hpp"

#include "netem/link_reader.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {

void set_delay(LinkSettings& link, Timeline& timeline, Duration delay) {
    const Duration before = link.delay;
    link.delay = delay;
    for (LinkChange& change : timeline) {
        if (change.settings.delay != before) break;
        change.settings.delay = delay;
    }
}

NetemSettings read_netem_settings(const ConfigFile& file) {
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
