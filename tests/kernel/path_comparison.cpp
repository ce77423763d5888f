#include "tests/kernel/path_comparison.hpp"

#include <cmath>

#include <fmt/format.h>

#include "netem/relay/selftest_twin.hpp"

namespace thimble {
namespace {

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
