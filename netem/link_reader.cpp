#include "netem/link_reader.hpp"

#include <algorithm>
#include <string>

namespace thimble {
namespace {

using std::chrono::seconds;

constexpr std::int64_t kMaxCapacity = 1'000'000;
constexpr Duration kPacketPeriod =
    std::chrono::milliseconds{1};  // every flow of a session but the heartbeats

void check_jitter(const ConfigTable& table, const LinkSettings& link) {
    const bool spread = link.jitter.spread > Duration::zero();
    if (link.jitter.shape == JitterShape::kNone && spread) {
        table.fail("jitter_spread_s",
                   "a spread needs a distribution: set jitter to \"uniform\" or \"normal\", or remove it");
    }
    if (link.jitter.shape != JitterShape::kNone && !spread) {
        table.fail("jitter_spread_s", "must be above 0 when jitter is not \"none\"");
    }
    if (link.jitter.shape == JitterShape::kUniform && link.jitter.spread > link.delay) {
        table.fail("jitter_spread_s",
                   "must not exceed delay_s: delays are cut at 0, so their mean would no longer be delay_s");
    }
    // At two standard deviations the cut moves the mean by less than 1 % of the spread.
    if (link.jitter.shape == JitterShape::kNormal && 2 * link.jitter.spread > link.delay) {
        table.fail("jitter_spread_s",
                   "must not exceed half of delay_s: delays are cut at 0, so their mean would no longer be "
                   "delay_s");
    }
}

std::size_t read_capacity(const ConfigTable& table, const LinkSettings& link) {
    const std::int64_t needed = (link.delay + link.jitter.spread) / kPacketPeriod + 1;
    const std::int64_t enough = std::max(static_cast<std::int64_t>(link.capacity), 2 * needed);
    const std::int64_t capacity = table.integer("capacity", enough, 1, kMaxCapacity);
    if (capacity < needed) {
        table.fail("capacity", "a link with this delay holds " + std::to_string(needed) +
                                   " packets of a 1 kHz flow: allow at least that many, or remove the key");
    }
    return static_cast<std::size_t>(capacity);
}

}  // namespace

LinkSettings read_link_settings(const ConfigTable& table) {
    LinkSettings link;
    link.delay = table.seconds("delay_s", link.delay, Duration::zero(), seconds{60});
    link.jitter.shape =
        static_cast<JitterShape>(table.choice("jitter", std::size_t{0}, {"none", "uniform", "normal"}));
    link.jitter.spread = table.seconds("jitter_spread_s", link.jitter.spread, Duration::zero(), seconds{60});
    link.loss = LossSettings::independent(table.number("loss", 0, 0, 1));
    link.in_order = table.boolean("in_order", link.in_order);
    check_jitter(table, link);
    link.capacity = read_capacity(table, link);
    return link;
}

}  // namespace thimble
