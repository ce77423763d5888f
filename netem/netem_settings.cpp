#include "netem/netem_settings.hpp"

#include "netem/link_reader.hpp"

namespace thimble {

NetemSettings read_netem_settings(const ConfigFile& file) {
    const ConfigTable netem = file.table("netem");
    NetemSettings settings;
    settings.needle = read_link_settings(netem.table("needle"));
    settings.force = read_link_settings(netem.table("force"));
    return settings;
}

}  // namespace thimble
