// The port table that laboratories open their firewalls by is the one of the program.
#include "session/launch/port_table.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/read_text.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(PortTable, StandsInTheManual) {
    EXPECT_THAT(read_text(THIMBLE_SOURCE_DIR "/docs/machines.md"), HasSubstr(port_table({})));
}

TEST(PortTable, TheProtocolPageSaysTheSame) {
    const std::string page = read_text(THIMBLE_SOURCE_DIR "/docs/protocol.md");
    for (std::uint16_t i = 0; i < static_cast<std::uint16_t>(Port::kCount); ++i) {
        const Flow& from = flow(static_cast<Port>(i));
        const std::string kind = std::string(from.what).substr(0, std::string(from.what).find(' '));
        EXPECT_THAT(page, HasSubstr("| " + std::to_string(i) + " | " + to_string(from.listens) + " | " +
                                    to_string(from.hears) + ": " + kind));
    }
}

TEST(PortTable, AFirewallHearsOfWhatCrossesOnly) {
    LaunchSettings launch;
    launch.machines[static_cast<std::size_t>(Role::kSlaveSim)] = "robot";
    const std::string table = firewall_table({}, launch);
    EXPECT_THAT(
        table,
        HasSubstr("| 27014 | slave_sim | netem | needle | 127.0.0.1 (robot) | 127.0.0.1 (this machine) |"));
    EXPECT_THAT(table, HasSubstr("| 27005 | session | slave_sim | record |"));
    EXPECT_THAT(table, Not(HasSubstr("| 27011 |")));  // netem to master, both here
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 2 + 8 + 6);
}

}  // namespace
}  // namespace thimble
