// The findings of thimble-bench chain, window by window, and their table. Pure arithmetic.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/network/chain_rounds.hpp"
#include "bench/network/window_errors.hpp"

namespace thimble {

inline constexpr double kChainHops = 4;  // master -> netem -> slave_sim -> netem -> master

struct ChainRow {
    std::string what, goal;
    double chain_us = 0, bare_us = 0;
    double ratio() const { return bare_us > 0 ? chain_us / bare_us : 0; }
};

class ChainFigures {
  public:
    explicit ChainFigures(std::string scheduling) : scheduling_(std::move(scheduling)) {}

    void add_chain(const ChainRound& round);
    // Round trips over as many hops as the chain has.
    void add_bare(std::vector<double> round_trips_us);
    // A window of round trips between two processes, two hops.
    void add_ping_pong(const WindowQuantiles& window);

    // Medians over the windows. A window of ping-pong counts kChainHops / 2 times.
    std::vector<ChainRow> rows() const;
    std::string table() const;  // Markdown
    nlohmann::ordered_json json() const;

  private:
    // Medians over the trials.
    ChainRound inside() const;

    std::string scheduling_;
    ErrorWindows chain_, bare_, ping_pong_;
    std::vector<ChainRound> trials_;
};

}  // namespace thimble
