#include <algorithm>
#include <cmath>

#include "cutaneous_node/board/board_reports.hpp"
#include "master/devices/hid/hid_axes.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

std::string flaw_of_layout(const HidLayout& layout) {
    if (layout.fields.size() > 256) return "more fields than there may be";
    if (layout.applications.size() > 16) return "more applications than there may be";
    for (const HidField& field : layout.fields) {
        if (field.bits == 0 || field.bits > 32) return "a field of no bits or of more than 32";
        if (field.minimum >= field.maximum) return "a field without a range";
    }
    return "";
}

std::string flaw_of_axes(const HidAxes& axes) {
    for (const double value : axes.values())
        if (!std::isfinite(value) || std::fabs(value) > 1) return "an axis beyond its ends";
    return "";
}

// An accepted report is the one that would be sent for it, except for bits without a meaning.
std::string flaw_of_board(Bytes report) {
    const auto status = decode_board_status(report);
    if (status && decode_board_command(report)) return "a report that is both of the board's";
    if (!status) return "";
    const auto again = decode_board_status(encode(*status));
    const bool same = again && again->sequence == status->sequence && again->fault == status->fault &&
                      again->index_mN == status->index_mN && again->thumb_mN == status->thumb_mN &&
                      again->pressing == status->pressing && again->watchdog == status->watchdog;
    return same ? "" : "a status that does not come back";
}

void read_reports(HidAxes axes, Bytes bytes, std::size_t length, Verdict& verdict) {
    while (!bytes.empty() && verdict.flaw.empty()) {
        const auto report = bytes.first(std::min(length, bytes.size()));
        bytes = bytes.subspan(report.size());
        axes.take(report);
        verdict.flaw = flaw_of_axes(axes);
        if (verdict.flaw.empty()) verdict.flaw = flaw_of_board(report);
    }
}

}  // namespace

Verdict check_hid(Bytes bytes) {
    Verdict verdict;
    if (bytes.empty()) return verdict;
    const std::size_t length = std::min<std::size_t>(bytes[0], bytes.size() - 1);
    const auto descriptor = bytes.subspan(1, length), reports = bytes.subspan(1 + length);
    read_reports(HidAxes::of_spacemouse(), reports, std::max<std::size_t>(length, 1), verdict);
    read_reports(HidAxes::of_spacemouse(), reports, 10, verdict);
    const auto layout = parse_report_descriptor(descriptor);
    verdict.accepted = layout.has_value();
    if (!layout || !verdict.flaw.empty()) return verdict;
    verdict.flaw = flaw_of_layout(*layout);
    const auto axes = HidAxes::described_by(*layout);
    if (axes && verdict.flaw.empty()) read_reports(*axes, reports, 10, verdict);
    return verdict;
}

}  // namespace thimble
