// `thimble doctor` as users start it. Its findings depend on the machine. The test checks their form, and the facts that it has arranged.
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/loopback/programs.hpp"

namespace thimble {
namespace {

using testing::HasSubstr;

// Without real-time scheduling, so that a test on a busy machine disturbs no other.
constexpr const char* kModest = "[runtime]\nrealtime_scheduling = false\n";

Outcome run_doctor(const std::filesystem::path& session, std::uint16_t base_port) {
    return run_thimble({"doctor", session.string(), "--json", "--seconds", "0.05", "--base-port",
                        std::to_string(base_port)});
}

nlohmann::json finding_of(const nlohmann::json& json, const std::string& name) {
    for (const auto& finding : json["findings"])
        if (finding["name"] == name) return finding;
    return {};
}

TEST(DoctorProgram, SaysInJsonWhetherASessionCanRun) {
    const Folder folder;
    const PortBlock ports;
    const Outcome outcome = run_doctor(folder.write("good.toml", kModest), ports.base());
    const auto json = nlohmann::json::parse(outcome.words, nullptr, false);
    ASSERT_TRUE(json.is_object()) << outcome.words;
    EXPECT_GE(json["findings"].size(), 10U);
    for (const char* name : {"session", "programs", "ports", "real time", "software"})
        EXPECT_NE(finding_of(json, name)["severity"], "fault") << outcome.words;
    EXPECT_GT(finding_of(json, "timer")["wake_ups"], 0) << outcome.words;
    // A machine under the load of other tests may be too late for any session.
    const bool late = finding_of(json, "timer")["severity"] == "fault";
    EXPECT_EQ(json["can_run"], !late) << outcome.words;
    EXPECT_EQ(outcome.code, late ? 4 : 0) << outcome.words;
}

TEST(DoctorProgram, ATakenPortIsNamedWithWhoHoldsIt) {
    const Folder folder;
    const PortBlock ports;
    const UdpChannel taken(Endpoint{"127.0.0.1", static_cast<std::uint16_t>(ports.base() + 3)},
                           {"127.0.0.1", 0});
    const Outcome outcome = run_doctor(folder.write("good.toml", kModest), ports.base());
    EXPECT_EQ(outcome.code, 3) << outcome.words;
    const auto json = nlohmann::json::parse(outcome.words, nullptr, false);
    ASSERT_TRUE(json.is_object()) << outcome.words;
    EXPECT_EQ(json["can_run"], false);
    EXPECT_THAT(finding_of(json, "ports")["says"].get<std::string>(), HasSubstr(std::to_string(getpid())));
    EXPECT_THAT(finding_of(json, "ports")["remedy"].get<std::string>(), HasSubstr("--base-port"));
}

TEST(DoctorProgram, ABadSessionFileIsAFinding) {
    const Folder folder;
    const PortBlock ports;
    const Outcome outcome = run_doctor(folder.write("bad.toml", "[trial]\ntimeout = 3\n"), ports.base());
    EXPECT_EQ(outcome.code, 2) << outcome.words;
    EXPECT_THAT(outcome.words, HasSubstr("bad.toml:2:"));
}

}  // namespace
}  // namespace thimble
