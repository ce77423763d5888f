#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

#include "common/error.hpp"
#include "netem/formats/jitter_table_file.hpp"
#include "netem/formats/path_fit.hpp"
#include "netem/formats/tc_text.hpp"
#include "netem/formats/trace_files.hpp"
#include "netem/import/importers.hpp"
#include "netem/link_model.hpp"
#include "netem/profiles/profiles.hpp"
#include "netem/shell/ip_packet.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

constexpr const char* kNetworkName = "fuzz.txt";

bool is_share(double value) { return value >= 0 && value <= 1; }

std::string flaw_of_link(const LinkSettings& link) {
    constexpr Duration kMinute = std::chrono::seconds{60};
    if (link.delay < Duration::zero() || link.delay > kMinute) return "a delay out of its range";
    if (link.jitter.spread < Duration::zero() || link.jitter.spread > kMinute)
        return "a spread out of its range";
    if (!(link.jitter.correlation >= 0 && link.jitter.correlation < 1))
        return "a correlation out of its range";
    if (link.jitter.shape == JitterShape::kTable && !link.jitter.table) return "no table";
    const double loss = stationary_loss(link.loss);
    if (!is_share(loss)) return fmt::format("a loss of {}", loss);
    for (const double share : {link.duplicate, link.corrupt, link.reorder}) {
        if (!is_share(share)) return "a share out of its range";
    }
    if (!(link.rate.bits_per_s >= 0 && link.rate.bits_per_s <= 1e12)) return "a rate out of its range";
    // A distribution of slots may be wider than its mean: what it has below 0 has no length.
    if (link.slot.least > link.slot.most || link.slot.least < -kMinute) return "slots out of their range";
    if (link.capacity < 1 || link.capacity > 1'000'000) return "a capacity out of its range";
    return "";
}

// Some packets through it: nothing may break, and none may be lost sight of.
std::string flaw_of_model(LinkSettings link) {
    link.capacity = std::min<std::size_t>(link.capacity, 1000);  // memory is not what is tested here
    LinkModel model(link, StreamKey{}, 0);
    const std::uint8_t packet[60]{};
    for (int i = 0; i < 20; ++i) model.push(SessionTime{std::chrono::milliseconds{i}}, packet);
    return model.counters().pushed == 20 ? "" : "packets that were not counted";
}

Verdict check_words(std::string_view text) {
    const auto no_tables = [](std::string_view) -> std::shared_ptr<const JitterTable> {
        throw Error(ExitCode::kUsage, "tc words: no tables here");
    };
    const LinkSettings link = parse_tc(text, no_tables).up;
    std::string flaw = flaw_of_link(link);
    if (flaw.empty()) flaw = flaw_of_model(link);
    const TcCommands printed = print_tc(link, "eth0");
    LinkSettings again = parse_tc(printed.words, no_tables).up;
    again.in_order = link.in_order;  // "unordered" is no word of tc's
    if (flaw.empty() && !(again == link)) flaw = "changes when printed and read again: " + printed.words;
    return {true, flaw};
}

Verdict check_table(std::string_view text) {
    const JitterTable table = parse_jitter_table(text, kNetworkName);
    const auto& deviates = table.deviates();
    if (!std::is_sorted(deviates.begin(), deviates.end())) return {true, "a table that is not sorted"};
    const JitterTable again =
        parse_jitter_table(print_jitter_table(table, "again", deviates.size()), kNetworkName);
    return {true,
            again.deviates() == deviates ? "" : "a table that changes when it is written and read again"};
}

std::string flaw_of_path(const MeasuredPath& path) {
    if (path.packets.empty()) return "a path without packets";
    for (std::size_t i = 0; i < path.packets.size(); ++i) {
        const MeasuredPacket& packet = path.packets[i];
        if (packet.at < 0 || (i > 0 && packet.at <= path.packets[i - 1].at))
            return "packets that do not follow";
        if (packet.delay && (*packet.delay < Duration::zero() || *packet.delay > kLongestPathDelay)) {
            return "a delay out of its range";
        }
        if (!is_share(packet.loss)) return "a loss out of its range";
        if (path.has_rate && !(packet.bits_per_s >= 1)) return "no rate";
    }
    MeasuredPath again = parse_path(print_path(path), kNetworkName);
    if (again.packets != path.packets) return "a path that changes when it is written and read again";
    const PacketTrace trace = to_trace(path, {}, kNetworkName);
    if (trace.rows().size() != path.packets.size()) return "a trace that lost packets";
    trace.at(path.packets.back().at * 2 + 1);
    if (path.packets.size() < 2) return "";
    return flaw_of_link(fit_path(path).link);
}

