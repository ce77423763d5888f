// The descriptions of keys of session, scene and profile files, against the readers: each key is read, with the
// described type and range. So no test of a reader repeats it. docs_against_programs compares defaults and words.
#include "thimble/commands/config_reference.hpp"

#include <regex>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "common/network_settings.hpp"
#include "netem/profiles/profiles.hpp"
#include "session/settings/system_settings.hpp"
#include "slave_sim/scene_file.hpp"
#include "tests/refusal.hpp"

namespace thimble {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

using ReferenceKeys = std::vector<KeyDeclaration>;
using ReadFile = void (*)(const ConfigFile& file);

struct FileKind {
    ReferenceKeys keys;
    ReadFile read;
};

std::vector<FileKind> kinds() {
    return {{session_file_keys(), [](const ConfigFile& file) { read_system_settings(file); }},
            {scene_file_keys(), [](const ConfigFile& file) { read_scene(file, "asked"); }},
            {profile_file_keys(), [](const ConfigFile& file) { read_profile(file, "asked", {}); }}};
}

// A file in which only this key is set, behind those `before` it in its table.
std::string file_with(const std::string& path, const std::string& value, const std::string& before = "") {
    std::string open;
    std::string close;
    std::size_t from = 0;
    for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', from)) {
        const std::string name = path.substr(from, dot - from);
        const bool list = name.ends_with("[]");
        open += list ? name.substr(0, name.size() - 2) + " = [{ " : name + " = { ";
        close.insert(0, list ? " }]" : " }");
        from = dot + 1;
    }
    return fmt::format("{}{}{} = {}{}", open, before, path.substr(from), value, close);
}

std::string refusal_of(const std::string& text, ReadFile read) {
    const auto read_all = [&] {
        const ConfigFile file = ConfigFile::parse(text, "asked");
        read(file);
        file.finish();
    };
    return refusal(read_all, ExitCode::kUsage);
}

// The same; where the key depends on another one, that is chosen as the refusal says.
std::string refusal_of_key(const std::string& path, const std::string& value, ReadFile read) {
    const std::string refused = refusal_of(file_with(path, value), read);
    std::smatch said;
    if (!std::regex_search(refused, said, std::regex("with (\\w+) = .*choose ([\\w-]+)"))) return refused;
    return refusal_of(file_with(path, value, fmt::format("{} = '{}', ", said.str(1), said.str(2))), read);
}

// No date is a key of ours; the others are of the key's type, but the range leaves them out.
std::vector<std::string> refused_values(const KeyDeclaration& key) {
    if (!key.choices.empty()) return {"2020-01-01", "'neither'"};
    if (key.low.empty()) return {"2020-01-01"};
    const bool whole = key.types.back() == "whole number";
    const bool list = key.types.front() == "list of numbers";
    std::vector<std::string> values{"2020-01-01"};
    for (const std::string& beyond :
         {whole ? fmt::format("{}", INT64_MIN) : "-1e300", whole ? fmt::format("{}", INT64_MAX) : "1e300"})
        if (beyond != key.high) values.push_back(list ? "[" + beyond + "]" : beyond);
    return values;
}

TEST(ConfigReference, EachKeyIsReadAsItIsDescribed) {
    for (const auto& [keys, read] : kinds()) {
        EXPECT_GT(keys.size(), 30U);
        for (const KeyDeclaration& key : keys) {
            const std::string& path = key.path;
            // An entry of a timeline needs a time beside; its keys are those of its link.
            if (path.find("timeline[]") != std::string::npos || key.types.front().starts_with("table"))
                continue;
            SCOPED_TRACE(path);
            EXPECT_NE(key.help, "");
            const auto names_the_key = HasSubstr(path.substr(path.rfind('.') + 1) + "' ");
            for (const std::string& value : refused_values(key)) {
                const std::string refused = refusal_of_key(path, value, read);
                EXPECT_THAT(refused, names_the_key) << value;
                EXPECT_THAT(refused, AnyOf(HasSubstr(" must be "), HasSubstr(" must lie between "),
                                           HasSubstr(" must hold ")))
                    << value;
            }
        }
        EXPECT_THAT(refusal_of("vessel = [{ diametre_m = 1 }]", read), HasSubstr("unknown"));
    }
}

// Written a second time, by hand: a description that is wrong makes its reader wrong.
TEST(ConfigReference, WhatKeepsAHandSafeIsBounded) {
    struct Bound {
        const char* path;
        const char* beyond;
        const char* most;
    };
    for (const Bound& b : {Bound{"guard.force_limit_N", "1000.1", "1000"},
                           {"cutaneous.force_limit_N", "20.1", "20"},
                           {"cutaneous.guard_limit_N", "20.1", "20"},
                           {"runtime.priority", "99", "98"},
                           {"control.wave_repeats", "8", "7"}})
        EXPECT_THAT(refusal_of_key(b.path, b.beyond, kinds().front().read),
                    EndsWith(fmt::format(" and {}", b.most)))
            << b.path;
}

