#include "netem/link_reader.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "netem/stages/corrupt.hpp"

namespace thimble {

namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::seconds;

constexpr std::int64_t kMaxCapacity = 1'000'000;
constexpr std::int64_t kMaxBytes = 4'294'967'295;
constexpr Duration kLongestTime = hours{1000};
constexpr Duration kPacketPeriod =
    std::chrono::milliseconds{1};  // every flow of a session but the heartbeats
constexpr Duration kShortestSlot = microseconds{10};
constexpr double kMostCorrelation = 0.999999;

std::size_t count(const ConfigTable& table, std::string_view key, std::size_t fallback, std::int64_t low,
                  std::int64_t high) {
    return static_cast<std::size_t>(table.integer(key, static_cast<std::int64_t>(fallback), low, high));
}

// The value that the source of `key` gives for the text there; none if the key is absent.
template <typename Source, typename Use>
void read_source(const ConfigTable& table, std::string_view key, const Source& source, const Use& use) {
    const std::string text = table.text(key, "");
    if (text.empty()) return;
    if (!source) table.fail(key, "is not understood here: this program reads no such files");
    use(text);
}

void check_jitter(const ConfigTable& table, const LinkSettings& link) {
    const JitterSettings& jitter = link.jitter;
    const bool spread = jitter.spread > Duration::zero();
    if (jitter.shape == JitterShape::kNone) {
        if (spread) {
            table.fail("jitter_spread_s",
                       "a spread needs a distribution: set jitter to \"uniform\", \"normal\" or another, or "
                       "remove it");
        }
        if (jitter.correlation > 0) table.fail("jitter_correlation", "needs a distribution: set jitter");
        return;
    }
    if (!spread) table.fail("jitter_spread_s", "must be above 0 when jitter is not \"none\"");
    if (jitter.shape == JitterShape::kTable && jitter.table == nullptr) {
        table.fail("jitter_table", "must name a file when jitter is \"table\"");
    }
    // A trace gives the mean; gamma's is delay_s, since its skewness depends on it.
    const bool traced = link.trace != nullptr && link.trace->layout().has_delay;
    if (traced && jitter.shape != JitterShape::kGamma) return;
    const double least = least_mean_in_spreads(jitter);
    if (least * static_cast<double>(jitter.spread.count()) <= static_cast<double>(link.delay.count())) return;
    if (jitter.shape == JitterShape::kGamma)
        table.fail("jitter_spread_s", "must not exceed ten times delay_s");
    table.fail("jitter_spread_s",
               fmt::format("must not exceed {:.3g} of delay_s: delays are cut at 0, so their mean would no "
                           "longer be delay_s (\"gamma\" is never cut)",
                           1 / least));
}

void read_jitter(const ConfigTable& table, const LinkSources& sources, LinkSettings& link) {
    JitterSettings& jitter = link.jitter;
    jitter.shape =
        static_cast<JitterShape>(table.choice("jitter", static_cast<std::size_t>(jitter.shape),
                                              {kJitterShapeNames.begin(), kJitterShapeNames.end()}));
    // Switched off, the rest of what was there before goes, too.
    if (table.has("jitter") && jitter.shape == JitterShape::kNone) jitter = {};
    jitter.spread = table.seconds("jitter_spread_s", jitter.spread, Duration::zero(), seconds{60});
    jitter.correlation = table.number("jitter_correlation", jitter.correlation, 0, kMostCorrelation);
    read_source(table, "jitter_table", sources.jitter_table,
                [&](const std::string& file) { jitter.table = sources.jitter_table(file); });
    if (table.has("jitter_table") && jitter.shape != JitterShape::kTable) {
        table.fail("jitter_table", "is the shape of jitter = \"table\": set that, or remove it");
    }
}

void read_faults(const ConfigTable& table, LinkSettings& link) {
    link.duplicate = table.number("duplicate", link.duplicate, 0, 1);
    link.corrupt = table.number("corrupt", link.corrupt, 0, 1);
    link.corrupt_bits =
        static_cast<unsigned>(count(table, "corrupt_bits", link.corrupt_bits, 1, Corrupt::kMostBits));
    link.reorder = table.number("reorder", link.reorder, 0, 1);
    link.reorder_gap = static_cast<unsigned>(count(table, "reorder_gap", link.reorder_gap, 1, 1'000'000));
    link.in_order = table.boolean("in_order", link.in_order);
    if (link.reorder > 0 && link.in_order) {
        table.fail("reorder", "contradicts in_order, which is true unless set: set in_order = false");
    }
}

void read_rate(const ConfigTable& table, RateSettings& rate) {
    rate.bits_per_s = table.number("rate_bits_per_s", rate.bits_per_s, 0, 1e12);
    if (rate.bits_per_s > 0 && rate.bits_per_s < 1) table.fail("rate_bits_per_s", "must be 0 or at least 1");
    rate.overhead_bytes = count(table, "rate_overhead_bytes", rate.overhead_bytes, 0, 65535);
    rate.queue_packets = count(table, "rate_queue_packets", rate.queue_packets, 0, kMaxCapacity);
    rate.queue_bytes = count(table, "rate_queue_bytes", rate.queue_bytes, 0, kMaxBytes);
    rate.drop =
        static_cast<Drop>(table.choice("rate_drop", static_cast<std::size_t>(rate.drop), {"tail", "head"}));
}

void read_slots(const ConfigTable& table, SlotSettings& slot) {
    slot.least = table.seconds("slot_least_s", slot.least, Duration::zero(), seconds{60});
    const Duration most = table.has("slot_least_s") ? slot.least : slot.most;
    slot.most = table.seconds("slot_most_s", most, Duration::zero(), seconds{60});
    slot.packets = count(table, "slot_packets", slot.packets, 0, kMaxCapacity);
    slot.bytes = count(table, "slot_bytes", slot.bytes, 0, kMaxBytes);
    if (slot.most < slot.least) table.fail("slot_most_s", "must not be below slot_least_s");
    if (slot.most > Duration::zero() && slot.most < kShortestSlot) {
        table.fail("slot_most_s", "must be 0 (no slots) or at least 0.00001");
    }
    if (slot.most == Duration::zero() && (slot.packets > 0 || slot.bytes > 0)) {
        table.fail("slot_most_s", "must be above 0 for slots to have limits");
    }
}

void read_outages(const ConfigTable& table, LinkSettings& link) {
    if (table.has("outage")) link.outages.clear();
    for (const ConfigTable& entry : table.tables("outage")) {
        Outage outage;
        outage.start = entry.seconds("start_s", {}, Duration::zero(), kLongestTime);
        outage.length = entry.seconds("length_s", {}, Duration::zero(), kLongestTime);
        outage.every = entry.seconds("every_s", {}, Duration::zero(), kLongestTime);
        if (outage.length == Duration::zero()) entry.fail("length_s", "must be above 0");
        if (outage.every > Duration::zero() && outage.every <= outage.length) {
            entry.fail("every_s", "must be longer than length_s, or 0 for once");
        }
        link.outages.push_back(outage);
    }
}

void read_traces(const ConfigTable& table, const LinkSources& sources, LinkSettings& link) {
    TraceRequest request;
    request.by_given = table.has("trace_by");
    request.by = static_cast<TraceBy>(table.choice("trace_by", 1, {"packet", "time"}));
    request.between = static_cast<TraceBetween>(table.choice("trace_between", 0, {"hold", "linear"}));
    request.end = static_cast<TraceEnd>(table.choice("trace_end", 0, {"wrap", "hold"}));
    read_source(table, "trace", sources.trace, [&](const std::string& file) {
        request.file = file;
        link.trace = sources.trace(request);
    });
    for (const char* key : {"trace_by", "trace_between", "trace_end"}) {
        if (table.has(key) && !table.has("trace"))
            table.fail(key, "says how a trace is read: name one, or remove it");
    }
    read_source(table, "deliveries", sources.deliveries,
                [&](const std::string& file) { link.deliveries = sources.deliveries(file); });
}

void check_senders(const ConfigTable& table, const LinkSettings& link) {
    const bool traced = link.trace != nullptr && link.trace->layout().has_rate;
    if (link.deliveries != nullptr && (link.rate.bits_per_s > 0 || traced)) {
        table.fail("deliveries", "say when the link sends, and so does a rate: remove one");
    }
    if (link.deliveries != nullptr && link.slot.most > Duration::zero()) {
        table.fail("deliveries", "say when the link sends, and so do slots: remove one");
    }
    const bool waits =
        link.rate.bits_per_s > 0 || traced || link.deliveries != nullptr || link.slot.most > Duration::zero();
    if (!waits && (link.rate.queue_packets > 0 || link.rate.queue_bytes > 0)) {
        const char* key = link.rate.queue_packets > 0 ? "rate_queue_packets" : "rate_queue_bytes";
        table.fail(key, "without a rate, slots or deliveries nothing ever waits: set one, or remove it");
    }
}

std::size_t read_capacity(const ConfigTable& table, const LinkSettings& link) {
    LinkSettings narrow = link;
    narrow.jitter = {};
    const Duration longest = nearly_longest_delay(narrow) + link.jitter.spread;
    const std::int64_t needed = longest / kPacketPeriod + 1;
    const std::int64_t enough = std::max(static_cast<std::int64_t>(link.capacity), 2 * needed);
    const std::int64_t capacity = table.integer("capacity", std::min(enough, kMaxCapacity), 1, kMaxCapacity);
    if (capacity < needed) {
        table.fail("capacity", "a link with this delay holds " + std::to_string(needed) +
                                   " packets of a 1 kHz flow: allow at least that many, or remove the key");
    }
    return static_cast<std::size_t>(capacity);
}

}  // namespace

