#include "netem/formats/path_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>

#include "common/error.hpp"
#include "common/math/portable.hpp"
#include "common/math/real.hpp"
#include "netem/link_model.hpp"
#include "netem/link_reader.hpp"
#include "netem/stages/delay_shape.hpp"

namespace thimble {
namespace {

using Normal = boost::math::normal_distribution<portable::Real, portable::InReal>;

constexpr double kMemoryG = 10.83;      // quantile 0.999 of chi squared with one degree of freedom
constexpr double kFlatSpread_s = 1e-9;  // below what a stamp can tell
constexpr std::array kFitted{JitterShape::kUniform, JitterShape::kNormal, JitterShape::kGamma,
                             JitterShape::kPareto, JitterShape::kParetoNormal};

// Pareto is a name, with a capital letter.
std::string name_of(JitterShape shape) {
    std::string name(to_string(shape));
    if (name.front() == 'p') name.front() = 'P';
    return name;
}

bool is_received(const MeasuredPacket& packet) { return packet.delay && packet.loss < 1; }

std::vector<double> delays_s_of(const MeasuredPath& path) {
    std::vector<double> delays_s;
    for (const MeasuredPacket& packet : path.packets) {
        if (is_received(packet)) delays_s.push_back(to_seconds(*packet.delay));
    }
    return delays_s;
}

// The shape's distribution function over deviates in rising order, by walking its quantile function once.
class ShapeCurve {
  public:
    ShapeCurve(const JitterSettings& jitter, Duration delay) : shape_(jitter, delay) {
        for (int i = -kSteps; i <= kSteps; ++i) deviates_.push_back(shape_.at_normal(z_of(i)));
    }
    double share_below(double deviate) {
        while (next_ + 1 < deviates_.size() && deviates_[next_ + 1] < deviate) ++next_;
        if (deviate <= deviates_[next_]) return next_ == 0 ? 0 : share_at(static_cast<double>(next_));
        if (next_ + 1 == deviates_.size()) return 1;
        const double rise = deviates_[next_ + 1] - deviates_[next_];
        return share_at(static_cast<double>(next_) + (deviate - deviates_[next_]) / rise);
    }

  private:
    static constexpr int kSteps = 2000;
    static constexpr double kReach = 5;
    static double z_of(double step) { return kReach * step / kSteps; }
    static double share_at(double index) {
        return static_cast<double>(boost::math::cdf(Normal(), portable::Real(z_of(index - kSteps))));
    }

