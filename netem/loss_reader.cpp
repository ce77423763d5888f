#include "netem/loss_reader.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace thimble {
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
