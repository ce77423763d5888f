#include "session/launch/unit_files.hpp"

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/process/child.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;
using testing::Not;

UnitPlan plan() {
    UnitPlan plan;
    plan.session = "lab.toml";
    plan.network.security.mode = SecurityMode::kNone;
    plan.runtime.priority = 71;
    plan.launch.machines[static_cast<std::size_t>(Role::kSlaveSim)] = "robot";
    plan.network.hosts[static_cast<std::size_t>(Role::kSlaveSim)] = "10.77.0.3";
    plan.network.hosts[static_cast<std::size_t>(Role::kExperimenter)] = "10.77.0.9";  // which may stop
    return plan;
}

const UnitFile& unit_of(const std::vector<UnitFile>& files, const std::string& program) {
    for (const UnitFile& file : files) {
        if (file.name == program + ".service") return file;
    }
    throw std::runtime_error("no unit for " + program);
}

TEST(UnitFiles, SayWhatANodeNeedsAndNoMore) {
    const auto files = unit_files(plan());
    EXPECT_EQ(files.size(), 5U);
    const UnitFile& slave = unit_of(files, "thimble-slave-sim");
    EXPECT_EQ(slave.machine, "robot");
    for (const char* line :
         {"Type=notify\n", "LimitRTPRIO=71\n", "ProtectSystem=strict\n", "WatchdogSec=2\n",
          "TimeoutStartSec=infinity\n", "NoNewPrivileges=yes\n",
          "ExecStart=\"/usr/bin/thimble-slave-sim\" \"/etc/thimble/lab.toml\" --base-port 27000\n",
          "IPAddressAllow=localhost 10.77.0.3 10.77.0.9 127.0.0.1\n", " AF_CAN\n"}) {
        EXPECT_THAT(slave.text, HasSubstr(line));
    }
}

// deploy/systemd/thimble-node@.service is for machines without `thimble run`, and protects them in the same way.
TEST(UnitFiles, TheTemplateOfThePackageProtectsAsTheseDo) {
    const std::string unit = unit_files(plan()).front().text;
    const std::size_t begin = unit.find("DynamicUser="), end = unit.find("SystemCallErrorNumber=");
    ASSERT_LT(begin, end);
    EXPECT_THAT(read_text(THIMBLE_SOURCE_DIR "/deploy/systemd/thimble-node@.service"),
                HasSubstr(unit.substr(begin, end - begin)));
}

TEST(UnitFiles, HandOverTheLabKeyWhereThereIsOne) {
    constexpr const char* kLine = "LoadCredential=lab.key:/etc/thimble/lab.key\n";
    UnitPlan secured = plan();
    EXPECT_THAT(unit_files(secured).front().text, Not(HasSubstr("LoadCredential")));
    secured.network.security.mode = SecurityMode::kLabKey;
    for (const UnitFile& file : unit_files(secured)) EXPECT_THAT(file.text, HasSubstr(kLine)) << file.name;
    secured.network.security.mode = SecurityMode::kUserKey;
    EXPECT_THAT(refusal([&] { unit_files(secured); }, ExitCode::kUsage), HasSubstr("thimble keygen"));
}

TEST(UnitFiles, ANameIsNoAddressToFilterBy) {
    UnitPlan named = plan();
    named.network.hosts[static_cast<std::size_t>(Role::kNetem)] = "relay.lab";
    EXPECT_THAT(unit_of(unit_files(named), "thimble-slave-sim").text, Not(HasSubstr("IPAddress")));
}

TEST(UnitFiles, SpecifiersAndVariablesAreNotExpanded) {
    UnitPlan odd = plan();
    odd.session = "50% $HOME \"x\".toml";
    EXPECT_THAT(unit_files(odd).front().text, HasSubstr(R"("/etc/thimble/50%% $$HOME \"x\".toml")"));
}

// In systemd's own opinion.
TEST(UnitFiles, AreGoodUnits) {
    namespace fs = std::filesystem;
    if (!fs::exists("/usr/bin/systemd-analyze")) GTEST_SKIP() << "no systemd-analyze (package systemd)";
    const TemporaryDirectory folder;
    UnitPlan here = plan();
    here.launch.programs = THIMBLE_BIN_DIR;  // systemd looks whether the program is there
    for (const UnitFile& file : unit_files(here)) {
        std::string text = file.text;
        const auto command = text.find("ExecStart=");
        text.replace(command, text.find('\n', command) - command, "ExecStart=/bin/true");
        write_text(folder / file.name, text);
        const ProgramResult result =
            run_program("systemd-analyze", {"verify", "--recursive-errors=no", (folder / file.name).string()},
                        folder.path(), "install systemd");
        EXPECT_EQ(result.exit_code, 0) << result.output;
        EXPECT_THAT(result.output, Not(HasSubstr(file.name))) << "a line it does not understand";
    }
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

TEST(PortTable, AFirewallHearsOfAViewElsewhere) {
    NetworkSettings network;
    EXPECT_THAT(firewall_table(network, {}), Not(HasSubstr("| 27")));
    network.hosts[static_cast<std::size_t>(Role::kExperimenter)] = "192.0.2.9";
    const std::string table = firewall_table(network, {});
    EXPECT_THAT(table,
                HasSubstr("| 27024 | experimenter | session | monitor | 192.0.2.9 (the view's machine) | "
                          "127.0.0.1 (this machine) |"));
    EXPECT_THAT(table, HasSubstr("| 27023 | session | experimenter |"));
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 2 + 2 + 6);
}

}  // namespace
}  // namespace thimble