    DelayShape shape_;
    std::vector<double> deviates_;
    std::size_t next_ = 0;
};

Duration spread_of(JitterShape shape, double sd_s) {
    return from_seconds(shape == JitterShape::kUniform ? std::sqrt(3.0) * sd_s : sd_s);
}

double ks_distance(const std::vector<double>& sorted_s, JitterShape shape, double mean_s, double sd_s) {
    const Duration spread = spread_of(shape, sd_s);
    ShapeCurve curve({.shape = shape, .spread = spread}, from_seconds(mean_s));
    const double n = static_cast<double>(sorted_s.size());
    double distance = 0;
    for (std::size_t i = 0; i < sorted_s.size();) {
        const double share = curve.share_below((sorted_s[i] - mean_s) / to_seconds(spread));
        const std::size_t first = i;
        while (i < sorted_s.size() && sorted_s[i] == sorted_s[first]) ++i;  // ping prints few digits
        distance =
            std::max({distance, share - static_cast<double>(first) / n, static_cast<double>(i) / n - share});
    }
    return distance;
}

// Of successive received packets, in normal scores of their ranks; ties share the mean of their ranks.
double lag_one_correlation(const MeasuredPath& path, const std::vector<double>& sorted_s) {
    const double n = static_cast<double>(sorted_s.size());
    const auto score = [&](const MeasuredPacket& packet) {
        const auto [low, high] =
            std::equal_range(sorted_s.begin(), sorted_s.end(), to_seconds(*packet.delay));
        const auto ranks = (low - sorted_s.begin()) + (high - sorted_s.begin());
        const portable::Real share = static_cast<double>(ranks) / 2 / n;
        return static_cast<double>(boost::math::quantile(Normal(), share));
    };
    double products = 0, squares = 0, pairs = 0;
    std::optional<double> before;
    for (const MeasuredPacket& packet : path.packets) {
        const auto now = is_received(packet) ? std::optional(score(packet)) : std::nullopt;
        squares += now ? *now * *now : 0;
        products += now && before ? *now * *before : 0;
        pairs += now && before ? 1 : 0;
        before = now;
    }
    return pairs > 1 && squares > 0 ? products / pairs / (squares / n) : 0;
}

void fit_delay(const MeasuredPath& path, PathFit& fit) {
    std::vector<double> sorted_s = delays_s_of(path);
    if (sorted_s.empty()) return;
    std::sort(sorted_s.begin(), sorted_s.end());
    const double n = static_cast<double>(sorted_s.size());
    fit.delay_mean_s = std::accumulate(sorted_s.begin(), sorted_s.end(), 0.0) / n;
    double squares_s2 = 0;
    for (const double delay_s : sorted_s)
        squares_s2 += (delay_s - fit.delay_mean_s) * (delay_s - fit.delay_mean_s);
    fit.delay_sd_s = sorted_s.size() > 1 ? std::sqrt(squares_s2 / (n - 1)) : 0;
    fit.delay_least_s = sorted_s.front();
    fit.delay_most_s = sorted_s.back();
    fit.delay_99_s = sorted_s[std::min(sorted_s.size() - 1, static_cast<std::size_t>(0.99 * n))];
    fit.link.delay = from_seconds(fit.delay_mean_s);
    if (fit.delay_sd_s < kFlatSpread_s) return;
    for (const JitterShape shape : kFitted) {
        const Duration spread = spread_of(shape, fit.delay_sd_s);
        if (least_mean_in_spreads({.shape = shape, .spread = spread}) * to_seconds(spread) > fit.delay_mean_s)
            continue;
        fit.shapes.push_back({shape, ks_distance(sorted_s, shape, fit.delay_mean_s, fit.delay_sd_s)});
    }
    if (fit.shapes.empty()) return;
    std::stable_sort(fit.shapes.begin(), fit.shapes.end(),
                     [](const ShapeFit& a, const ShapeFit& b) { return a.distance < b.distance; });
    fit.correlation = lag_one_correlation(path, sorted_s);
    fit.link.jitter.shape = fit.shapes.front().shape;
    fit.link.jitter.spread = spread_of(fit.link.jitter.shape, fit.delay_sd_s);
    // A correlation within two standard errors of zero counts as zero, because each correlated packet costs time.
    const bool notable = fit.correlation > 2 / std::sqrt(n);
    fit.link.jitter.correlation = notable ? std::round(std::min(fit.correlation, 0.999) * 1000) / 1000 : 0;
}

// Counts arrivals in the order of sending. Without times of sending there is no order to see.
std::size_t count_reordered(const MeasuredPath& path) {
    if (path.by_packet) return 0;
    std::size_t reordered = 0;
    std::int64_t latest = INT64_MIN;
    for (const MeasuredPacket& packet : path.packets) {
        if (!is_received(packet)) continue;
        const std::int64_t arrival = packet.at + packet.delay->count();
        reordered += arrival < latest ? 1 : 0;
        latest = std::max(latest, arrival);
    }
    return reordered;
}

// The same packets on a link with the jitter that was fitted and no order to keep.
std::size_t count_overtaking(const MeasuredPath& path, LinkSettings link) {
    link.in_order = false;
    link.loss = {};
    link.capacity = std::max<std::size_t>(1, path.packets.size());
    LinkModel model(link, StreamKey{}, 0);
    constexpr std::array<std::uint8_t, 1> kByte{};
    for (const MeasuredPacket& packet : path.packets) {
        if (!is_received(packet)) continue;
        const SessionTime now = from_nanoseconds(packet.at);
        while (!model.pop_due(now).empty()) {
        }
        model.push(now, kByte);
    }
    while (model.next_due() != kNever) model.pop_due(model.next_due());
    return model.counters().reordered;
}

// If packets overtook far less often than the fitted jitter would cause, the jitter is of another kind and the order
// is kept.
void fit_order(const MeasuredPath& path, PathFit& fit) {
    fit.reordered = count_reordered(path);
    if (fit.reordered == 0 || fit.link.jitter.shape == JitterShape::kNone) return;
    fit.would_overtake = count_overtaking(path, fit.link);
    fit.link.in_order = 2 * fit.reordered <= fit.would_overtake;
}

// Numbers of pairs of successive packets.
struct Transitions {
    double stay_received = 0, to_lost = 0, to_received = 0, stay_lost = 0;
};

double log_likelihood(double hits, double of, double probability) {
    const double misses = of - hits;
    return (hits > 0 ? hits * portable::log(probability) : 0) +
           (misses > 0 ? misses * portable::log(1 - probability) : 0);
}

double likelihood_ratio(const Transitions& t) {
    const double from_received = t.stay_received + t.to_lost, from_lost = t.to_received + t.stay_lost;
    const double lost = t.to_lost + t.stay_lost, all = from_received + from_lost;
    if (from_received <= 0 || from_lost <= 0 || lost <= 0 || lost >= all) return 0;
    return 2 * (log_likelihood(t.to_lost, from_received, t.to_lost / from_received) +
                log_likelihood(t.stay_lost, from_lost, t.stay_lost / from_lost) -
                log_likelihood(lost, all, lost / all));
}

Transitions count_losses(const MeasuredPath& path, PathFit& fit) {
    Transitions transitions;
    std::size_t burst = 0, bursts = 0;
    for (const MeasuredPacket& packet : path.packets) {
        const bool lost = packet.loss >= 0.5;
        if (&packet != path.packets.data()) {
            (burst > 0 ? (lost ? transitions.stay_lost : transitions.to_received)
                       : (lost ? transitions.to_lost : transitions.stay_received)) += 1;
        }
        fit.lost += lost ? 1 : 0;
        bursts += lost && burst == 0 ? 1 : 0;
        burst = lost ? burst + 1 : 0;
        fit.longest_burst = std::max(fit.longest_burst, burst);
    }
    fit.mean_burst = bursts > 0 ? static_cast<double>(fit.lost) / static_cast<double>(bursts) : 0;
    return transitions;
}

void fit_loss(const MeasuredPath& path, PathFit& fit) {
    fit.packets = path.packets.size();
    const Transitions t = count_losses(path, fit);
    if (fit.lost == 0) return;
    fit.loss_g = likelihood_ratio(t);
    const double share = static_cast<double>(fit.lost) / static_cast<double>(fit.packets);
    const bool in_bursts = fit.loss_g > kMemoryG && t.stay_lost / (t.to_received + t.stay_lost) > share;
    LossSettings& loss = fit.link.loss;
    if (!in_bursts) {
        loss = LossSettings::independent(share);
        return;
    }
    // The only burst is cut at one end. A chain that never enters or leaves the bad state would lose none or all.
    if (t.to_lost == 0) fit.burst_cut_at = "beginning";
    if (t.to_received == 0) fit.burst_cut_at = "end";
    if (!fit.burst_cut_at.empty() || fit.mean_burst > kLongestBurst) {
        loss = LossSettings::gilbert(share, std::min(fit.mean_burst, kLongestBurst));
        return;
    }
    loss.shape = LossShape::kGilbertElliott;
    loss.good_to_bad = t.to_lost / (t.stay_received + t.to_lost);
    loss.bad_to_good = t.to_received / (t.to_received + t.stay_lost);
}

void describe_order(PathFit& fit) {
    if (fit.reordered == 0) return;
    const std::string seen = fmt::format("{} packets arrive after one that was sent later", fit.reordered);
    if (fit.link.jitter.shape == JitterShape::kNone) {
        return fit.sentences.push_back(seen +
                                       "; a profile without jitter has none of these: replay the trace.");
    }
    fit.sentences.push_back(fmt::format(
        "{}; a link with this jitter that does not keep the order has {}, so the profile {}.", seen,
        fit.would_overtake, fit.link.in_order ? "keeps their order" : "lets packets overtake each other"));
}

std::string verdict_on(double distance) {
    if (distance < 0.03) return "which is close";
    if (distance < 0.08) return "which is fair; replay the trace if the exact distribution matters";
    return "which is poor: replay the trace itself, or use its table (--table)";
}

void describe_delay(PathFit& fit) {
    if (fit.delay_mean_s == 0 && fit.shapes.empty()) {
        fit.sentences.push_back("There are no delays in this path.");
        return;
    }
    fit.sentences.push_back(
        fmt::format("Delay {:.6g} s in the mean, standard deviation {:.3g} s, from {:.6g} to {:.6g} s, 99 % "
                    "below {:.6g} s.",
                    fit.delay_mean_s, fit.delay_sd_s, fit.delay_least_s, fit.delay_most_s, fit.delay_99_s));
    if (fit.delay_sd_s < kFlatSpread_s) return fit.sentences.push_back("It does not vary.");
    if (fit.shapes.empty()) {
        return fit.sentences.push_back(
            "Most of it is near 0 and a few packets are far from that: no distribution fits; replay the "
            "trace.");
    }
    std::string line = fmt::format(
        "The {} shape fits best: its distribution differs by at most {:.1f} % of the packets "
        "(Kolmogorov-Smirnov distance), {}. The others:",
        name_of(fit.shapes[0].shape), 100 * fit.shapes[0].distance, verdict_on(fit.shapes[0].distance));
    for (std::size_t i = 1; i < fit.shapes.size(); ++i) {
        line += fmt::format("{} {} {:.1f} %", i == 1 ? "" : ",", name_of(fit.shapes[i].shape),
                            100 * fit.shapes[i].distance);
    }
    fit.sentences.push_back(line + '.');
    fit.sentences.push_back(fmt::format("Successive delays correlate by {:.3f} (normal scores, lag 1){}.",
                                        fit.correlation,
                                        fit.link.jitter.correlation > 0 ? "" : ", treated as none"));
}

// How many losses in a row a chain with these parameters would show at most, in so many bursts: geometric.
double expected_longest(double bursts, double bad_to_good) {
    if (bad_to_good >= 1 || bursts < 1) return 1;
    return 1 + portable::log(bursts) / -portable::log(1 - bad_to_good);
}

void describe_loss(PathFit& fit) {
    if (fit.lost == 0) {
        // The largest share that would leave no loss in so many packets once in twenty times ("rule of three").
        fit.sentences.push_back(
            fmt::format("None of {} packets was lost, so less than {:.3g} % is (95 % confidence).",
                        fit.packets, 300.0 / static_cast<double>(fit.packets)));
        return;
    }
    fit.sentences.push_back(
        fmt::format("{} of {} packets lost ({:.4g} %), {:.2f} in a row in the mean, {} at most.", fit.lost,
                    fit.packets, 100.0 * static_cast<double>(fit.lost) / static_cast<double>(fit.packets),
                    fit.mean_burst, fit.longest_burst));
    const LossSettings& loss = fit.link.loss;
    if (loss.shape != LossShape::kGilbertElliott) {
        fit.sentences.push_back(
            fmt::format("They look independent of one another (G = {:.1f}; {} or less is by chance).",
                        fit.loss_g, kMemoryG));
        return;
    }
    if (!fit.burst_cut_at.empty()) {
        fit.sentences.push_back(fmt::format(
            "They are one burst that the path cuts off at its {} (G = {:.1f}, by chance up to {}): Gilbert "
            "model with its share and a mean burst of {}, which is a lower bound; measure for longer.",
            fit.burst_cut_at, fit.loss_g, kMemoryG, fit.lost));
        return;
    }
    const double bursts = static_cast<double>(fit.lost) / fit.mean_burst;
    const double expected = expected_longest(bursts, loss.bad_to_good);
    fit.sentences.push_back(fmt::format(
        "They come in bursts (G = {:.1f}, by chance up to {}): Gilbert model, p = {:.4g}, r = {:.4g}. Of "
        "{:.0f} bursts its longest has about {:.0f} packets; here it is {}{}.",
        fit.loss_g, kMemoryG, loss.good_to_bad, loss.bad_to_good, bursts, expected, fit.longest_burst,
        static_cast<double>(fit.longest_burst) > 2 * expected + 2
            ? ", so some bursts are of another kind: write them as outages, or replay the trace"
            : ""));
}

}  // namespace

void require_fates(const MeasuredPath& path, const std::string& file) {
    for (const MeasuredPacket& packet : path.packets) {
        if (packet.loss > 0 && packet.loss < 1)
            throw Error(ExitCode::kData,
                        "{}: loss holds probabilities (such as {}), not fates of packets, which are 0 or 1: "
                        "replay this trace with trace = \"{}\"",
                        file, packet.loss, file);
    }
}

PathFit fit_path(const MeasuredPath& path) {
    PathFit fit;
    fit_delay(path, fit);
    fit_loss(path, fit);
    if (path.packets.size() < 2) {
        throw Error(ExitCode::kData, "a fit needs at least two packets; measure for longer");
    }
    make_room_for_delay(fit.link);  // as a session file without the key does
    fit_order(path, fit);
    describe_delay(fit);
    describe_order(fit);
    describe_loss(fit);
    return fit;
}

std::vector<double> standardised_delays(const MeasuredPath& path) {
    std::vector<double> deviates = delays_s_of(path);
    const PathFit fit = fit_path(path);
    if (fit.delay_sd_s < kFlatSpread_s)
        throw Error(ExitCode::kData, "the delay does not vary: there is no table to make");
    for (double& deviate : deviates) deviate = (deviate - fit.delay_mean_s) / fit.delay_sd_s;
    std::sort(deviates.begin(), deviates.end());
    return deviates;
}

}  // namespace thimble
