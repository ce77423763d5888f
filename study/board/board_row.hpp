// A row of the board: the trials of one controller with one codec in one condition, and what came out, with 90 % intervals. A row is
// made of its seed alone, so that its bytes do not depend on who makes it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/report/report.hpp"
#include "common/csv/csv_file.hpp"
#include "study/board/board_plan.hpp"

namespace thimble {

inline constexpr double kBoardConfidence = 0.9;
// Prefix of the status of a row whose session is not valid.
inline constexpr std::string_view kNotPossible = "not possible: ";

enum BoardMeasure : std::size_t {
    kOscillating,      // share of trials
    kNotCompleted,     // share of trials
    kPenetrationMean,  // m
    kPenetrationMax,   // m
    kCompletionTime,   // s, of the trials that completed
    kStiffnessFelt,    // over the fixture's
    kDrift,            // m of needle
    kEnergyOut,        // J, the most that the handle's port had given out at any time
    kPackets,          // per second, of needle and force together
    kBytes,            // the same, with seals and headers (wire_use.hpp)
    kBoardMeasures
};
inline constexpr std::array<std::string_view, kBoardMeasures> kBoardMeasureColumns{
    "oscillating_share", "not_completed_share", "penetration_mean_m", "penetration_max_m",
    "completion_time_s", "rendered_stiffness",  "drift_needle_m",     "energy_out_J",
    "packets_per_s",     "bytes_per_s"};

// A mean over trials; NaN: no trial has the measure.
struct BoardValue {
    double mean = std::numeric_limits<double>::quiet_NaN();
    double low = mean, high = mean;
};

struct BoardTrial {
    bool completed = false;
    std::array<double, kBoardMeasures> values{};  // shares are 0 or 1
};

struct BoardRow {
    std::string controller, codec, condition;
    std::string network, hands, tissue, scene;
    double delay_s = 0, jitter_s = 0, loss = 0;
    std::uint32_t trials = 0;
    std::array<BoardValue, kBoardMeasures> values{};
    std::uint32_t subject = 0;  // of the first trial that oscillates or does not complete; 0: none
    std::string status = "ok";  // else why the row has no measures

    bool possible() const { return !status.starts_with(kNotPossible); }
    // All trials completed, and none oscillated.
    bool stable() const {
        return status == "ok" && values[kOscillating].mean == 0 && values[kNotCompleted].mean == 0;
    }
};

// One trial over the network of the settings. `subject` is one of the study of this seed. Once a sample is in, `each_sample` is called.
// Throws Error (run failed) if a plug-in gave values that are no numbers.
BoardTrial run_board_trial(const SystemSettings& settings, std::uint64_t seed, std::uint32_t subject,
                           const std::function<void()>& each_sample = {});
// Means with intervals: Wilson's for shares, else the bootstrap's percentiles, drawn from the seed.
void condense(const std::vector<BoardTrial>& trials, std::uint64_t seed, BoardRow& row);

// Runs the trials of a row. A contestant that throws costs its row only: `status` says why.
BoardRow run_board_row(const BoardPlan& plan, std::size_t row);

// The lines of board.csv.
std::string board_header();
std::string board_line(const BoardRow& row);
// Throws Error (data).
std::vector<BoardRow> read_board_rows(const std::filesystem::path& file);

// The whole board: every row that is not there yet.
struct BoardOptions {
    std::filesystem::path out;
    IfExists if_exists = IfExists::kRefuse;
    unsigned jobs = 0;  // threads; 0: one per core
    const std::atomic<bool>* stop = nullptr;
};

// Writes board.csv, a row as soon as all before it are done, and board.txt, the plan. False if it was stopped before the last row.
bool run_board(const BoardPlan& plan, const BoardOptions& options);

}  // namespace thimble
