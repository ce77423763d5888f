#include "netem/netem_settings.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "netem/link_reader.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

// Where the session says the delay: the least of its delays, which the jitter has to fit.
LinkSettings force_of_session(const ConfigFile& file) {
    LinkSettings link;
    const ConfigTable session = file.table("session");
    std::vector<double> delays_s;
    if (session.has("delays_s")) session.read("delays_s", delays_s, 0, kLongestForceDelay_s, "");
    if (!delays_s.empty()) link.delay = from_seconds(*std::min_element(delays_s.begin(), delays_s.end()));
    make_room_for_delay(link);
    return link;
}

}  // namespace

void set_delay(LinkSettings& link, Timeline& timeline, Duration delay) {
    const Duration before = link.delay;
    set_delay(link, delay);
    for (LinkChange& change : timeline) {
        if (change.settings.delay != before) break;
        set_delay(change.settings, delay);
    }
}

NetemSettings read_netem_settings(const ConfigFile& file) {
    const ConfigTable netem = file.table("netem");
    // `link` has what holds without the table.
    const auto read = [&](std::string_view name, Way way, LinkSettings& link, Timeline& timeline) {
        const ConfigTable table = netem.table(name);
        const LinkSources sources =
            session_sources(file.folder(), way, [&file](std::string_view used) { file.uses(used); });
        link = read_link_settings(table, link, sources);
        timeline = read_timeline(table, link, sources);
    };
    NetemSettings settings;
    settings.force = force_of_session(file);
    read("needle", Way::kUp, settings.needle, settings.needle_timeline);
    read("force", Way::kDown, settings.force, settings.force_timeline);
    return settings;
}

}  // namespace thimble
