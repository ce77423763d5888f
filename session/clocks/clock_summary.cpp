#include "session/clocks/clock_summary.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "common/csv/columns.hpp"
#include "session/clocks/clock_line.hpp"
#include "session/clocks/clock_prober.hpp"

namespace thimble {
namespace {

constexpr std::uint64_t kMostStamp_ns = std::uint64_t{1} << 62;

void write_node(fmt::memory_buffer& out, const ClockRecord& record) {
    write_value(out, to_string(record.node));
}

void read_node(const CsvField& field, ClockRecord& record) {
    for (const Role role : kClockedNodes) {
        record.node = role;
        if (field.text == to_string(role)) return;
    }
    field.fail("is the name of no node");
}

template <auto Stamp>
constexpr TableColumn<ClockRecord> stamp(std::string_view name) {
    return {name,
            [](fmt::memory_buffer& out, const ClockRecord& record) {
                fmt::format_to(std::back_inserter(out), "{}", to_nanoseconds(record.exchange.*Stamp));
            },
            [](const CsvField& field, ClockRecord& record) {
                const auto ns = static_cast<std::int64_t>(field.integer(kMostStamp_ns));
                record.exchange.*Stamp = from_nanoseconds(ns);
            }};
}

// It follows from the stamps, so a reader passes over it.
template <auto Get>
constexpr TableColumn<ClockRecord> derived(std::string_view name) {
    return {name,
            [](fmt::memory_buffer& out, const ClockRecord& record) {
                write_value(out, (record.exchange.*Get)());
            },
            [](const CsvField&, ClockRecord&) {}};
}

using E = ClockExchange;
constexpr std::array kClockColumns{TableColumn<ClockRecord>{"node", write_node, read_node},
                                   stamp<&E::sent>("sent_ns"),
                                   stamp<&E::arrived>("arrived_node_ns"),
                                   stamp<&E::replied>("replied_node_ns"),
                                   stamp<&E::answered>("answered_ns"),
                                   derived<&E::offset_s>("offset_s"),
                                   derived<&E::bound_s>("bound_s")};
constexpr auto kClockNames = names_of(kClockColumns);

}  // namespace

ClockWriter::ClockWriter(const std::filesystem::path& path) : file_(path, IfExists::kReplace) {
    file_.write(fmt::format("{}\n", fmt::join(kClockNames, ",")));
}

void ClockWriter::append(Role node, const ClockExchange& e) {
    fmt::memory_buffer line;  // on the stack
    write_fields(line, kClockColumns, ClockRecord{node, e});
    line.push_back('\n');
    file_.write({line.data(), line.size()});
}

std::vector<ClockRecord> read_clock_file(const std::filesystem::path& path) {
    CsvReader reader(path, kClockNames);
    std::vector<ClockRecord> records;
    while (reader.next()) {
        read_fields(reader, kClockColumns, records.emplace_back());
        if (!records.back().exchange.possible())
            reader.field(4).fail("holds an exchange that is impossible for any two clocks");
    }
    return records;
}

namespace {

// Enough for a median; each costs a search along the hulls.
constexpr std::size_t kOneWaySamples = 501;

double median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

void add_one_way(std::span<const ClockExchange> exchanges, const ClockLine& line, ClockSummary& summary) {
    std::vector<double> there_s, back_s;
    double bound_s = 0;
    const std::size_t stride = exchanges.size() / kOneWaySamples + 1;
    for (std::size_t i = 0; i < exchanges.size(); i += stride) {
        const ClockExchange& e = exchanges[i];
        const OffsetInterval sent = line.at(e.sent), answered = line.at(e.answered);
        there_s.push_back(to_seconds(e.high()) - sent.offset_s());
        back_s.push_back(answered.offset_s() - to_seconds(e.low()));
        bound_s = std::max({bound_s, sent.bound_s(), answered.bound_s()});
    }
    summary.there = OneWayDelay{median(there_s), bound_s};
    summary.back = OneWayDelay{median(back_s), bound_s};
}

}  // namespace

bool ClockSummary::rate_known() const {
    return even && rate_low > -kClockRateLimit && rate_high < kClockRateLimit;
}

ClockSummary summarize_clock(std::span<const ClockExchange> exchanges) {
    ClockSummary summary;
    summary.exchanges = exchanges.size();
    if (exchanges.empty()) return summary;
    ClockFilter filter;
    std::size_t first = 0;
    std::vector<double> round_trips_s;
    for (std::size_t i = 0; i < exchanges.size(); ++i) {
        if (!filter.add(exchanges[i])) first = i;
        round_trips_s.push_back(to_seconds(exchanges[i].round_trip()));
    }
    summary.round_trip_median_s = median(round_trips_s);
    summary.steps = filter.steps();
    summary.offset = filter.at(exchanges.back().answered);
    const auto since_step = exchanges.subspan(first);
    const auto line = ClockLine::fit(since_step);
    if (!line) return summary;
    summary.even = true;
    summary.rate_low = line->rate_low();
    summary.rate_high = line->rate_high();
    summary.offset = line->at(exchanges.back().answered);
    add_one_way(since_step, *line, summary);
    return summary;
}

std::vector<NodeClock> clocks_of(double delay_s, const std::vector<ClockRecord>& records) {
    std::vector<NodeClock> clocks;
    for (const Role role : kClockedNodes) {
        std::vector<ClockExchange> exchanges;
        for (const ClockRecord& record : records) {
            if (record.node == role) exchanges.push_back(record.exchange);
        }
        if (!exchanges.empty()) clocks.push_back({delay_s, role, summarize_clock(exchanges)});
    }
    return clocks;
}

}  // namespace thimble
