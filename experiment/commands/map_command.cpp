// thimble sweep: a stability map measured in virtual time, with the boundary of the theory.
#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/error.hpp"
#include "common/runtime/realtime_loop.hpp"
#include "experiment/commands/commands.hpp"
#include "experiment/csv_file.hpp"
#include "experiment/gnuplot.hpp"
#include "experiment/stability/stability_map.hpp"
#include "experiment/study.hpp"

namespace thimble {
namespace {

struct MapArguments {
    MapPlan plan;
    std::string delays = "0:0.2:41", stiffness = "50:20000:41", out;
    unsigned jobs = 0;
    bool overwrite = false;
};

struct MapAxis {
    double low, high;
    long points;
};

MapAxis parse_axis(const std::string& option, const std::string& text) {
    MapAxis axis{};
    char end = 0;
    const int read = std::sscanf(text.c_str(), "%lf:%lf:%ld%c", &axis.low, &axis.high, &axis.points, &end);
    const bool good = read == 3 && std::isfinite(axis.low) && std::isfinite(axis.high) && axis.low >= 0 &&
                      axis.high > axis.low && axis.points >= 2 && axis.points <= 10000;
    if (good) return axis;
    throw Error(
        ExitCode::kUsage,
        fmt::format("{} {}: needs LOW:HIGH:POINTS with 0 <= LOW < HIGH and 2 to 10000 points", option, text));
}

std::vector<double> spread(const MapAxis& axis, bool logarithmic) {
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(axis.points));
    for (long i = 0; i < axis.points; ++i) {
        const double part = static_cast<double>(i) / static_cast<double>(axis.points - 1);
        values.push_back(logarithmic ? axis.low * std::pow(axis.high / axis.low, part)
                                     : axis.low + (axis.high - axis.low) * part);
    }
    return values;
}

// What decides the table's bytes: another one is another map.
std::string plan_text(const MapArguments& a) {
    const MapPlan& p = a.plan;
    return fmt::format(
        "delay_s {}\ncontact_stiffness_N_per_m {}\nhand {} kg {} Ns/m {} N/m\nstep {} s, press {} N, "
        "limit {} N, encoder {} m\n",
        a.delays, a.stiffness, p.hand.mass_kg, p.hand.damping_Ns_per_m, p.hand.stiffness_N_per_m, p.step_s,
        p.press_N, p.force_limit_N, p.encoder_step_m);
}

std::string whole_text(const std::filesystem::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// How many columns are there already; the table is cut back to them.
std::size_t columns_done(const MapArguments& a, const std::filesystem::path& table) {
    const auto plan = std::filesystem::path(a.out) / "map.txt";
    if (!std::filesystem::exists(table)) return 0;
    if (whole_text(plan) != plan_text(a)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("{}: another map; give --overwrite or another --out", a.out));
    }
    const std::string text = whole_text(table);
    const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
    const std::size_t each = a.plan.stiffness_N_per_m.size(), columns = lines > 0 ? (lines - 1) / each : 0;
    keep_lines(table, columns * each);
    return columns;
}

// Columns are worked out by threads and taken in their order.
class MapWorkers {
  public:
    MapWorkers(const MapPlan& plan, std::size_t first, unsigned threads) : plan_(plan), next_(first) {
        columns_.resize(plan.delays_s.size());
        threads_.reserve(threads);
        for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
    }
    ~MapWorkers() {
        {
            const std::lock_guard lock(mutex_);
            next_ = columns_.size();
        }
        for (std::thread& thread : threads_) thread.join();
    }
    MapWorkers(const MapWorkers&) = delete;
    MapWorkers& operator=(const MapWorkers&) = delete;

    std::string take(std::size_t column) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return columns_[column].has_value() || failure_; });
        if (failure_) std::rethrow_exception(failure_);
        return *std::exchange(columns_[column], std::nullopt);
    }

  private:
    void work() {
        for (;;) {
            std::unique_lock lock(mutex_);
            if (next_ >= columns_.size() || failure_) return;
            const std::size_t mine = next_++;
            lock.unlock();
            run(mine);
            changed_.notify_all();
        }
    }
    void run(std::size_t mine) {
        std::string rows;
        std::exception_ptr failure;
        try {
            for (const MapCell& cell : map_column(plan_, mine)) rows += map_row(cell);
        } catch (...) {
            failure = std::current_exception();
        }
        const std::lock_guard lock(mutex_);
        columns_[mine] = std::move(rows);
        if (failure) failure_ = failure;
    }

    const MapPlan& plan_;
    std::size_t next_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::optional<std::string>> columns_;
    std::exception_ptr failure_;
    std::vector<std::thread> threads_;
};

