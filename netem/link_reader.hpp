// Link settings as people write them, one table per direction. docs/network.md lists the keys and says what each does.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/config.hpp"
#include "netem/link_settings.hpp"
#include "netem/packet_trace.hpp"

namespace thimble {

struct TraceRequest {
    std::string file;
    bool by_given = false;  // false: as the file has it
    TraceBy by = TraceBy::kTime;
    TraceBetween between = TraceBetween::kHold;
    TraceEnd end = TraceEnd::kWrap;
};

// Functions that read the files and profiles that a link may name. The reader itself opens none. Without one of these the key
// that needs it is refused.
struct LinkSources {
    std::function<std::shared_ptr<const JitterTable>(const std::string& file)> jitter_table{};
    std::function<std::shared_ptr<const PacketTrace>(const TraceRequest& request)> trace{};
    std::function<std::shared_ptr<const DeliveryTrace>(const std::string& file)> deliveries{};
    std::function<LinkSettings(const std::string& name)> profile{};
};

// A key that is absent leaves what `base` (or the profile) says. Throws Error (usage) also for settings that contradict each other.
// Examples: a spread without jitter or the reverse, a spread so wide that cutting delays at 0 would move their mean, a capacity
// that the delay alone fills, reordering in order, two senders at once.
LinkSettings read_link_settings(const ConfigTable& table, const LinkSettings& base = {},
                                const LinkSources& sources = {});

// The key at_s of an entry of a timeline.
Duration read_at(const ConfigTable& entry);

// The [[timeline]] of a table whose other keys gave `base`: each entry begins with the settings before it.
Timeline read_timeline(const ConfigTable& table, const LinkSettings& base, const LinkSources& sources = {});

// Packets in the mean, that a file may ask for.
inline constexpr double kLongestBurst = 1e6;

// The key `loss` of a link: a number, with loss_burst beside it, or a table of its own. Where it is absent, `base`. Throws Error
// (usage).
LossSettings read_loss(const ConfigTable& link, const LossSettings& base);

}  // namespace thimble
