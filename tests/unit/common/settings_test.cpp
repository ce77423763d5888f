#include <map>
#include <sched.h>
#include <set>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "common/error.hpp"
#include "common/network_settings.hpp"
#include "common/runtime/runtime_settings.hpp"

namespace thimble {
namespace {

constexpr auto kPorts = static_cast<std::uint16_t>(Port::kCount);

NetworkSettings network_settings(const std::string& text) {
    const ConfigFile file = ConfigFile::parse("[network]\n" + text, "network.toml");
    const NetworkSettings settings = read_network_settings(file);
    file.finish();
    return settings;
}

TEST(NetworkSettings, EveryPortIsItsOwn) {
    const NetworkSettings settings = network_settings("");
    std::set<std::uint16_t> ports;
    for (std::uint16_t i = 0; i < kPorts; ++i) ports.insert(settings.at(static_cast<Port>(i)).port);
    EXPECT_EQ(ports.size(), std::size_t{kPorts});
    EXPECT_EQ(*ports.begin(), settings.base_port);
    EXPECT_EQ(*ports.rbegin(), settings.base_port + kPorts - 1);
}

// The session has an end for each node, one for the record and two for requests; every node one for its orders and one per
// flow it takes; all have one for stops.
TEST(NetworkSettings, EveryPortBelongsToWhoListensThere) {
    std::map<Role, int> owned;
    for (std::uint16_t i = 0; i < kPorts; ++i) ++owned[owner(static_cast<Port>(i))];
    const std::map<Role, int> expected{{Role::kSession, 9},     {Role::kMaster, 6}, {Role::kSlaveSim, 3},
                                       {Role::kCutaneous, 3},   {Role::kVisual, 5}, {Role::kNetem, 6},
                                       {Role::kExperimenter, 1}};
    EXPECT_EQ(owned, expected);
    EXPECT_EQ(owner(Port::kSessionMaster), Role::kSession);
    EXPECT_EQ(owner(Port::kMasterControl), Role::kMaster);
    EXPECT_EQ(owner(Port::kNetemControl), Role::kNetem);
    EXPECT_EQ(owner(Port::kVisualScene), Role::kVisual);
}

TEST(NetworkSettings, HostsByRole) {
    const NetworkSettings settings =
        network_settings("base_port = 50000\nhost_master = '10.0.0.1'\nhost_netem = 'relay'");
    EXPECT_EQ(settings.at(Port::kMasterForce).host, "10.0.0.1");
    EXPECT_EQ(settings.at(Port::kNetemNeedle).host, "relay");
    EXPECT_EQ(settings.at(Port::kSlaveNeedle).host, "127.0.0.1");
    EXPECT_EQ(settings.at(Port::kSessionMaster).port, 50000);
}

TEST(NetworkSettings, RefusesWhatDoesNotFit) {
    const std::string last = std::to_string(65536 - kPorts);
    EXPECT_EQ(network_settings("base_port = " + last).at(Port::kNetemStop).port, 65535);
    EXPECT_THROW(network_settings("base_port = " + std::to_string(65536 - kPorts + 1)), Error);
    EXPECT_THROW(network_settings("host_slave = 'x'"), Error);
}

TEST(NetworkSettings, AnEndpointIsReadFromText) {
    EXPECT_EQ(read_endpoint("9870", "--to", "127.0.0.1").host, "127.0.0.1");
    EXPECT_EQ(read_endpoint("lab:65535", "--to", "").port, 65535);
    for (const char* wrong : {"", "lab", "lab:", ":1", "lab:65536", "lab:-1", "1 "})
        EXPECT_THROW(read_endpoint(wrong, "--to", "127.0.0.1"), Error) << wrong;
}

TEST(NetworkSettings, AnObserversPortIsTheSessionsUnlessItIsGiven) {
    EXPECT_EQ(observed_network("", 0).base_port, NetworkSettings{}.base_port);
    EXPECT_EQ(observed_network("", 30000).base_port, 30000);
}

TEST(NetworkSettings, SessionTablesAreNamedOnce) {
    const auto tables = session_tables();
    EXPECT_EQ(std::set<std::string_view>(tables.begin(), tables.end()).size(), tables.size());
}

TEST(RuntimeSettings, WhatAnOverrunDoes) {
    const RuntimeSettings s =
        read_runtime_settings(ConfigFile::parse("[runtime]\noverrun = 'stop'\noverrun_limit = 7", "x.toml"));
    EXPECT_EQ(s.overrun, OverrunPolicy::kStop);
    EXPECT_EQ(s.overrun_limit, 7U);
}

TEST(CoreChoice, IsNoneUnlessNamed) {
    EXPECT_EQ(read_core(ConfigFile::parse("", "x.toml")), kAnyCore);
    EXPECT_EQ(read_core(ConfigFile::parse("[runtime]\ncore = 3", "x.toml")), 3);
    const ConfigFile file = ConfigFile::parse("[runtime]\ncore = 3\noverrun = 'rest'", "x.toml");
    EXPECT_EQ(read_runtime_settings(file).overrun, OverrunPolicy::kRest);
    EXPECT_NO_THROW(file.finish()) << "a key that every program knows";
}

TEST(CoreChoice, KeepsTheThreadThereAndNoOther) {
    std::string refusal;
    int core = kAnyCore, cores = 0;
    std::thread([&] {
        cpu_set_t allowed;
        sched_getaffinity(0, sizeof allowed, &allowed);
        for (int i = 0; i < CPU_SETSIZE; ++i)
            core = CPU_ISSET(static_cast<std::size_t>(i), &allowed) ? i : core;
        refusal = keep_to_core(core);
        sched_getaffinity(0, sizeof allowed, &allowed);
        cores = CPU_COUNT(&allowed);
    }).join();
    EXPECT_EQ(refusal, "");
    EXPECT_EQ(cores, 1);
}

TEST(CoreChoice, SaysThatACoreIsNotThere) {
    if (std::thread::hardware_concurrency() > 1023) GTEST_SKIP() << "it is there";
    EXPECT_NE(keep_to_core(1023).find("cannot use core 1023"), std::string::npos);
    EXPECT_EQ(keep_to_core(kAnyCore), "");
}

}  // namespace
}  // namespace thimble
