#include <algorithm>

#include <fmt/format.h>

#include "common/duration_text.hpp"
#include "netem/formats/jitter_table_file.hpp"
#include "netem/formats/trace_files.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

class Printer {
  public:
    template <class Value>
    void unless(std::string_view key, const Value& value, const Value& otherwise) {
        if (value != otherwise) text_ += fmt::format("{} = {}\n", key, value);
    }
    // With a unit where a number alone would be doubted.
    void seconds(std::string_view key, Duration value) {
        const double seconds = to_seconds(value);
        const bool plain = doubt_seconds(key, seconds).empty();
        unless(key, plain ? fmt::format("{}", seconds) : fmt::format("\"{}s\"", seconds), std::string("0"));
    }
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

LinkSources sources_of(const FileFinder& find) {
    LinkSources sources;
    sources.jitter_table = [find](const std::string& file) {
        return std::make_shared<const JitterTable>(parse_jitter_table(find(file), file));
    };
    sources.trace = [find](const TraceRequest& request) {
        TraceChoice choice{{}, request.between, request.end};
        if (request.by_given) choice.by = request.by;
        return std::make_shared<const PacketTrace>(
            parse_packet_trace(find(request.file), request.file, choice));
    };
    sources.deliveries = [find](const std::string& file) {
        return std::make_shared<const DeliveryTrace>(parse_delivery_trace(find(file), file));
    };
    return sources;
}

std::string print_profile_link(const LinkSettings& link) {
    const LinkSettings none;
    Printer out;
    out.seconds("delay_s", link.delay);
    if (link.jitter.shape != JitterShape::kNone) {
        out.line(fmt::format("jitter = \"{}\"", to_string(link.jitter.shape)));
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
    out.unless("ecn", link.ecn, none.ecn);
    out.unless("rate_bits_per_s", link.rate.bits_per_s, 0.0);
    out.unless("rate_overhead_bytes", link.rate.overhead_bytes, none.rate.overhead_bytes);
    out.unless("rate_cell_bytes", link.rate.cell_bytes, none.rate.cell_bytes);
    out.unless("rate_cell_overhead_bytes", link.rate.cell_overhead_bytes, none.rate.cell_overhead_bytes);
    out.unless("rate_queue_packets", link.rate.queue_packets, none.rate.queue_packets);
    out.unless("rate_queue_bytes", link.rate.queue_bytes, none.rate.queue_bytes);
    if (link.rate.drop == Drop::kHead) out.line("rate_drop = \"head\"");
    out.seconds("slot_least_s", std::max(Duration::zero(), link.slot.least));
    out.seconds("slot_most_s", link.slot.most);
    if (link.slot.shape != none.slot.shape)
        out.line(fmt::format("slot_shape = \"{}\"", to_string(link.slot.shape)));
    out.unless("slot_packets", link.slot.packets, none.slot.packets);
    out.unless("slot_bytes", link.slot.bytes, none.slot.bytes);
    out.line(fmt::format("capacity = {}", link.capacity));
    if (link.slot.least < Duration::zero())
        out.line(
            "# slots that vary by more than their mean: only tc's words say that (profile = \"slot "
            "distribution ...\")");
    if (link.jitter.table || link.slot.table || link.trace || link.deliveries)
        out.line("# name the file of its table or trace here");
    return out.take();
}

}  // namespace thimble
