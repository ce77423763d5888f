#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "netem/formats/tc_text.hpp"

namespace thimble {
namespace {

constexpr std::string_view kTableName = "thimble";

class TcPrinter {
  public:
    explicit TcPrinter(const LinkSettings& link) : link_(link) {}

    TcCommands print(std::string_view device) {
        result_.words = fmt::format("limit {}", link_.capacity);
        print_delay();
        print_loss();
        print_faults();
        print_rate();
        print_slot();
        name_the_rest();
        result_.command = fmt::format("tc qdisc add dev {} root netem {}", device, result_.words);
        return std::move(result_);
    }

  private:
    template <class... Values>
    void say(fmt::format_string<Values...> format, Values&&... values) {
        result_.words += ' ' + fmt::format(format, std::forward<Values>(values)...);
    }
    void cannot(std::string text) { result_.cannot.push_back(std::move(text)); }

    void print_delay() {
        const JitterSettings& jitter = link_.jitter;
        const bool jittery = jitter.shape != JitterShape::kNone;
        const double correlation = jittery ? jitter.correlation : 0;
        if (link_.delay > Duration::zero() || jittery) say("delay {}", print_tc_time(link_.delay));
        if (jittery) say("{}", print_tc_time(jitter.spread));
        if (correlation > 0) say("{}", print_tc_share(correlation));
        print_distribution();
        if (link_.delay.count() % 1000 != 0 || jitter.spread.count() % 1000 != 0) {
            cannot("delay: tc counts in whole microseconds and cuts the rest off");
        }
        if (correlation > 0) {
            // Successive uniform numbers x_n = (1 - c) u_n + c x_(n-1), as the kernel mixes them.
            cannot(
                fmt::format("jitter: tc's correlation narrows the distribution, to {:.0f} % of the spread "
                            "here (exactly so for uniform); this program's keeps it",
                            100 * std::sqrt((1 - correlation) / (1 + correlation))));
        }
        const bool overtakes = jittery && link_.rate.bits_per_s <= 0;  // in tc
        if (overtakes && link_.in_order) {
            cannot("order: tc lets packets overtake each other under jitter, this program keeps their order");
        }
        if (jittery && !overtakes && !link_.in_order && link_.reorder <= 0) {
            cannot(
                "order: with a rate tc keeps the order of packets, this program lets them overtake each "
                "other");
        }
    }

    static std::string_view table_of(JitterShape shape) {
        if (shape == JitterShape::kTable) return kTableName;
        return shape == JitterShape::kParetoNormal ? "paretonormal" : to_string(shape);
    }

    // Standard deviations of iproute2 6.1's tables, from their 4096 values.
    void print_distribution() {
        switch (link_.jitter.shape) {
            case JitterShape::kNone:
            case JitterShape::kUniform:
                return;  // what tc does without the word; it ships no uniform.dist
            case JitterShape::kNormal:
                return say("distribution normal");
            case JitterShape::kPareto:
                say("distribution pareto");
                return cannot_reach("Pareto", 0.82);
            case JitterShape::kParetoNormal:
                say("distribution paretonormal");
                return cannot_reach("Pareto-normal", 0.83);
            case JitterShape::kGamma:
                say("distribution normal");
                return cannot(
                    "jitter: tc has no gamma shape; a normal shape of the same spread is used instead");
            case JitterShape::kTable:
                say("distribution {}", kTableName);
                return cannot(
                    fmt::format("jitter: tc reads tables from its own folder only: copy the .dist file to "
                                "{}.dist there (TC_LIB_DIR names another folder)",
                                kTableName));
        }
    }

    void cannot_reach(std::string_view table, double deviation) {
        cannot(fmt::format(
            "jitter: tc's {} table ends at 4 spreads: its standard deviation is {} of the spread, its mean "
            "0.03 spreads too low",
            table, deviation));
    }

