#include "bench/network/chain_figures.hpp"

#include <utility>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr const char* kChainGoal = "<= 1.3";

}  // namespace

void ChainFigures::add_chain(const ChainRound& round) {
    chain_.add(round.round_trip);
    trials_.push_back(round);
}

void ChainFigures::add_bare(std::vector<double> round_trips_us) { bare_.add(std::move(round_trips_us)); }

void ChainFigures::add_ping_pong(const WindowQuantiles& window) { ping_pong_.add(window); }

std::vector<ChainRow> ChainFigures::rows() const {
    const WindowErrors chain = chain_.errors(), bare = bare_.errors(), pair = ping_pong_.errors();
    constexpr double kPairs = kChainHops / 2;
    return {{"bare chain of three, w50", kChainGoal, chain.w50_us, bare.w50_us},
            {"bare chain of three, w99", "", chain.w99_us, bare.w99_us},
            {"2 bare ping-pongs, w50", kChainGoal, chain.w50_us, kPairs * pair.w50_us},
            {"2 bare ping-pongs, w99", "", chain.w99_us, kPairs * pair.w99_us}};
}

ChainRound ChainFigures::inside() const {
    const auto median = [this](auto member) {
        std::vector<double> values;
        for (const ChainRound& trial : trials_) values.push_back(trial.*member);
        return median_of(std::move(values));
    };
    ChainRound round;
    round.hold_us = median(&ChainRound::hold_us);
    round.master_turn_us = median(&ChainRound::master_turn_us);
    round.netem_turn_us = median(&ChainRound::netem_turn_us);
    round.slave_turn_us = median(&ChainRound::slave_turn_us);
    return round;
}

std::string ChainFigures::table() const {
    std::string text = fmt::format(
        "scheduling: {}\n| beside | chain | bare | ratio | goal |\n| --- | --- | --- | --- | --- |\n",
        scheduling_);
    for (const ChainRow& r : rows()) {
        text += fmt::format("| {} | {:.1f} us | {:.1f} us | {:.3f} | {} |\n", r.what, r.chain_us, r.bare_us,
                            r.ratio(), r.goal);
    }
    const ChainRound in = inside();
    text += fmt::format(
        "windows with a stall: chain {:.0f} %, bare chain {:.0f} %, ping-pong {:.0f} %\n"
        "a turn takes, median: master {:.1f} us, netem {:.1f} us, slave_sim {:.1f} us; it says it holds "
        "{:.1f} us\n",
        100 * chain_.errors().stalled, 100 * bare_.errors().stalled, 100 * ping_pong_.errors().stalled,
        in.master_turn_us, in.netem_turn_us, in.slave_turn_us, in.hold_us);
    return text;
}

nlohmann::ordered_json ChainFigures::json() const {
    const ChainRound in = inside();
    nlohmann::ordered_json found{
        {"scheduling", scheduling_},
        {"hold_us", in.hold_us},
        {"turns_us",
         {{"master", in.master_turn_us}, {"netem", in.netem_turn_us}, {"slave_sim", in.slave_turn_us}}},
        {"stalled_windows",
         {{"chain", chain_.errors().stalled},
          {"bare_chain", bare_.errors().stalled},
          {"ping_pong", ping_pong_.errors().stalled}}}};
    for (const ChainRow& r : rows()) {
        found["rows"].push_back({{"beside", r.what},
                                 {"chain_us", r.chain_us},
                                 {"bare_us", r.bare_us},
                                 {"ratio", r.ratio()},
                                 {"goal", r.goal}});
    }
    return found;
}

}  // namespace thimble