// A program checks its own tables and leaves those of the others.
TEST(ConfigReference, EveryProgramKnowsTheTablesOfASession) {
    std::vector<std::string_view> tables;
    const ReferenceKeys keys = session_file_keys();
    for (const KeyDeclaration& key : keys) {
        if (key.path.find('.') == std::string::npos) tables.push_back(key.path);
    }
    EXPECT_THAT(session_tables(), ::testing::UnorderedElementsAreArray(tables));
}

TEST(ConfigReference, UnitsComeFromTheNames) {
    EXPECT_EQ(unit_of_key("damping_Ns_per_m"), "N s/m");
    EXPECT_EQ(unit_of_key("position_m"), "m");
    EXPECT_EQ(unit_of_key("loss"), "");
    for (const KeyDeclaration& key : session_file_keys()) {
        const std::string& path = key.path;
        if (path.find("_per_") == std::string::npos || path.ends_with("trials_per_modality")) continue;
        EXPECT_NE(unit_of_key(path).find('/'), std::string::npos) << path;
    }
}

TEST(ConfigReference, AsAPage) {
    const std::string page = keys_as_markdown(profile_file_keys());
    EXPECT_THAT(page,
                HasSubstr("## Before the first table\n\n| key | type | unit | default | range | meaning |"));
    EXPECT_THAT(page, HasSubstr("| `about` | text |"));
    EXPECT_THAT(page, HasSubstr("## [up], [down]\n"));
    EXPECT_THAT(page, HasSubstr("| `delay_s` | number | s | `0` | 0 to 60 | Mean one-way delay"));
    EXPECT_THAT(page, HasSubstr("| `rate_drop` | text |  | `\"tail\"` | `\"tail\"`, `\"head\"` |"));
    EXPECT_THAT(keys_as_markdown(scene_file_keys()), Not(HasSubstr("nan")));
}

TEST(ConfigReference, AsJsonByPath) {
    const auto keys = nlohmann::json::parse(keys_as_json(session_file_keys()));
    EXPECT_EQ(keys["netem.force.loss"]["type"], "number or table");
    EXPECT_EQ(keys["netem.force.delay_s"]["range"], "0 to 60");
}

TEST(ConfigReference, AsASchema) {
    const auto session = nlohmann::json::parse(keys_as_schema(session_file_keys()));
    EXPECT_EQ(session["$schema"], "https://json-schema.org/draft/2020-12/schema");
    EXPECT_EQ(session["additionalProperties"], false);
    const auto& tables = session["properties"];
    const auto& force = tables["netem"]["properties"]["force"];
    EXPECT_EQ(force["additionalProperties"], false);
    const auto& delay = force["properties"]["delay_s"];
    EXPECT_THAT(delay["type"], ElementsAre("number", "string")) << "\"50ms\"";
    const std::regex unit(delay["pattern"].get<std::string>());
    for (const char* good : {"50ms", "0.05 s", "1e-3min", "+5.us", ".5\u03bcs"})
        EXPECT_TRUE(std::regex_match(good, unit)) << good;
    for (const char* bad : {"50", "50xs", "ms", "1.2.3s", "."})
        EXPECT_FALSE(std::regex_match(bad, unit)) << bad;
    EXPECT_EQ(delay["minimum"], 0);
    EXPECT_EQ(delay["maximum"], 60);
    EXPECT_EQ(delay["exclusiveMaximum"], 3) << "more needs a unit";
    EXPECT_FALSE(tables["protocol"]["properties"]["break_minimum_s"].contains("exclusiveMaximum"));
    EXPECT_EQ(delay["default"], 0);
    EXPECT_THAT(delay["description"].get<std::string>(), HasSubstr("delay"));
    const auto& loss = force["properties"]["loss"];
    EXPECT_THAT(loss["type"], ElementsAre("number", "object"));
    EXPECT_EQ(loss["maximum"], 1);
    EXPECT_EQ(loss["properties"]["p13"]["maximum"], 1);
    EXPECT_EQ(tables["session"]["properties"]["seed"]["type"], "integer");
    const auto& each_delay = tables["session"]["properties"]["delays_s"]["items"];
    EXPECT_EQ(each_delay["maximum"], 60);
    EXPECT_EQ(each_delay["pattern"], delay["pattern"]);
    EXPECT_THAT(tables["cutaneous"]["properties"]["device"]["enum"],
                ElementsAre("simulated", "board", "drives", "touchdiver"));
    const auto tissue = nlohmann::json::parse(keys_as_schema(scene_file_keys()))["properties"]["tissue"];
    EXPECT_THAT(tissue["type"], ElementsAre("object", "array"));
    EXPECT_EQ(tissue["items"]["properties"], tissue["properties"]);
}

}  // namespace
}  // namespace thimble