    void print_loss() {
        const LossSettings& loss = link_.loss;
        if (loss.shape == LossShape::kNone) return;
        print_loss_model(loss);
        if (link_.ecn) say("ecn");
    }
    void print_loss_model(const LossSettings& loss) {
        const auto say_shares = [&](std::string_view model, std::initializer_list<double> shares) {
            say("loss {}", model);
            for (const double share : shares) say("{}", print_tc_share(share));
        };
        switch (loss.shape) {
            case LossShape::kNone:
                return;
            case LossShape::kIndependent:
                return say_shares("random", {loss.probability});
            case LossShape::kGilbertElliott:
                return say_shares("gemodel",
                                  {loss.good_to_bad, loss.bad_to_good, loss.loss_in_bad, loss.loss_in_good});
            case LossShape::kFourState:
                return say_shares("state", {loss.p13, loss.p31, loss.p32, loss.p23, loss.p14});
        }
    }

    void print_faults() {
        if (link_.duplicate > 0) say("duplicate {}", print_tc_share(link_.duplicate));
        if (link_.corrupt > 0) {
            say("corrupt {}", print_tc_share(link_.corrupt));
            if (link_.corrupt_bits != 1) {
                cannot(fmt::format("corrupt: tc flips one bit of a packet, not {}", link_.corrupt_bits));
            }
        }
        if (link_.reorder <= 0) return;
        say("reorder {}", print_tc_share(link_.reorder));
        if (link_.reorder_gap != 1) say("gap {}", link_.reorder_gap);
        if (link_.rate.bits_per_s > 0) {
            cannot("reorder: a packet that skips the delay skips tc's rate, too; here it takes its turn");
        }
    }

    void print_rate() {
        const RateSettings& rate = link_.rate;
        if (rate.bits_per_s <= 0) return;
        say("rate {}", print_tc_rate(rate.bits_per_s));
        if (rate.overhead_bytes > 0 || rate.cell_bytes > 0) say("{}", rate.overhead_bytes);
        if (rate.cell_bytes > 0) say("{} {}", rate.cell_bytes, rate.cell_overhead_bytes);
        if (rate.queue_packets > 0 || rate.queue_bytes > 0) {
            cannot(
                "rate: tc has one limit, in packets, for queued and delayed packets together; chain a tbf or "
                "pfifo to limit the queue");
        }
        if (rate.drop == Drop::kHead) cannot("rate: tc drops the newest packet, not the oldest");
        cannot(
            "rate: tc counts the frame with its Ethernet header, this program the payload and the overhead "
            "given");
    }

    void print_slot() {
        const SlotSettings& slot = link_.slot;
        if (slot.most <= Duration::zero()) return;
        if (slot.shape == JitterShape::kUniform) {
            say("slot {} {}", print_tc_time(std::max(slot.least, Duration::zero())),
                print_tc_time(slot.most));
            if (slot.least < Duration::zero()) cannot("slot: tc has no uniform gaps wider than their mean");
        } else {
            const Duration spread = (slot.most - slot.least) / 2;
            say("slot distribution {} {} {}", table_of(slot.shape), print_tc_time(slot.least + spread),
                print_tc_time(spread));
        }
        if (slot.packets > 0) say("packets {}", slot.packets);
        if (slot.bytes > 0) say("bytes {}", slot.bytes);
    }

    void name_the_rest() {
        if (!link_.outages.empty()) {
            cannot(fmt::format("outages: {}; tc would need `loss 100%` switched by a script",
                               link_.outages.size()));
        }
        if (link_.trace) cannot("trace: tc replays no delays or losses from a file");
        if (link_.deliveries) cannot("deliveries: tc replays no capacity from a file; mahimahi does");
    }

    const LinkSettings& link_;
    TcCommands result_;
};

}  // namespace

TcCommands print_tc(const LinkSettings& link, std::string_view device) {
    return TcPrinter(link).print(device);
}

}  // namespace thimble
