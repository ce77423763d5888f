#include "netem/profiles/profile_link.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "netem/formats/delivery_trace_file.hpp"
#include "netem/formats/jitter_table_file.hpp"
#include "netem/formats/packet_trace_file.hpp"
#include "netem/formats/widest_spread.hpp"

namespace thimble {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::array<std::string_view, 7> kShapes{"none",   "uniform",       "normal", "gamma",
                                                  "pareto", "pareto-normal", "table"};
constexpr std::array kShapeValues{JitterShape::kNone,  JitterShape::kUniform, JitterShape::kNormal,
                                  JitterShape::kGamma, JitterShape::kPareto,  JitterShape::kParetoNormal,
                                  JitterShape::kTable};
constexpr std::int64_t kMostBytes = 4'294'967'295;
constexpr std::int64_t kMost = 1'000'000;

std::size_t place_of(JitterShape shape) {
    return static_cast<std::size_t>(std::find(kShapeValues.begin(), kShapeValues.end(), shape) -
                                    kShapeValues.begin());
}

std::size_t count(const ConfigTable& table, std::string_view key, std::size_t fallback, std::int64_t least,
                  std::int64_t most) {
    return static_cast<std::size_t>(table.integer(key, static_cast<std::int64_t>(fallback), least, most));
}

void read_jitter(const ConfigTable& table, LinkSettings& link, const FileFinder& find) {
    JitterSettings& jitter = link.jitter;
    jitter.shape =
        kShapeValues[table.choice("jitter", place_of(jitter.shape), {kShapes.begin(), kShapes.end()})];
    jitter.spread = table.seconds("jitter_spread_s", jitter.spread, Duration::zero(), seconds{60});
    jitter.correlation = table.number("jitter_correlation", jitter.correlation, 0, 0.999999);
    if (const std::string file = table.text("jitter_table", ""); !file.empty()) {
        jitter.table = std::make_shared<const JitterTable>(parse_jitter_table(find(file), file));
    }
    if (jitter.shape == JitterShape::kNone) {
        if (table.has("jitter_spread_s") && jitter.spread > Duration::zero()) {
            table.fail("jitter_spread_s", "a spread needs a distribution: set jitter");
        }
        jitter = {};
        return;
    }
    if (jitter.spread <= Duration::zero())
        table.fail("jitter_spread_s", "must be above 0 when there is jitter");
    if (jitter.shape == JitterShape::kTable && !jitter.table) {
        table.fail("jitter_table", "must name a .dist file when jitter is \"table\"");
    }
    if (jitter.spread > widest_spread(jitter.shape, link.delay)) {
        table.fail(
            "jitter_spread_s",
            fmt::format(
                "must not exceed {} s here: delays are cut at 0, so their mean would no longer be delay_s "
                "(\"gamma\" takes up to ten times delay_s)",
                to_seconds(widest_spread(jitter.shape, link.delay))));
    }
}

void read_loss(const ConfigTable& table, LinkSettings& link) {
    if (!table.has("loss") && !table.has("loss_burst")) {
        return;
    }
    const double share = table.number("loss", stationary_loss(link.loss), 0, 1);
    const double burst = table.number("loss_burst", 0, 0, 1e6);
    if (burst == 0 || share == 0) {
        link.loss = LossSettings::independent(share);
        return;
    }
    if (burst < 1) table.fail("loss_burst", "must be at least 1 packet, or 0 for independent losses");
    if (share > burst / (1 + burst)) {
        table.fail("loss",
                   fmt::format("must not exceed {:.4g}: at least one packet is received between two bursts",
                               burst / (1 + burst)));
    }
    link.loss = {};
    link.loss.shape = LossShape::kGilbertElliott;
    link.loss.bad_to_good = 1 / burst;
    link.loss.good_to_bad = std::min(1.0, share / (1 - share) / burst);
}

void read_faults(const ConfigTable& table, LinkSettings& link) {
    link.duplicate = table.number("duplicate", link.duplicate, 0, 1);
    link.corrupt = table.number("corrupt", link.corrupt, 0, 1);
    link.corrupt_bits = static_cast<unsigned>(count(table, "corrupt_bits", link.corrupt_bits, 1, 64));
    link.reorder = table.number("reorder", link.reorder, 0, 1);
    link.reorder_gap = static_cast<unsigned>(count(table, "reorder_gap", link.reorder_gap, 1, kMost));
    link.in_order = table.boolean("in_order", link.in_order);
    if (link.reorder > 0 && link.in_order) {
        table.fail("in_order", "must be false for packets to be reordered");
    }
}

void read_medium(const ConfigTable& table, LinkSettings& link) {
    RateSettings& rate = link.rate;
    rate.bits_per_s = table.number("rate_bits_per_s", rate.bits_per_s, 0, 1e12);
    rate.overhead_bytes = count(table, "rate_overhead_bytes", rate.overhead_bytes, 0, 65535);
    rate.queue_packets = count(table, "rate_queue_packets", rate.queue_packets, 0, kMost);
    rate.queue_bytes = count(table, "rate_queue_bytes", rate.queue_bytes, 0, kMostBytes);
    rate.drop = table.choice("rate_drop", rate.drop == Drop::kHead ? 1U : 0U, {"tail", "head"}) == 1
                    ? Drop::kHead
                    : Drop::kTail;
    if (rate.bits_per_s > 0 && rate.bits_per_s < 1) table.fail("rate_bits_per_s", "must be 0 or at least 1");
    SlotSettings& slot = link.slot;
    slot.least = table.seconds("slot_least_s", slot.least, Duration::zero(), seconds{60});
    slot.most = table.seconds("slot_most_s", std::max(slot.least, slot.most), Duration::zero(), seconds{60});
    slot.packets = count(table, "slot_packets", slot.packets, 0, kMost);
    slot.bytes = count(table, "slot_bytes", slot.bytes, 0, kMostBytes);
    if (slot.most < slot.least) table.fail("slot_most_s", "must not be below slot_least_s");
}

void read_outages(const ConfigTable& table, LinkSettings& link) {
    const std::vector<ConfigTable> outages = table.tables("outage");
    if (!outages.empty()) link.outages.clear();
    for (const ConfigTable& entry : outages) {
        Outage outage;
        outage.start = entry.seconds("start_s", {}, Duration::zero(), hours{1000});
        outage.length = entry.seconds("length_s", {}, Duration::zero(), hours{1000});
        outage.every = entry.seconds("every_s", {}, Duration::zero(), hours{1000});
        if (outage.length == Duration::zero()) entry.fail("length_s", "must be above 0");
        if (outage.every > Duration::zero() && outage.every <= outage.length) {
            entry.fail("every_s", "must be longer than length_s, or 0 for once");
        }
        link.outages.push_back(outage);
    }
}

void read_traces(const ConfigTable& table, LinkSettings& link, const FileFinder& find) {
    TraceChoice choice;
    const std::string file = table.text("trace", "");
    if (table.has("trace_by")) {
        choice.by = table.choice("trace_by", 0, {"time", "packet"}) == 0 ? TraceBy::kTime : TraceBy::kPacket;
    }
    choice.between = table.choice("trace_between", 0, {"hold", "linear"}) == 0 ? TraceBetween::kHold
                                                                               : TraceBetween::kLinear;
    choice.end = table.choice("trace_end", 0, {"wrap", "hold"}) == 0 ? TraceEnd::kWrap : TraceEnd::kHold;
    if (!file.empty()) {
        link.trace = std::make_shared<const PacketTrace>(parse_packet_trace(find(file), file, choice));
    }
    if (const std::string deliveries = table.text("deliveries", ""); !deliveries.empty()) {
        link.deliveries =
            std::make_shared<const DeliveryTrace>(parse_delivery_trace(find(deliveries), deliveries));
    }
}

// Twice what a flow of 1 kHz needs.
std::size_t needed_capacity(const LinkSettings& link) {
    Duration longest = link.delay + link.jitter.spread;
    if (link.trace) {
        for (const TraceRow& row : link.trace->rows()) longest = std::max(longest, row.delay);
    }
    return 2 * static_cast<std::size_t>(longest / milliseconds{1} + 1);
}

class Printer {
  public:
    template <class Value>
    void unless(std::string_view key, const Value& value, const Value& otherwise) {
        if (value != otherwise) text_ += fmt::format("{} = {}\n", key, value);
    }
    void seconds(std::string_view key, Duration value) { unless(key, to_seconds(value), 0.0); }
    void line(const std::string& text) { text_ += text + '\n'; }
    std::string take() { return std::move(text_); }