// The classes of the hold as points, the boundary as a line. The table is the data.
std::string map_script(const MapPlan& plan) {
    std::string script = gnuplot_preamble("map", 900, 620);
    // Points that touch: 900 pixels for all of them.
    const double size =
        45.0 / static_cast<double>(std::max(plan.delays_s.size(), plan.stiffness_N_per_m.size()));
    const auto points = [size](char label, std::string_view colour, const char* title) {
        return fmt::format(
            "     'map.tsv' using (1e3*$1):(strcol(6) eq '{}' ? $2 : 1/0) with points pt 5 ps {:.2f} "
            "lc rgb '{}' title '{}', \\\n",
            label, size, colour, title);
    };
    script += fmt::format(
        "set datafile separator ','\nset logscale y\nset xlabel 'delay (ms)'\n"
        "set ylabel 'contact stiffness at the handle (N/m)'\n"
        "set yrange [{}:{}]\nset key outside bottom center horizontal\nplot \\\n",
        plan.stiffness_N_per_m.front(), plan.stiffness_N_per_m.back());
    script += points('S', kSkyBlue, "settles") + points('M', kGrey, "in between") +
              points('O', kVermilion, "oscillates");
    script += "     'map.tsv' using (1e3*$1):3 with lines lw 2 lc rgb 'black' title 'theory'\n";
    return script;
}

void draw_map(const MapArguments& a, const std::filesystem::path& table) {
    std::string data = whole_text(table);
    data.erase(0, data.find('\n') + 1);
    try {
        run_gnuplot(a.out, "map", data, map_script(a.plan));
        fmt::print("figure: {}\n", (std::filesystem::path(a.out) / "map.svg").string());
    } catch (const Error& error) {
        spdlog::warn("no figure: {}", error.what());
    }
}

int run_map(MapArguments& a) {
    const MapAxis stiffness = parse_axis("--contact-stiffness-N-per-m", a.stiffness);
    if (!(stiffness.low > 0))
        throw Error(ExitCode::kUsage, "--contact-stiffness-N-per-m: LOW must be above 0");
    a.plan.delays_s = spread(parse_axis("--delay-s", a.delays), false);
    a.plan.stiffness_N_per_m = spread(stiffness, true);
    require_meaningful(a.plan.hand);
    if (!std::isfinite(a.plan.press_N + a.plan.force_limit_N + a.plan.encoder_step_m)) {
        throw Error(ExitCode::kUsage, "press, force limit and encoder must be finite");
    }
    install_stop_signals();
    std::error_code failed;  // the table says so
    std::filesystem::create_directories(a.out, failed);
    const auto table = std::filesystem::path(a.out) / "map.csv";
    if (a.overwrite) std::filesystem::remove(table);
    const std::size_t done = columns_done(a, table);
    if (done > 0) spdlog::info("{} of {} delays were there already", done, a.plan.delays_s.size());
    std::ofstream(std::filesystem::path(a.out) / "map.txt") << plan_text(a);
    CsvFile file(table, IfExists::kContinue);
    if (file.is_new()) file.write(map_header());
    MapWorkers workers(a.plan, done, thread_count(a.jobs));
    for (std::size_t column = done; column < a.plan.delays_s.size(); ++column) {
        if (stop_requested()) {
            spdlog::error("interrupted; the {} delays that were done are kept, the same command goes on",
                          column);
            return static_cast<int>(ExitCode::kRunFailed);
        }
        file.write(workers.take(column));
        file.flush();
    }
    fmt::print("table: {}\n", table.string());
    draw_map(a, table);
    return static_cast<int>(ExitCode::kOk);
}

}  // namespace

Subcommand add_map(CLI::App& app) {
    const auto arguments = std::make_shared<MapArguments>();
    MapArguments& a = *arguments;
    CLI::App* command =
        app.add_subcommand("sweep", "a stability map: delay against stiffness, measured and by theory");
    command->add_option("--mass-kg", a.plan.hand.mass_kg, "hand and handle, moved together")->required();
    command->add_option("--damping-Ns-per-m", a.plan.hand.damping_Ns_per_m, "of hand and handle")->required();
    command->add_option("--stiffness-N-per-m", a.plan.hand.stiffness_N_per_m, "of the hand")->required();
    command->add_option("--delay-s", a.delays, "of the whole way round, evenly spread")
        ->type_name("LOW:HIGH:POINTS")
        ->capture_default_str();
    command
        ->add_option("--contact-stiffness-N-per-m", a.stiffness,
                     "of the fixture at the handle, evenly in its logarithm")
        ->type_name("LOW:HIGH:POINTS")
        ->capture_default_str();
    command->add_option("--step-s", a.plan.step_s, "between two samples")
        ->capture_default_str()
        ->check(CLI::Range(1e-5, 0.1));
    command->add_option("--press-N", a.plan.press_N, "with which the hand would press at the wall")
        ->capture_default_str();
    command->add_option("--force-limit-N", a.plan.force_limit_N, "of the handle")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    command->add_option("--encoder-m", a.plan.encoder_step_m, "one step of the encoder")
        ->capture_default_str()
        ->check(CLI::NonNegativeNumber);
    command->add_option("-o,--out", a.out, "folder for map.csv, map.svg and map.txt")->default_val("out/map");
    command->add_option("-j,--jobs", a.jobs, "threads, 0: one per core; the results do not depend on it")
        ->check(CLI::Range(0, 1024));
    command->add_flag("--overwrite", a.overwrite, "begin anew; without it an interrupted sweep goes on");
    command->footer(
        "Example:\n  thimble sweep --mass-kg 1 --damping-Ns-per-m 20 --stiffness-N-per-m 500 --out out/map\n"
        "What the classes mean, and why peak-to-peak alone is not one: docs/stability.md");
    return {command, [arguments] { return run_map(*arguments); }};
}

}  // namespace thimble
