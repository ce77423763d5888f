#include "session/settings/launch_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "netem/packet_trace.hpp"
#include "session/launch/remote_starter.hpp"
#include "session/settings/system_settings.hpp"
#include "tests/read_text.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

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
std::string usage_refusal(const Call& call) {
    return refusal(call, ExitCode::kUsage);
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
        EXPECT_THAT(usage_refusal([&] { launch(text); }), HasSubstr("session.toml")) << text;
    }
}

constexpr const char* kApart = "machine_netem = 'relay'\nmachine_slave_sim = 'robot'";
constexpr const char* kHosts =
    "host_session = '10.77.0.1'\nhost_master = '10.77.0.1'\nhost_cutaneous = '10.77.0.1'\n"
    "host_visual = '10.77.0.1'\n";
constexpr const char* kLabKey = "[security]\nmode = 'lab-key'\n";

TEST(CheckHosts, TakesAnAddressForEachMachine) {
    const std::string hosts =
        std::string(kHosts) + "host_netem = '10.77.0.2'\nhost_slave_sim = '10.77.0.3'\n";
    EXPECT_NO_THROW(check_hosts(launch(kApart), network(hosts + kLabKey)));
    EXPECT_THAT(usage_refusal([&] { check_hosts(launch(kApart), network(hosts)); }), HasSubstr("user-key"));
}

TEST(CheckHosts, RefusesALoopbackAddressThatAnotherMachineIsToUse) {
    const std::string words = usage_refusal([] { check_hosts(launch(kApart), network("")); });
    EXPECT_THAT(words, HasSubstr("127.0.0.1"));
    EXPECT_THAT(words, HasSubstr("[network].host_"));
    // The node that stays here is talked to from there.
    const std::string own = usage_refusal([] {
        check_hosts(launch(kApart), network("host_session = '10.77.0.1'\nhost_master = '127.0.0.2'\n"
                                            "host_netem = '10.77.0.2'\nhost_slave_sim = '10.77.0.3'"));
    });
    EXPECT_THAT(own, HasSubstr("127.0.0.2"));
}

TEST(CheckHosts, RefusesOneAddressForTwoMachines) {
    const std::string words = usage_refusal([] {
        check_hosts(launch(kApart),
                    network(std::string(kHosts) + "host_netem = '10.77.0.2'\nhost_slave_sim = '10.77.0.2'"));
    });
    EXPECT_THAT(words, HasSubstr("'relay'"));
    EXPECT_THAT(words, HasSubstr("'robot'"));
}

TEST(CheckHosts, LoopbackIsFineWhereItIsShared) {
    const LaunchSettings shared = launch(std::string(kApart) + "\nshares_loopback = true");
    EXPECT_NO_THROW(check_hosts(shared, network(kLabKey)));
    EXPECT_NO_THROW(check_hosts(shared, network("[security]\nmode = 'none'\n")));
    EXPECT_THAT(usage_refusal([&] { check_hosts(shared, network("")); }), HasSubstr("thimble keygen"));
}

// Relative to the session file, wherever the program runs.
TEST(OwnProgram, LiesBesideTheSessionFile) {
    const TemporaryDirectory folder;
    const auto program = [&folder](const std::string& text) {
        write_text(folder / "session.toml", "[launch]\n" + text);
        return read_launch_settings(ConfigFile::load(folder / "session.toml"));
    };
    EXPECT_EQ(program("").own_program_key(), "");
    const auto refused = [&program](const std::string& text) {
        return usage_refusal([&] { program(text); });
    };
    write_text(folder / "slave.py", "#!/bin/sh\n");
    EXPECT_THAT(refused("program_slave_sim = 'slave.py'"), HasSubstr("executable (chmod +x)"));
    std::filesystem::permissions(folder / "slave.py", std::filesystem::perms::owner_all);
    const LaunchSettings settings = program("program_slave_sim = 'slave.py'");
    EXPECT_EQ(settings.own_program(Role::kSlaveSim), std::filesystem::absolute(folder / "slave.py"));
    EXPECT_EQ(settings.own_program(Role::kMaster), "");
    EXPECT_EQ(settings.own_program_key(), "program_slave_sim");
    EXPECT_THAT(refused("program_master = 'no.py'"),
                HasSubstr("no.py', but there is no program of that name"));
    EXPECT_THAT(refused("program_master = 'slave.py'\nmachine_visual = 'lab'"), HasSubstr("one machine"));
}

// A session that goes to another machine goes as a whole, or not at all.
namespace fs = std::filesystem;

