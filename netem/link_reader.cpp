#include "netem/link_reader.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "netem/stages/corrupt.hpp"

namespace thimble {

namespace {

constexpr std::int64_t kMaxPackets = static_cast<std::int64_t>(kMostCapacity);
constexpr std::int64_t kMaxBytes = 4'294'967'295;
constexpr double kLongestTime_s = 3.6e6;
constexpr Duration kShortestSlot = std::chrono::microseconds{10};
constexpr double kMostCorrelation = 0.999999;

// The text of a key that names something outside of the file; empty if the key is absent.
std::string read_name(const ConfigTable& table, std::string_view key, bool has_source,
                      std::string_view help) {
    std::string name;
    table.read(key, name, help);
    if (!name.empty() && !has_source) table.fail(key, "is not available here: the page reads no such files");
    return name;
}

void check_jitter(const ConfigTable& table, const LinkSettings& link) {
    const JitterSettings& jitter = link.jitter;
    const bool spread = jitter.spread > Duration::zero();
    if (jitter.shape == JitterShape::kNone) {
        if (spread) {
            table.fail("jitter_spread_s",
                       "a spread needs a distribution: set jitter to \"uniform\", \"normal\" or another, or "
                       "remove the spread");
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
               "must not exceed {:.3g} of delay_s: delays are cut at 0, so their mean would no longer be "
               "delay_s (\"gamma\" is never cut)",
               1 / least);
}

void read_jitter(const ConfigTable& table, const LinkSources& sources, LinkSettings& link) {
    JitterSettings& jitter = link.jitter;
    table.read("jitter", jitter.shape, kJitterShapeNames,
               "Distribution of the delay, drawn for each packet.");
    // If jitter is switched off, its other inherited values go, too.
    if (table.has("jitter") && jitter.shape == JitterShape::kNone) jitter = {};
    table.read("jitter_spread_s", jitter.spread, 0, 60,
               "Half width (uniform) or standard deviation; so small that cutting delays at 0 does not move "
               "the mean.");
    table.read("jitter_correlation", jitter.correlation, 0, kMostCorrelation,
               "Correlation of successive packets.");
    const std::string shape = read_name(table, "jitter_table", sources.jitter_table != nullptr,
                                        ".dist file of iproute2, the distribution of jitter = \"table\".");
    if (!shape.empty()) table.load("jitter_table", [&] { jitter.table = sources.jitter_table(shape); });
    if (table.has("jitter_table") && jitter.shape != JitterShape::kTable) {
        table.fail("jitter_table", "has an effect with jitter = \"table\" only: set that, or remove it");
    }
}

void read_faults(const ConfigTable& table, LinkSettings& link) {
    table.read("duplicate", link.duplicate, 0, 1, "Probability that a packet arrives twice.");
    table.read("corrupt", link.corrupt, 0, 1, "Probability that bits of a packet are flipped.");
    table.read("corrupt_bits", link.corrupt_bits, 1, Corrupt::kMostBits, "Number of bits that are flipped.");
    table.read("reorder", link.reorder, 0, 1,
               "Probability that a packet skips the delay; needs in_order = false.");
    table.read("reorder_gap", link.reorder_gap, 1, 1'000'000,
               "After a packet that skips, at least this number less one are delayed.");
    table.read("in_order", link.in_order, "false: packets may overtake each other.");
    table.read("ecn", link.ecn, "true: packets that support ECN are marked instead of lost.");
    if (link.reorder > 0 && link.in_order) {
        table.fail("reorder", "contradicts in_order, whose default is true: set in_order = false");
    }
}

void read_rate(const ConfigTable& table, RateSettings& rate) {
    table.read("rate_bits_per_s", rate.bits_per_s, 0, 1e12,
               "Rate of the link; 0: no limit; else at least 1.");
    if (rate.bits_per_s > 0 && rate.bits_per_s < 1) table.fail("rate_bits_per_s", "must be 0 or at least 1");
    table.read("rate_overhead_bytes", rate.overhead_bytes, 0, 65535,
               "Extra bytes of each packet; also for slots and deliveries.");
    table.read("rate_cell_bytes", rate.cell_bytes, 0, 65535,
               "Size of the cells that the link sends; 0: no cells.");
    table.read("rate_cell_overhead_bytes", rate.cell_overhead_bytes, 0, 65535, "Extra bytes of each cell.");
    table.read("rate_queue_packets", rate.queue_packets, 0, kMaxPackets,
               "Longest queue in packets; 0: limited by capacity only.");
    table.read("rate_queue_bytes", rate.queue_bytes, 0, kMaxBytes,
               "Longest queue in bytes; 0: limited by capacity only.");
    table.read("rate_drop", rate.drop, {"tail", "head"},
               "Packet that is dropped when the queue is full: tail: the newest; head: the oldest.");
}

void read_slots(const ConfigTable& table, SlotSettings& slot) {
    table.read("slot_least_s", slot.least, 0, 60,
               "Shortest time between two slots in which the medium sends.");
    if (table.has("slot_least_s")) slot.most = slot.least;
    table.read("slot_most_s", slot.most, 0, 60,
               "Longest time between two slots; default slot_least_s; 0: no slots.");
    constexpr std::array<std::string_view, 4> kShapes{"uniform", "normal", "pareto", "pareto-normal"};
    constexpr std::array kMeant{JitterShape::kUniform, JitterShape::kNormal, JitterShape::kPareto,
                                JitterShape::kParetoNormal};
    auto shape =
        static_cast<std::size_t>(std::find(kMeant.begin(), kMeant.end(), slot.shape) - kMeant.begin()) %
        kMeant.size();
    table.read("slot_shape", shape, kShapes,
               "Distribution of that time: uniform between the two, or one for which the two are mean - "
               "spread and mean + spread.");
    if (table.has("slot_shape")) slot.shape = kMeant.at(shape);
    table.read("slot_packets", slot.packets, 0, kMaxPackets, "Most packets in a slot; 0: no limit.");
    table.read("slot_bytes", slot.bytes, 0, kMaxBytes, "Most bytes in a slot; 0: no limit.");
    if (slot.most < slot.least) table.fail("slot_most_s", "must not be below slot_least_s");
    if (slot.most > Duration::zero() && slot.most < kShortestSlot) {
        table.fail("slot_most_s", "must be 0 (no slots) or at least 0.00001");
    }
    if (slot.most == Duration::zero() && (slot.packets > 0 || slot.bytes > 0)) {
        table.fail("slot_most_s", "must be above 0 for slots to have limits");
    }
}

Outage read_outage(const ConfigTable& entry) {
    Outage outage;
    entry.read("start_s", outage.start, 0, kLongestTime_s,
               "Start of the outage, from the start of the trial: no packet gets through.");
    entry.read("length_s", outage.length, 0, kLongestTime_s, "Length of the outage, above 0.");
    entry.read("every_s", outage.every, 0, kLongestTime_s,
               "Time between two outages, longer than length_s; 0: one outage.");
    return outage;
}

void read_outages(const ConfigTable& table, LinkSettings& link) {
    if (table.has("outage")) link.outages.clear();
    for (const ConfigTable& entry : table.tables("outage", read_outage)) {
        const Outage outage = read_outage(entry);
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
    table.read("trace_by", request.by, {"packet", "time"},
               "How the trace is replayed: by packet number or by time; default: as the file has it.");
    table.read("trace_between", request.between, {"hold", "linear"},
               "Values between two lines of the trace.");
    table.read("trace_end", request.end, {"wrap", "hold"}, "Continuation after the last line of the trace.");
    request.file =
        read_name(table, "trace", sources.trace != nullptr,
                  "CSV file with delay, loss and rate by time or packet (docs/network-profiles.md).");
    if (!request.file.empty()) table.load("trace", [&] { link.trace = sources.trace(request); });
    for (const char* key : {"trace_by", "trace_between", "trace_end"}) {
        if (table.has(key) && !table.has("trace"))
            table.fail(key, "has an effect with a trace only: name one, or remove it");
    }
    const std::string deliveries =
        read_name(table, "deliveries", sources.deliveries != nullptr,
                  "mahimahi trace of the times at which the link can send; replaces a rate.");
    if (!deliveries.empty())
        table.load("deliveries", [&] { link.deliveries = sources.deliveries(deliveries); });
}

void check_senders(const ConfigTable& table, const LinkSettings& link) {
    const bool traced = link.trace != nullptr && link.trace->layout().has_rate;
    if (link.deliveries != nullptr && (link.rate.bits_per_s > 0 || traced)) {
        table.fail("deliveries",
                   "cannot be combined with a rate, because both decide when the link sends: remove one");
    }
    if (link.deliveries != nullptr && link.slot.most > Duration::zero()) {
        table.fail("deliveries",
                   "cannot be combined with slots, because both decide when the link sends: remove one");
    }
    const bool waits =
        link.rate.bits_per_s > 0 || traced || link.deliveries != nullptr || link.slot.most > Duration::zero();
    if (!waits && (link.rate.queue_packets > 0 || link.rate.queue_bytes > 0)) {
        const char* key = link.rate.queue_packets > 0 ? "rate_queue_packets" : "rate_queue_bytes";
        table.fail(key,
                   "has no effect without a rate, slots or deliveries, because no packet waits: set one, or "
                   "remove it");
    }
}

// `base`: what holds without the table's keys. Its capacity stays as long as no key changes the delay.
void read_capacity(const ConfigTable& table, const LinkSettings& base, LinkSettings& link) {
    const bool same_delay =
        link.delay == base.delay && link.jitter.spread == base.jitter.spread && link.trace == base.trace;
    if (!same_delay) make_room_for_delay(link);
    auto capacity = static_cast<std::int64_t>(link.capacity);
    table.read(
        "capacity", capacity, 1, kMaxPackets,
        "Most packets in flight, further ones are dropped; default: twice what the delay needs at 1 kHz.");
    link.capacity = static_cast<std::size_t>(capacity);
    const std::size_t needed = packets_in_flight(link);
    if ((table.has("capacity") || !same_delay) && link.capacity < needed) {
        table.fail("capacity", "a link with this delay holds " + std::to_string(needed) +
                                   " packets of a 1 kHz flow: allow at least this number, or remove the key");
    }
}

}  // namespace

LinkSettings read_link_settings(const ConfigTable& table, const LinkSettings& base,
                                const LinkSources& sources) {
    LinkSettings link = base;
    const std::string profile =
        read_name(table, "profile", sources.profile != nullptr,
                  "Built-in name, file, or words of tc: start from these settings; other keys replace them.");
    if (!profile.empty()) table.load("profile", [&] { link = sources.profile(profile); });
    const LinkSettings start = link;
    table.read("delay_s", link.delay, 0, 60,
               "Mean one-way delay; a session uses the delay of its condition on the force path.");
    read_jitter(table, sources, link);
    link.loss = read_loss(table, link.loss);
    read_faults(table, link);
    read_rate(table, link.rate);
    read_slots(table, link.slot);
    read_outages(table, link);
    read_traces(table, sources, link);
    check_jitter(table, link);
    check_senders(table, link);
    read_capacity(table, start, link);
    return link;
}

Duration read_at(const ConfigTable& entry) {
    Duration at{};
    entry.read("at_s", at, 0, kLongestTime_s, "Start time of these settings.");
    return at;
}

Timeline read_timeline(const ConfigTable& table, const LinkSettings& base, const LinkSources& sources) {
    Timeline timeline;
    LinkSettings settings = base;
    Duration last{};
    const auto describe = [&](const ConfigTable& entry) {
        read_at(entry);
        read_link_settings(entry, base, sources);
    };
    for (const ConfigTable& entry : table.tables("timeline", describe)) {
        if (!entry.has("at_s")) entry.fail("at_s", "is missing: when do these settings begin?");
        const Duration at = read_at(entry);
        if (at <= last) entry.fail("at_s", "must be above 0 and rise from one entry to the next");
        settings = read_link_settings(entry, settings, sources);
        timeline.push_back({at, settings});
        last = at;
    }
    return timeline;
}

namespace {

constexpr std::array<std::string_view, 4> kLossModels{"independent", "gilbert", "gilbert-elliott",
                                                      "four-state"};

// Losses in bursts of `burst` packets on average; the keys are for the error message.
LossSettings in_bursts(const ConfigTable& table, double share, double burst, std::string_view share_key) {
    const double most = burst / (1 + burst);
    if (share > most) {
        table.fail(share_key,
                   "is {}, but with bursts of {} must not exceed {:.4g}: between two of them at least one "
                   "packet is received",
                   share, burst, most);
    }
    LossSettings loss = LossSettings::gilbert(share, burst);
    loss.good_to_bad = std::min(loss.good_to_bad, 1.0);  // rounding
    return loss;
}

LossSettings four_state(const ConfigTable& table, LossSettings loss) {
    loss.shape = LossShape::kFourState;
    if (loss.p13 + loss.p14 > 1) table.fail("p14", "p13 and p14 leave state 1: together at most 1");
    if (loss.p31 + loss.p32 > 1) table.fail("p32", "p31 and p32 leave state 3: together at most 1");
    if (loss.p13 > 0 && loss.p31 == 0) table.fail("p31", "must be above 0 if p13 is: a burst has to end");
    if (loss.p32 > 0 && loss.p23 == 0)
        table.fail("p23", "must be above 0 if p32 is: a burst must be able to continue");
    return loss;
}

LossSettings gilbert(const ConfigTable& table, double share, double burst, LossSettings chain) {
    chain.shape = LossShape::kGilbertElliott;
    if (!table.has("share") && !table.has("mean_burst")) return chain;
    for (const char* key : {"good_to_bad", "bad_to_good"}) {
        if (table.has(key)) table.fail(key, "says the same as share and mean_burst: give two of them");
    }
    return in_bursts(table, share, burst, "share");
}

LossSettings read_model(const ConfigTable& table) {
    std::size_t model = 0;
    table.read("model", model, kLossModels, "Model that selects the lost packets (docs/network.md).");
    const auto only = [&](std::vector<std::string_view> users) {
        return table.only_with("model", kLossModels[model], std::move(users));
    };
    LossSettings loss;
    double share = 0, burst = 1;
    const ConfigTable chain = only({"gilbert", "gilbert-elliott"}), elliott = only({"gilbert-elliott"});
    const ConfigTable four = only({"four-state"});
    only({"independent", "gilbert"})
        .read("share", share, 0, 1, "Share of packets that are lost, on average.");
    only({"gilbert"}).read("mean_burst", burst, 1, kLongestBurst, "Mean number of packets lost in a row.");
    chain.read("good_to_bad", loss.good_to_bad, 0, 1, "Probability per packet.");
    chain.read("bad_to_good", loss.bad_to_good, 0, 1, "Probability per packet.");
    elliott.read("loss_in_good", loss.loss_in_good, 0, 1, "Probability of a loss in this state.");
    elliott.read("loss_in_bad", loss.loss_in_bad, 0, 1, "Probability of a loss in this state.");
    four.read("p13", loss.p13, 0, 1, "Probability to go from received to lost in a burst.");
    four.read("p31", loss.p31, 0, 1, "Probability to go from lost in a burst to received.");
    four.read("p32", loss.p32, 0, 1, "Probability to go from lost in a burst to received in a burst.");
    four.read("p23", loss.p23, 0, 1, "Probability to go from received in a burst to lost in a burst.");
    four.read("p14", loss.p14, 0, 1, "Probability to go from received to lost alone.");
    switch (model) {
        case 0:
            return LossSettings::independent(share);
        case 1:
            return gilbert(table, share, burst, loss);
        case 2:
            loss.shape = LossShape::kGilbertElliott;
            return loss;
        default:
            return four_state(table, loss);
    }
}

}  // namespace

LossSettings read_loss(const ConfigTable& link, const LossSettings& base) {
    double share = stationary_loss(base), burst = 0;
    link.read("loss_burst", burst, 0, kLongestBurst,
              "Mean number of packets lost in a row; 0: independent losses.");
    const auto table = link.number_or_table(
        "loss", share, 0, 1, "Share of lost packets, independent, or in bursts with loss_burst; or a table.");
    if (table) {
        if (link.has("loss_burst"))
            link.fail("loss_burst", "has an effect with a number only: the table has mean_burst");
        LossSettings loss = read_model(*table);
        if (stationary_loss(loss) == 0) loss = {};
        return loss;
    }
    if (!link.has("loss") && !link.has("loss_burst")) return base;
    if (burst == 0 || share == 0) return LossSettings::independent(share);
    if (burst < 1) link.fail("loss_burst", "must be at least 1 packet, or 0 for independent losses");
    return in_bursts(link, share, burst, "loss");
}

}  // namespace thimble
