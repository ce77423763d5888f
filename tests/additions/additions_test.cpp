// The parts that examples/additions add, beside the element (element_test.cpp): each is read from a file by its name, and works.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "analysis/findings.hpp"
#include "common/control/controller_ends.hpp"
#include "common/error.hpp"
#include "common/runtime/sockets.hpp"
#include "cutaneous_node/open_actuator.hpp"
#include "master/devices/handle.hpp"
#include "netem/link_model.hpp"
#include "netem/link_reader.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

SessionTime at(double time_s) { return SessionTime{} + from_seconds(time_s); }

TEST(Additions, AHandleMovesByItself) {
    const ConfigFile file =
        ConfigFile::parse("[handle]\ndevice = 'metronome'\nforce_limit_N = 4\n", "h.toml");
    const HandleSettings settings = read_handle_settings(file.table("handle"));
    file.finish();
    EXPECT_FALSE(is_real(settings.kind));
    const std::shared_ptr<Handle> handle = open_handle(settings, {}, {});
    handle->start_trial(at(7), {});
    EXPECT_NEAR(handle->read(at(7.25)).position_hand_m, 0.005, 1e-12);
    EXPECT_NEAR(handle->read(at(7.75)).position_hand_m, 0.005, 1e-12);
    handle->command_force(at(8), 9);
    EXPECT_EQ(handle->read(at(8)).force_hand_N, 0);
    handle->enable_force(at(8), true);
    handle->command_force(at(8), 9);
    EXPECT_EQ(handle->read(at(8)).force_hand_N, 4);
}

TEST(Additions, AnActuatorPressesAtOnce) {
    const ConfigFile file =
        ConfigFile::parse("[cutaneous]\ndevice = 'instant'\nforce_limit_N = 2\n", "a.toml");
    const CutaneousSettings settings = read_cutaneous_settings(file.table("cutaneous"));
    file.finish();
    NetworkSettings network;
    network.security.mode = SecurityMode::kNone;
    Sockets sockets(network);
    const OpenActuator opened = open_actuator(settings, {}, sockets);
    FingertipActuator& actuator = *opened.actuator;
    actuator.command(at(1), Finger::kThumb, 3);
    EXPECT_EQ(actuator.output(at(1)).finger, Finger::kThumb);
    EXPECT_EQ(actuator.output(at(1)).force_N, 2);
    actuator.command(at(2), Finger::kThumb, std::nan(""));
    EXPECT_EQ(actuator.output(at(2)).finger, Finger::kNone);
}

TEST(Additions, ACompensatorTrustsOldForcesLess) {
    const ConfigFile file =
        ConfigFile::parse("[control]\ncompensator = 'age-scaled'\nage_trust_s = 0.01\n", "c.toml");
    const ControlSettings settings = read_control_settings(file);
    file.finish();
    EXPECT_EQ(kCompensatorNames.at(static_cast<std::size_t>(settings.compensator)), "age-scaled");
    HandleEnd end(settings, {});
    end.start(from_seconds(0.1));
    end.sample(at(1), 0.01, 0, 0);
    thimble_feedback feedback{};
    feedback.force_total_hand_N = 6;
    feedback.age_s = 0.02;
    feedback.known = 1;
    end.receive(feedback);
    EXPECT_NEAR(end.force_N(), 2, 1e-12);
    EXPECT_THROW(read_control_settings(ConfigFile::parse("[control]\nage_trust_s = 1\n", "c.toml")), Error);
}

TEST(Additions, AStageDelaysItsShareOfPackets) {
    const ConfigFile file = ConfigFile::parse("delay_s = 0.01\nretry = 0.25\nin_order = false\n", "l.toml");
    const LinkSettings settings = read_link_settings(file.root());
    file.finish();
    EXPECT_NE(print_profile_link(settings).find("\nretry = 0.25\n"), std::string::npos);
    LinkModel link(settings, {}, 0);
    const std::array<std::uint8_t, 1> packet{};
    int late = 0;
    for (int n = 0; n < 1000; ++n) {
        link.push(at(n), packet);
        EXPECT_TRUE(link.next_due() == at(n + 0.01) || link.next_due() == at(n + 0.03));
        late += link.next_due() == at(n + 0.03) ? 1 : 0;
        EXPECT_FALSE(link.pop_due(link.next_due()).empty());
    }
    EXPECT_NEAR(late, 250, 60);
}

TEST(Additions, AStatisticReachesTheFindings) {
    std::vector<TrialRow> rows(6);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool second = i % 2 == 1;
        rows[i].conditions.subject = static_cast<std::uint32_t>(1 + i / 2);
        rows[i].conditions.modality = second ? Modality::kCF : Modality::kHF;
        rows[i].metrics.penetration_mean_m = second ? 0.001 : 0.002 + 0.001 * static_cast<double>(i / 2);
        rows[i].reason = EndReason::kCompleted;
    }
    std::vector<double> sizes;  // differences of 1, 2 and 3 mm
    for (const nlohmann::ordered_json& row : to_json(findings_of(rows)))
        if (row.contains("d_z") && row["d_z"].is_number())
            sizes.push_back(std::abs(row["d_z"].get<double>()));
    ASSERT_EQ(sizes.size(), 1u);
    EXPECT_NEAR(sizes[0], 2, 1e-12);
}

}  // namespace
}  // namespace thimble