LinkSettings read_link_settings(const ConfigTable& table, const LinkSettings& base,
                                const LinkSources& sources) {
    LinkSettings link = base;
    read_source(table, "profile", sources.profile,
                [&](const std::string& name) { link = sources.profile(name); });
    link.delay = table.seconds("delay_s", link.delay, Duration::zero(), seconds{60});
    read_jitter(table, sources, link);
    link.loss = read_loss(table, link.loss);
    read_faults(table, link);
    read_rate(table, link.rate);
    read_slots(table, link.slot);
    read_outages(table, link);
    read_traces(table, sources, link);
    check_jitter(table, link);
    check_senders(table, link);
    link.capacity = read_capacity(table, link);
    return link;
}

Timeline read_timeline(const ConfigTable& table, const LinkSettings& base, const LinkSources& sources) {
    Timeline timeline;
    LinkSettings settings = base;
    Duration last{};
    for (const ConfigTable& entry : table.tables("timeline")) {
        if (!entry.has("at_s")) entry.fail("at_s", "is needed: when do these settings begin to hold?");
        const Duration at = entry.seconds("at_s", {}, Duration::zero(), kLongestTime);
        if (at <= last) entry.fail("at_s", "must be above 0 and rise from one entry to the next");
        settings = read_link_settings(entry, settings, sources);
        timeline.push_back({at, settings});
        last = at;
    }
    return timeline;
}