Verdict check_trace(std::string_view text) { return {true, flaw_of_path(parse_path(text, kNetworkName))}; }

Verdict check_ping(std::string_view text) {
    return {true, flaw_of_path(parse_ping(text, kNetworkName, std::chrono::seconds{1}))};
}

Verdict check_deliveries(std::string_view text) {
    const DeliveryTrace trace = parse_delivery_trace(text, kNetworkName);
    const bool sorted = std::is_sorted(trace.times_ms().begin(), trace.times_ms().end());
    return {true, sorted ? "" : "a trace whose times fall"};
}

// A capture against itself: nothing is lost, nothing takes time.
Verdict check_capture(std::string_view bytes) {
    const Capture capture = parse_capture(bytes, kNetworkName);
    if (capture.datagrams.empty()) return {true, ""};
    const CapturePair pair = match_captures(capture, capture, {});
    if (pair.lost + pair.duplicates + pair.foreign + pair.reordered != 0)
        return {true, "differs from itself"};
    if (pair.least != Duration::zero() || pair.most != Duration::zero())
        return {true, "is later than itself"};
    return {true, flaw_of_path(pair.path)};
}

Verdict check_irtt(std::string_view text) {
    const MeasuredPaths paths = parse_irtt(text, kNetworkName);
    const std::string flaw = flaw_of_path(paths.up);
    return {true, flaw.empty() ? flaw_of_path(paths.down) : flaw};
}

Verdict check_profile(std::string_view text) {
    const auto no_files = [](std::string_view name) -> std::string {
        throw Error(ExitCode::kUsage, fmt::format("{}: no file {}", kNetworkName, name));
    };
    const LinkProfile profile = parse_profile(text, kNetworkName, no_files);
    for (const LinkSettings* link : {&profile.up, &profile.down}) {
        std::string flaw = flaw_of_link(*link);
        if (flaw.empty()) flaw = flaw_of_model(*link);
        if (!flaw.empty()) return {true, flaw};
        print_tc(*link, "eth0");
    }
    const LinkProfile again = parse_profile(print_profile(profile), kNetworkName, no_files);
    return {true, again.up.delay == profile.up.delay && again.down.rate == profile.down.rate
                      ? ""
                      : "a profile that changes when it is written and read again"};
}

// Every span lies in the frame, and the parts of what is carried are there.
Verdict check_ip_packet(std::string_view text) {
    const Bytes frame = bytes_of_text(text);
    for (const Bytes bytes : {frame, ip_of_frame(frame)}) {
        const IpPacket packet = read_ip_packet(bytes);
        if (packet.kind == IpKind::kGarbage) continue;
        const bool inside =
            packet.bytes.data() == bytes.data() && packet.bytes.size() <= bytes.size() &&
            packet.destination.size() == (packet.v6 ? 16U : 4U) &&
            packet.destination.data() + packet.destination.size() <= bytes.data() + bytes.size();
        return {true, inside ? "" : "a part outside of the packet"};
    }
    return {};
}

// By the first byte.
constexpr std::array<Verdict (*)(std::string_view), kNetworkReaders> kNetworkChecks{
    check_words, check_table, check_trace,   check_deliveries, check_capture,
    check_irtt,  check_ping,  check_profile, check_ip_packet};

std::string flaw_of_network_refusal(const Error& error, unsigned reader) {
    const bool typed = reader == 0 || reader == 7;  // by a person, in a command line or a configuration
    if (error.code() != (typed ? ExitCode::kUsage : ExitCode::kData)) return "an Error of the wrong kind";
    const std::string_view what = error.what();
    const std::string_view begin = reader == 0 ? "tc words: " : kNetworkName;
    // The fault of a pair of captures, or of a fit, is not in one file.
    if (reader != 4 && what.substr(0, begin.size()) != begin)
        return fmt::format("does not say where: {}", what);
    return what.size() > begin.size() + 2 ? "" : "an Error that says nothing";
}

}  // namespace

Verdict check_network_files(Bytes bytes) {
    if (bytes.empty()) return {};
    const unsigned reader = bytes.front() % 16U % kNetworkReaders;  // '0' is 0
    try {
        return kNetworkChecks[reader](text_of(bytes.subspan(1)));
    } catch (const Error& error) {
        return {false, flaw_of_network_refusal(error, reader)};
    }
}

}  // namespace thimble
