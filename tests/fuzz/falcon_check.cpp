#include "master/devices/falcon/falcon_kinematics.hpp"
#include "master/devices/falcon/falcon_packet.hpp"
#include "tests/fuzz/checks.hpp"

namespace thimble {
namespace {

const char* flaw_of(const FalconReport& report) {
    const auto again = decode_falcon_report(encode(report));
    if (!again || again->encoders != report.encoders || again->buttons != report.buttons ||
        again->homed_legs != report.homed_legs)
        return "a report that cannot be said again";
    FalconAngles angles_rad{};
    for (std::size_t leg = 0; leg < 3; ++leg) angles_rad[leg] = falcon_leg_angle_rad(report.encoders[leg]);
    const auto position_m = falcon_position_m(angles_rad);
    if (!position_m) return nullptr;
    for (const double component_m : *position_m) {
        if (!(component_m > -0.3 && component_m < 0.3)) return "a position outside any arm's reach";
    }
    const auto torques_Nm = falcon_leg_torques_Nm(*position_m, {1, 1, 1});
    if (!torques_Nm) return nullptr;
    for (const std::int16_t counts : falcon_motors(*torques_Nm, 10000).counts) {
        if (counts < -kFalconMotorLimit || counts > kFalconMotorLimit) return "a motor beyond its limit";
    }
    return nullptr;
}

}  // namespace

Verdict check_falcon(Bytes input) {
    if (input.empty()) return {};
    const Bytes bytes = input.subspan(1);
    const std::size_t cut = bytes.empty() ? 0 : input[0] % (bytes.size() + 1);
    FalconReportReader whole, parts;
    const auto newest = whole.take(bytes);
    parts.take(bytes.first(cut));
    parts.take(bytes.subspan(cut));
    if (whole.reports() != parts.reports()) return {true, "cutting matters"};
    if (whole.reports() * kFalconPacketBytes > bytes.size()) return {true, "more than there was"};
    const char* flaw = newest ? flaw_of(*newest) : nullptr;
    return {newest.has_value(), flaw != nullptr ? flaw : ""};
}

}  // namespace thimble