class SessionBundles : public testing::Test {
  protected:
    fs::path write(const std::string& name, const std::string& text) const {
        fs::create_directories((folder_ / name).parent_path());
        write_text(folder_ / name, text);
        return folder_ / name;
    }
    std::vector<std::string> names(const std::string& session) const {
        std::vector<std::string> all;
        for (const BundledFile& file : make_bundle(write("session.toml", session)).files)
            all.push_back(file.name);
        return all;
    }
    std::string refused(const std::string& session) const {
        return refusal([&] { names(session); }, ExitCode::kUsage);
    }

    const TemporaryDirectory folder_;
};

constexpr const char* kTrace = "time_s,delay_s\n0,0.01\n1,0.02\n";

TEST_F(SessionBundles, AFileAloneIsEnoughWhereNothingIsNamed) {
    EXPECT_THAT(names("[session]\nseed = 3\n"), UnorderedElementsAre("session.toml"));
    EXPECT_THAT(names("[slave_sim]\nscene = 'vessel.toml'\n[netem.force]\nprofile = 'leo'\n"),
                UnorderedElementsAre("session.toml"))
        << "what comes with the program is there already";
}

TEST_F(SessionBundles, EverythingThatIsNamedComesAlong) {
    write("scenes/mine.toml", read_text(THIMBLE_SOURCE_DIR "/deploy/scenes/layers.toml"));
    write("nets/lab.toml", "[down]\ntrace = 'it is late.csv'\n");
    write("nets/it is late.csv", kTrace);
    write("nets/unused.csv", kTrace);
    write("needle.csv", kTrace);
    EXPECT_THAT(names("[slave_sim]\nscene = 'scenes/mine.toml'\n[netem.force]\nprofile = 'nets/lab.toml'\n"
                      "[netem.needle]\ntrace = 'needle.csv'\n"),
                UnorderedElementsAre("session.toml", "scenes/mine.toml", "nets/lab.toml",
                                     "nets/it is late.csv", "needle.csv"));
}

// Unpacked elsewhere it reads as it did here.
TEST_F(SessionBundles, WhatIsSentIsEnough) {
    write("nets/lab.toml", "[down]\ntrace = 'late.csv'\n");
    write("nets/late.csv", kTrace);
    const SessionBundle bundle =
        make_bundle(write("session.toml", "[netem.force]\nprofile = 'nets/lab.toml'\n"));
    for (const BundledFile& file : bundle.files) write("there/" + file.name, file.text);
    const SystemSettings here = load_system_settings(folder_ / "session.toml");
    fs::remove_all(folder_ / "nets");
    const SystemSettings there = load_system_settings(folder_ / "there/session.toml");
    ASSERT_TRUE(here.netem.force.trace && there.netem.force.trace);
    EXPECT_EQ(here.netem.force.trace->rows(), there.netem.force.trace->rows());
}

TEST_F(SessionBundles, RefusesWhatCouldBeAnotherFileThere) {
    write("elsewhere.csv", kTrace);
    const std::string absolute = (folder_ / "elsewhere.csv").string();
    EXPECT_THAT(refused("[netem.needle]\ntrace = '" + absolute + "'\n"), HasSubstr(absolute));
    write("in/x.csv", kTrace);
    EXPECT_THAT(refused("[netem.needle]\ntrace = 'in/../elsewhere.csv'\n"), HasSubstr("elsewhere.csv"));
}

// `slave_sim.scene` is also found from where the program was started.
TEST_F(SessionBundles, RefusesAFileThatIsFoundFromTheWorkingFolderOnly) {
    const fs::path before = fs::current_path();
    write("started/here.toml", read_text(THIMBLE_SOURCE_DIR "/deploy/scenes/layers.toml"));
    fs::current_path(folder_ / "started");
    const std::string words = refused("[slave_sim]\nscene = 'here.toml'\n");
    fs::current_path(before);
    EXPECT_THAT(words, HasSubstr("'here.toml', which is not beside it"));
}

TEST_F(SessionBundles, AStreamSaysHowMuchComes) {
    EXPECT_EQ(to_stream({{{"s.toml", "a = 1\n"}, {"b/c d.csv", ""}}}), "6 s.toml\na = 1\n0 b/c d.csv\nend\n");
}

TEST_F(SessionBundles, EverySessionThatComesWithTheProgramCanBeSent) {
    std::size_t sessions = 0;
    for (const auto& entry : fs::directory_iterator(THIMBLE_SOURCE_DIR "/deploy/sessions")) {
        EXPECT_NO_THROW(make_bundle(entry.path())) << entry.path();
        ++sessions;
    }
    EXPECT_GE(sessions, 3U);
}

}  // namespace
}  // namespace thimble
