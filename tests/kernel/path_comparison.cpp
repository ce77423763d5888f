#include "tests/kernel/path_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "common/decimal_text.hpp"
#include "common/text_file.hpp"
#include "netem/formats/text_lines.hpp"
#include "netem/relay/selftest_twin.hpp"

namespace thimble {
namespace {

constexpr std::size_t kBatches = 20;

std::int64_t read_count(const LineReader& lines, std::string_view field, std::string_view name) {
    const auto value = parse_whole<std::int64_t>(field);
    if (!value || *value < 0)
        lines.fail(fmt::format("'{}' is no {}; a whole number from 0 belongs here", field, name));
    return *value;
}

std::vector<std::string_view> read_fields(const LineReader& lines, std::size_t count) {
    std::vector<std::string_view> fields = fields_of(lines.line());
    if (fields.size() != count) lines.fail(fmt::format("{} fields instead of {}", fields.size(), count));
    return fields;
}

PathPacket read_packet(const LineReader& lines) {
    if (lines.line().empty()) return {};
    const auto fields = read_fields(lines, 2);
    return {true, read_count(lines, fields[1], "overtaken (0 or 1)") != 0,
            Duration{read_count(lines, fields[0], "delay_ns")}};
}

double share_error(const std::vector<PathPacket>& packets, double share) {
    double squares = 0;
    const std::size_t length = packets.size() / kBatches;
    if (length == 0) return 0;
    for (std::size_t batch = 0; batch < kBatches; ++batch) {
        const auto begin = packets.begin() + static_cast<std::ptrdiff_t>(batch * length);
        const auto count = std::count_if(begin, begin + static_cast<std::ptrdiff_t>(length),
                                         [](const PathPacket& packet) { return packet.overtaken; });
        const double off = static_cast<double>(count) / static_cast<double>(length) - share;
        squares += off * off;
    }
    return std::sqrt(squares / static_cast<double>(kBatches * (kBatches - 1)));
}

constexpr double kErrors = 4;             // standard errors or deviations: 1 in 16,000 by chance
constexpr double kOvertakenErrors = 5;    // of 20 batches each
constexpr double kByChance = 1e-4;        // of the Kolmogorov-Smirnov distance
constexpr std::size_t kFewPackets = 100;  // what follows needs many

using Breaches = std::vector<std::string>;

void unless(Breaches& breaches, bool holds, const std::string& sentence) {
    if (!holds) breaches.push_back(sentence);
}

double ms(double seconds) { return 1e3 * seconds; }

void check_order(Breaches& breaches, const char* who, const PathRequest& asked, const PathSummary& path) {
    unless(breaches, path.copies + path.strangers + path.untrusted == 0,
           fmt::format("{}: {} copies, {} strangers, {} untrusted stamps; none were asked for", who,
                       path.copies, path.strangers, path.untrusted));
    unless(
        breaches, asked.normal_s > 0 || path.overtaken == 0,
        fmt::format("{}: {:.4f} of the packets were overtaken under a constant delay", who, path.overtaken));
}

void check_mean(Breaches& breaches, const char* who, const PathRequest& asked, const PathSummary& path) {
    const double off_s = path.mean_s - asked.delay_s, error_s = kErrors * path.mean_error_s();
    unless(breaches, off_s >= -error_s && off_s <= error_s + kPathCost_s,
           fmt::format("{}: mean {:.4f} ms, asked {:.4f}", who, ms(path.mean_s), ms(asked.delay_s)));
}

void check_spread(Breaches& breaches, const char* who, const PathRequest& asked, const PathSummary& path) {
    if (asked.normal_s > 0) {
        const double error_s = asked.normal_s / std::sqrt(2 * static_cast<double>(path.sorted_s.size()));
        unless(breaches, std::abs(path.deviation_s - asked.normal_s) <= kErrors * error_s,
               fmt::format("{}: standard deviation {:.4f} ms, asked {:.4f}", who, ms(path.deviation_s),
                           ms(asked.normal_s)));
        return;
    }
    const double least_s = path.sorted_s.front(), most_s = path.sorted_s.back();
    unless(breaches, least_s >= asked.delay_s && most_s <= asked.delay_s + kPathMost_s,
           fmt::format("{}: delays from {:.4f} to {:.4f} ms, asked {:.4f} and at most {:.1f} more", who,
                       ms(least_s), ms(most_s), ms(asked.delay_s), ms(kPathMost_s)));
}

void check_loss(Breaches& breaches, const char* who, const PathRequest& asked, const PathSummary& path) {
    const double error = std::sqrt(asked.loss * (1 - asked.loss) / static_cast<double>(path.sent));
    unless(breaches, std::abs(path.loss() - asked.loss) <= kErrors * error,
           fmt::format("{}: {} of {} lost, asked {:.4f}", who, path.lost, path.sent, asked.loss));
}

void check_path(Breaches& breaches, const char* who, const PathRequest& asked, const PathSummary& path) {
    check_order(breaches, who, asked, path);
    check_mean(breaches, who, asked, path);
    check_spread(breaches, who, asked, path);
    check_loss(breaches, who, asked, path);
}

void check_pair(Breaches& breaches, const PathRequest& asked, const PathSummary& kernel,
                const PathSummary& relay) {
    const auto apart = [](double a, double b) { return std::sqrt(a * a + b * b); };
    const auto sent = [](const PathSummary& path) { return static_cast<double>(path.sent); };
    const double mean_error_s = kErrors * apart(kernel.mean_error_s(), relay.mean_error_s());
    unless(breaches, std::abs(kernel.mean_s - relay.mean_s) <= mean_error_s + kPathCost_s,
           fmt::format("means {:.4f} and {:.4f} ms are more than 4 standard errors and {} ms apart",
                       ms(kernel.mean_s), ms(relay.mean_s), ms(kPathCost_s)));
    const double loss_variance = asked.loss * (1 - asked.loss) * (1 / sent(kernel) + 1 / sent(relay));
    unless(breaches, std::abs(kernel.loss() - relay.loss()) <= kErrors * std::sqrt(loss_variance),
           fmt::format("losses {:.4f} and {:.4f} are too far apart", kernel.loss(), relay.loss()));
    unless(breaches,
           std::abs(kernel.overtaken - relay.overtaken) <=
               kOvertakenErrors * apart(kernel.overtaken_error, relay.overtaken_error),
           fmt::format("overtaken {:.4f} and {:.4f}: too far apart", kernel.overtaken, relay.overtaken));
    if (asked.normal_s <= 0) return;  // a constant has no shape: the two differ by their path's cost alone
    const double chance = path_distance_by_chance(kernel.sorted_s.size(), relay.sorted_s.size());
    unless(breaches, path_distance(kernel, relay) <= chance,
           fmt::format("distributions: distance {:.4f}, by chance {:.4f}", path_distance(kernel, relay),
                       chance));
}

std::string row(const std::string& name, const char* who, const PathSummary& path,
                const std::string& compared) {
    return fmt::format(
        "| {} | {} | {:.3f} | {:.3f} | {:.3f} / {:.3f} / {:.3f} / {:.3f} / {:.3f} | {:.2f} | {:.2f} | {} |\n",
        name, who, ms(path.mean_s), ms(path.deviation_s), ms(path.quantile_s(0)), ms(path.quantile_s(0.05)),
        ms(path.quantile_s(0.5)), ms(path.quantile_s(0.95)), ms(path.quantile_s(1)), 100 * path.loss(),
        100 * path.overtaken, compared);
}

}  // namespace

void write_path_sample(const PathSample& sample, const std::string& file) {
    std::string text = fmt::format("{},{},{}\n", sample.copies, sample.strangers, sample.untrusted);
    for (const PathPacket& packet : sample.packets) {
        if (packet.arrived) {
            fmt::format_to(std::back_inserter(text), "{},{:d}", packet.delay.count(), packet.overtaken);
        }
        text += '\n';
    }
    write_text_file(file, text);
}

PathSample read_path_sample(const std::string& file) {
    const std::string text = read_whole_file(file);
    LineReader lines(text, file);
    if (!lines.next()) fail_at_line(file, 1, "empty; kernel_path_peer measure writes such files");
    const auto counts = read_fields(lines, 3);
    PathSample sample;
    sample.copies = static_cast<std::uint64_t>(read_count(lines, counts[0], "copies"));
    sample.strangers = static_cast<std::uint64_t>(read_count(lines, counts[1], "strangers"));
    sample.untrusted = static_cast<std::uint64_t>(read_count(lines, counts[2], "untrusted"));
    while (lines.next()) sample.packets.push_back(read_packet(lines));
    return sample;
}

double PathSummary::quantile_s(double q) const {
    if (sorted_s.empty()) return 0;
    return sorted_s[static_cast<std::size_t>(q * static_cast<double>(sorted_s.size() - 1))];
}

double PathSummary::mean_error_s() const {
    return sorted_s.empty() ? 0 : deviation_s / std::sqrt(static_cast<double>(sorted_s.size()));
}

PathSummary summarise(const PathSample& sample) {
    PathSummary summary;
    summary.sent = sample.packets.size();
    summary.copies = sample.copies;
    summary.strangers = sample.strangers;
    summary.untrusted = sample.untrusted;
    std::size_t overtaken = 0;
    double sum_s = 0, squares_s2 = 0;
    for (const PathPacket& packet : sample.packets) {
        if (packet.arrived) summary.sorted_s.push_back(to_seconds(packet.delay));
        overtaken += packet.overtaken ? 1U : 0U;
    }
    std::sort(summary.sorted_s.begin(), summary.sorted_s.end());
    const auto arrived = static_cast<double>(summary.sorted_s.size());
    summary.lost = summary.sent - summary.sorted_s.size();
    if (summary.sorted_s.empty()) return summary;
    for (const double delay_s : summary.sorted_s) sum_s += delay_s;
    summary.mean_s = sum_s / arrived;
    for (const double delay_s : summary.sorted_s) {
        squares_s2 += (delay_s - summary.mean_s) * (delay_s - summary.mean_s);
    }
    summary.deviation_s = std::sqrt(squares_s2 / std::max(1.0, arrived - 1));
    summary.overtaken = static_cast<double>(overtaken) / static_cast<double>(summary.sent);
    summary.overtaken_error = share_error(sample.packets, summary.overtaken);
    return summary;
}

double path_distance(const PathSummary& a, const PathSummary& b) {
    std::vector<double> a_s = a.sorted_s, b_s = b.sorted_s;
    return ks_distance(a_s, b_s);
}

// Asymptotic: P(D > d) = 2 exp(-2 d^2 n m / (n + m)), first term (Smirnov, Annals of Mathematical Statistics 19, 1948).
double path_distance_by_chance(std::size_t a, std::size_t b) {
    const auto n = static_cast<double>(a), m = static_cast<double>(b);
    return std::sqrt(-0.5 * std::log(kByChance / 2) * (n + m) / (n * m));
}

std::vector<std::string> disagreements(const PathRequest& asked, const PathSummary& kernel,
                                       const PathSummary& relay) {
    Breaches breaches;
    const bool enough = kernel.sorted_s.size() >= kFewPackets && relay.sorted_s.size() >= kFewPackets;
    unless(breaches, enough,
           fmt::format("only {} and {} packets arrived, too few to compare", kernel.sorted_s.size(),
                       relay.sorted_s.size()));
    if (enough) {
        check_path(breaches, "kernel", asked, kernel);
        check_path(breaches, "thimble-netem", asked, relay);
        check_pair(breaches, asked, kernel, relay);
    }
    return breaches;
}

std::string path_table_head() {
    return "| profile | by | mean, ms | sd, ms | least / 5 % / median / 95 % / most, ms | lost, % | "
           "overtaken, % | KS "
           "distance (by chance) |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
}

std::string path_table_rows(const std::string& name, const PathRequest& asked, const PathSummary& kernel,
                            const PathSummary& relay) {
    const double chance = path_distance_by_chance(kernel.sorted_s.size(), relay.sorted_s.size());
    const std::string compared =
        asked.normal_s > 0 ? fmt::format("{:.4f} ({:.4f})", path_distance(kernel, relay), chance) : "";
    return row(name, "kernel", kernel, "") + row("", "thimble-netem", relay, compared);
}

}  // namespace thimble