namespace {

// In bursts of `burst` packets on average; keys for what to say if that cannot be.
LossSettings in_bursts(const ConfigTable& table, double share, double burst, std::string_view share_key) {
    const double most = burst / (1 + burst);
    if (share > most) {
        table.fail(share_key,
                   fmt::format("is {}, but with bursts of {} must not exceed {:.4g}: between two of them at "
                               "least one packet is received",
                               share, burst, most));
    }
    LossSettings loss = LossSettings::gilbert(share, burst);
    loss.good_to_bad = std::min(loss.good_to_bad, 1.0);  // rounding
    return loss;
}

LossSettings read_chain(const ConfigTable& table) {
    LossSettings loss;
    loss.shape = LossShape::kGilbertElliott;
    loss.good_to_bad = table.number("good_to_bad", 0, 0, 1);
    loss.bad_to_good = table.number("bad_to_good", 1, 0, 1);
    return loss;
}

LossSettings read_gilbert(const ConfigTable& table) {
    if (table.has("share") || table.has("mean_burst")) {
        return in_bursts(table, table.number("share", 0, 0, 1),
                         table.number("mean_burst", 1, 1, kLongestBurst), "share");
    }
    return read_chain(table);
}

LossSettings read_gilbert_elliott(const ConfigTable& table) {
    LossSettings loss = read_chain(table);
    loss.loss_in_good = table.number("loss_in_good", 0, 0, 1);
    loss.loss_in_bad = table.number("loss_in_bad", 1, 0, 1);
    return loss;
}

LossSettings read_four_state(const ConfigTable& table) {
    LossSettings loss;
    loss.shape = LossShape::kFourState;
    loss.p13 = table.number("p13", 0, 0, 1);
    loss.p31 = table.number("p31", 1, 0, 1);
    loss.p32 = table.number("p32", 0, 0, 1);
    loss.p23 = table.number("p23", 0, 0, 1);
    loss.p14 = table.number("p14", 0, 0, 1);
    if (loss.p13 + loss.p14 > 1) table.fail("p14", "p13 and p14 leave state 1: together at most 1");
    if (loss.p31 + loss.p32 > 1) table.fail("p32", "p31 and p32 leave state 3: together at most 1");
    if (loss.p13 > 0 && loss.p31 == 0) table.fail("p31", "must be above 0 if p13 is: a burst has to end");
    if (loss.p32 > 0 && loss.p23 == 0) table.fail("p23", "must be above 0 if p32 is: a burst has to go on");
    return loss;
}

LossSettings read_model(const ConfigTable& table) {
    switch (table.choice("model", 0, {"independent", "gilbert", "gilbert-elliott", "four-state"})) {
        case 1:
            return read_gilbert(table);
        case 2:
            return read_gilbert_elliott(table);
        case 3:
            return read_four_state(table);
        default:
            return LossSettings::independent(table.number("share", 0, 0, 1));
    }
}

}  // namespace

LossSettings read_loss(const ConfigTable& link, const LossSettings& base) {
    if (link.is_table("loss")) {
        if (link.has("loss_burst"))
            link.fail("loss_burst", "goes with a number only: the table has mean_burst");
        LossSettings loss = read_model(link.table("loss"));
        if (stationary_loss(loss) == 0) loss = {};
        return loss;
    }
    if (!link.has("loss") && !link.has("loss_burst")) return base;
    const double share = link.number("loss", stationary_loss(base), 0, 1);
    const double burst = link.number("loss_burst", 0, 0, kLongestBurst);
    if (burst == 0 || share == 0) return LossSettings::independent(share);
    if (burst < 1) link.fail("loss_burst", "must be at least 1 packet, or 0 for independent losses");
    return in_bursts(link, share, burst, "loss");
}

}  // namespace thimble
