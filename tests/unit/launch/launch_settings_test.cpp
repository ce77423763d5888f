#include "session/settings/launch_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"

namespace thimble {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

LaunchSettings launch(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[launch]\n" + text, "session.toml");
    const LaunchSettings settings = read_launch_settings(file);
    file.finish();
    return settings;
}

NetworkSettings network(const std::string& text) {
    return read_network_settings(ConfigFile::parse("[network]\n" + text, "session.toml"));
}

template <class Call>
std::string refusal(Call call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        return error.what();
    }
    return "nothing was refused";
}

TEST(LaunchSettings, ByItselfEverythingRunsHere) {
    const LaunchSettings settings = launch("");
    EXPECT_FALSE(settings.anywhere_else());
    EXPECT_NO_THROW(check_hosts(settings, network("")));
}

TEST(LaunchSettings, SshIsTheWayThereUnlessTheFileKnowsAnother) {
    EXPECT_EQ(exec_words(launch(""), "me@lab").front(), "ssh");
    EXPECT_EQ(exec_words(launch(""), "me@lab").back(), "me@lab");
    const LaunchSettings other = launch("exec = 'ip  netns exec {host}'\nmachine_master = 'op'");
    EXPECT_THAT(exec_words(other, other.machine(Role::kMaster)), ElementsAre("ip", "netns", "exec", "op"));
    EXPECT_THAT(exec_words(launch("exec = 'x {host}-{host}'"), "{host}"), ElementsAre("x", "{host}-{host}"));
}

TEST(LaunchSettings, RefusesWhatSshWouldTakeForAnOption) {
    for (const char* text : {"machine_master = '-oProxyCommand=id'", "machine_master = 'a b'", "exec = '  '",
                             "machine_session = 'lab'", "lease_s = 1",
                             "exec = 'ssh lab'\nmachine_master = 'a'\nmachine_netem = 'b'"}) {
        EXPECT_THAT(refusal([&] { launch(text); }), HasSubstr("session.toml")) << text;
    }
}

constexpr const char* kApart = "machine_netem = 'relay'\nmachine_slave_sim = 'robot'";
constexpr const char* kHosts =
    "host_session = '10.77.0.1'\nhost_master = '10.77.0.1'\nhost_cutaneous = '10.77.0.1'\n"
    "host_visual = '10.77.0.1'\n";

TEST(CheckHosts, TakesAnAddressForEachMachine) {
    EXPECT_NO_THROW(
        check_hosts(launch(kApart),
                    network(std::string(kHosts) + "host_netem = '10.77.0.2'\nhost_slave_sim = '10.77.0.3'")));
}

TEST(CheckHosts, RefusesALoopbackAddressThatAnotherMachineIsToUse) {
    const std::string words = refusal([] { check_hosts(launch(kApart), network("")); });
    EXPECT_THAT(words, HasSubstr("127.0.0.1"));
    EXPECT_THAT(words, HasSubstr("[network].host_"));
    // The node that stays here is talked to from there.
    const std::string own = refusal([] {
        check_hosts(launch(kApart), network("host_session = '10.77.0.1'\nhost_master = 'localhost'\n"
                                            "host_netem = '10.77.0.2'\nhost_slave_sim = '10.77.0.3'"));
    });
    EXPECT_THAT(own, HasSubstr("localhost"));
}

TEST(CheckHosts, RefusesOneAddressForTwoMachines) {
    const std::string words = refusal([] {
        check_hosts(launch(kApart),
                    network(std::string(kHosts) + "host_netem = '10.77.0.2'\nhost_slave_sim = '10.77.0.2'"));
    });
    EXPECT_THAT(words, HasSubstr("'relay'"));
    EXPECT_THAT(words, HasSubstr("'robot'"));
}

TEST(CheckHosts, LoopbackIsFineWhereItIsShared) {
    EXPECT_NO_THROW(check_hosts(launch(std::string(kApart) + "\nshares_loopback = true"), network("")));
}

}  // namespace
}  // namespace thimble