  private:
    std::string text_;
};

void print_loss(const LossSettings& loss, Printer& out) {
    out.unless("loss", stationary_loss(loss), 0.0);
    if (loss.shape != LossShape::kGilbertElliott || stationary_loss(loss) <= 0) return;
    if (loss.loss_in_good == 0 && loss.loss_in_bad == 1) {
        out.unless("loss_burst", 1 / loss.bad_to_good, 0.0);
    } else {
        out.line("# losses in bursts of several kinds: only their share is written");
    }
}

}  // namespace

LinkSettings read_profile_link(const ConfigTable& table, const LinkSettings& base, const FileFinder& find) {
    LinkSettings link = base;
    link.delay = table.seconds("delay_s", link.delay, Duration::zero(), seconds{60});
    read_jitter(table, link, find);
    read_loss(table, link);
    read_faults(table, link);
    read_medium(table, link);
    read_outages(table, link);
    read_traces(table, link, find);
    link.capacity = count(table, "capacity", std::max(link.capacity, needed_capacity(link)), 1, kMost);
    return link;
}

std::string print_profile_link(const LinkSettings& link) {
    const LinkSettings none;
    Printer out;
    out.seconds("delay_s", link.delay);
    if (link.jitter.shape != JitterShape::kNone) {
        out.line(fmt::format("jitter = \"{}\"", kShapes[place_of(link.jitter.shape)]));
        out.seconds("jitter_spread_s", link.jitter.spread);
        out.unless("jitter_correlation", link.jitter.correlation, 0.0);
    }
    print_loss(link.loss, out);
    out.unless("duplicate", link.duplicate, none.duplicate);
    out.unless("corrupt", link.corrupt, none.corrupt);
    out.unless("corrupt_bits", link.corrupt_bits, none.corrupt_bits);
    out.unless("reorder", link.reorder, none.reorder);
    out.unless("reorder_gap", link.reorder_gap, none.reorder_gap);
    out.unless("in_order", link.in_order, none.in_order);
    out.unless("rate_bits_per_s", link.rate.bits_per_s, 0.0);
    out.unless("rate_overhead_bytes", link.rate.overhead_bytes, none.rate.overhead_bytes);
    out.unless("rate_queue_packets", link.rate.queue_packets, none.rate.queue_packets);
    out.unless("rate_queue_bytes", link.rate.queue_bytes, none.rate.queue_bytes);
    if (link.rate.drop == Drop::kHead) out.line("rate_drop = \"head\"");
    out.seconds("slot_least_s", link.slot.least);
    out.seconds("slot_most_s", link.slot.most);
    out.unless("slot_packets", link.slot.packets, none.slot.packets);
    out.unless("slot_bytes", link.slot.bytes, none.slot.bytes);
    out.line(fmt::format("capacity = {}", link.capacity));
    if (link.jitter.table || link.trace || link.deliveries)
        out.line("# name the file of its table or trace here");
    return out.take();
}

}  // namespace thimble
