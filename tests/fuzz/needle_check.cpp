#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "common/error.hpp"
#include "session/records/needle_file.hpp"
#include "slave_sim/needle_scene.hpp"
#include "slave_sim/scene_file.hpp"
#include "slave_sim/solvers.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

constexpr std::string_view kName = "fuzz.csv";

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    for (;;) {
        const std::size_t end = text.find('\n');
        lines.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return lines;
        text.remove_prefix(end + 1);
    }
}

// Where a spreadsheet separates fields by semicolons, commas are decimal.
char separator_of(std::string_view header) {
    const bool semicolons =
        header.find(';') != std::string_view::npos && header.find(',') == std::string_view::npos;
    return semicolons ? ';' : ',';
}

// The first line that is no comment; the parser has found one before.
std::string_view header_of(std::vector<std::string_view> lines) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (lines[0].substr(0, 3) == kByteOrderMark) lines[0].remove_prefix(3);
    return *std::find_if(lines.begin(), lines.end(), [](std::string_view line) {
        const std::size_t first = line.find_first_not_of(" \t\r");
        return first != std::string_view::npos && line[first] != '#';
    });
}

std::string flaw_of_pace(const NeedlePath::Sample& before, const NeedlePath::Sample& sample) {
    const NeedleLimits limits;
    const double elapsed_s = sample.time_s - before.time_s;
    if (!(sample.time_s > before.time_s)) return "times do not increase";
    if (!(elapsed_s <= limits.longest_gap_s)) return "a gap";
    const double moved_m = std::abs(sample.position_m - before.position_m);
    if (!(moved_m <= limits.fastest_m_per_s * elapsed_s)) return "a needle too fast";
    if (sample.line <= before.line) return "lines do not increase";
    return "";
}

std::string flaw_of_samples(const NeedlePath& path, std::string_view text) {
    if (path.samples.empty()) return "no sample";
    const std::vector<std::string_view> lines = lines_of(text);
    const char separator = separator_of(header_of(lines));
    const auto separators = [&](std::string_view line) {
        return std::count(line.begin(), line.end(), separator);
    };
    const auto fields = separators(header_of(lines));
    const NeedlePath::Sample* before = nullptr;
    for (const NeedlePath::Sample& sample : path.samples) {
        if (!std::isfinite(sample.time_s)) return "a time that is not finite";
        if (!(std::abs(sample.position_m) <= NeedleLimits{}.farthest_m)) return "a needle out of reach";
        if (sample.line < 2 || sample.line > lines.size()) return "a line that the file does not have";
        if (separators(lines[sample.line - 1]) != fields) return "more or fewer fields than the header";
        if (before != nullptr) {
            if (std::string flaw = flaw_of_pace(*before, sample); !flaw.empty()) return flaw;
        }
        before = &sample;
    }
    return "";
}

// Written as thimble writes trajectories and read again: the same bits.
std::string flaw_of_second_reading(const NeedlePath& path) {
    std::string text = "position_needle_m,time_s\n";
    for (const NeedlePath::Sample& sample : path.samples) {
        fmt::format_to(std::back_inserter(text), "{:.17g},{:.17g}\n", sample.position_m, sample.time_s);
    }
    const NeedlePath again = parse_needle_path(text, kName, {});
    const auto same = [](const NeedlePath::Sample& a, const NeedlePath::Sample& b) {
        return a.time_s == b.time_s && a.position_m == b.position_m;
    };
    const bool unchanged = std::equal(path.samples.begin(), path.samples.end(), again.samples.begin(),
                                      again.samples.end(), same);
    return unchanged ? "" : "samples change when they are written and read again";
}

std::string flaw_of_replay(const NeedlePath& path) {
    static const SceneDeclaration paper = paper_scene();
    NeedleScene scene(paper, solver_maker({}));
    double before_s = path.samples.front().time_s;
    scene.reset({path.samples.front().position_m, path.samples.front().position_m});
    for (const NeedlePath::Sample& sample : path.samples) {
        scene.clear_transitions();
        scene.step(before_s, sample.time_s - before_s, {sample.position_m, sample.position_m});
        const double force_N = scene.force_tissue_N() + scene.force_fixture_N();
        if (!std::isfinite(force_N)) return "a force that is not finite";
        before_s = sample.time_s;
    }
    return "";
}

std::string flaw_of_refusal(const Error& error, std::string_view text) {
    if (error.code() != ExitCode::kData) return "an Error that is not about data";
    std::size_t line = 0;
    int read = 0;
    const int found = std::sscanf(error.what(), "fuzz.csv:%zu: %n", &line, &read);
    if (found != 1 || read == 0) return "an Error without file and line";
    if (line < 1 || line > lines_of(text).size()) return "an Error about a line that the file does not have";
    return std::strlen(error.what()) > static_cast<std::size_t>(read) ? "" : "an Error that says nothing";
}

}  // namespace

Verdict check_needle(Bytes bytes) {
    const std::string_view text = text_of(bytes);
    NeedlePath path;
    try {
        path = parse_needle_path(text, kName, {});
    } catch (const Error& error) {
        return {false, flaw_of_refusal(error, text)};
    }
    try {
        std::string flaw = flaw_of_samples(path, text);
        if (flaw.empty()) flaw = flaw_of_second_reading(path);
        if (flaw.empty()) flaw = flaw_of_replay(path);
        return {true, flaw};
    } catch (const Error& error) {
        return {true, fmt::format("accepted, then refused: {}", error.what())};
    }
}

}  // namespace thimble
