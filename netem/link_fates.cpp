#include "netem/link_fates.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {

LinkFates::LinkFates(const StreamKey& key, std::uint32_t direction)
    : loss_(key, direction),
      jitter_(link_key(key, direction, Purpose::kLinkDelay)),
      copy_jitter_(link_key(key, direction, Purpose::kLinkDuplicateDelay)),
      duplicate_(key, direction, Purpose::kLinkDuplicate),
      corrupt_(key, direction, Purpose::kLinkCorrupt),
      damage_(key, direction),
      reorder_(key, direction) {}

void LinkFates::configure(const LinkSettings& settings, const std::shared_ptr<const DelayShape>& shape) {
    settings_ = &settings;
    loss_.configure(settings.loss);
    jitter_.configure(shape, settings.jitter.correlation);
    copy_jitter_.configure(shape, 0);
    duplicate_.configure(settings.duplicate);
    corrupt_.configure(settings.corrupt);
    damage_.configure(settings.corrupt_bits);
    reorder_.configure(settings.reorder, settings.reorder_gap);
}

PacketFate LinkFates::decide(std::uint64_t packet, Duration time, bool may_mark) {
    PacketFate fate;
    const PacketTrace* trace = settings_->trace.get();
    const TraceRow row = trace == nullptr ? TraceRow{} : trace->of(packet, time);
    const bool has_jitter = settings_->jitter.shape != JitterShape::kNone;
    double deviate = 0;
    if (has_jitter && jitter_.correlated()) deviate = jitter_.deviate(packet);  // also of a lost packet
    fate.lost =
        trace != nullptr && trace->layout().has_loss ? loss_.lost(packet, row.loss) : loss_.lost(packet);
    fate.marked = fate.lost && may_mark;
    fate.lost = fate.lost && !may_mark;
    if (fate.lost) return fate;
    if (has_jitter && !jitter_.correlated()) deviate = jitter_.deviate(packet);
    const Duration mean = trace != nullptr && trace->layout().has_delay ? row.delay : settings_->delay;
    fate.skipped = reorder_.skips(packet);
    fate.corrupted = corrupt_.hits(packet);
    fate.duplicated = duplicate_.hits(packet);
    if (!fate.skipped) fate.delay = delayed(mean, deviate);
    if (fate.duplicated) fate.copy_delay = delayed(mean, has_jitter ? copy_jitter_.deviate(packet) : 0);
    return fate;
}

Duration LinkFates::delayed(Duration mean, double deviate) const {
    const double spread_ns = static_cast<double>(settings_->jitter.spread.count());
    return std::max(Duration::zero(), mean + Duration{std::llround(deviate * spread_ns)});
}

}  // namespace thimble
