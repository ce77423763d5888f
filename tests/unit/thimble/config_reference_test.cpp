// The references of scene and profile files against the readers: what is listed is read, with the range that is listed.
#include "thimble/commands/config_reference.hpp"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "common/error.hpp"
#include "netem/profiles/profiles.hpp"
#include "slave_sim/scene_file.hpp"

namespace thimble {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

using ReferenceKeys = std::map<std::string, KeyDeclaration>;

// A file in which only this key is set, to something that none of the types is.
std::string file_with_date(const std::string& path) {
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
    return fmt::format("{}{} = 2020-01-01{}", open, path.substr(from), close);
}

template <class Read>
std::string refusal_of(const std::string& text, const Read& read) {
    try {
        const ConfigFile file = ConfigFile::parse(text, "asked");
        read(file);
        file.finish();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

const auto kReadScene = [](const ConfigFile& file) { read_scene(file, "asked"); };
const auto kReadProfile = [](const ConfigFile& file) {
    read_profile(file, "asked", [](std::string_view) { return std::string(); });
};

// Keys of a model are read once that model is chosen; all others by every file.
bool always_read(const std::string& path) {
    return path.find(".loss.") == std::string::npos && path.find("loss_burst") == std::string::npos &&
           path.find("event[].") == std::string::npos;
}

template <class Read>
void expect_each_is_read(const ReferenceKeys& keys, const Read& read) {
    for (const auto& [path, declared] : keys) {
        if (!always_read(path) || declared.type.find("table") != std::string::npos) continue;
        const std::string refusal = refusal_of(file_with_date(path), read);
        EXPECT_THAT(refusal, HasSubstr("must be")) << path;
        EXPECT_THAT(refusal, Not(HasSubstr("unknown"))) << path;
    }
}

TEST(ConfigReference, EachKeyOfASceneIsRead) {
    const ReferenceKeys keys = scene_file_keys();
    EXPECT_GT(keys.size(), 30U);
    expect_each_is_read(keys, kReadScene);
    EXPECT_THAT(refusal_of("vessel = [{ diametre_m = 1 }]", kReadScene), HasSubstr("unknown"));
    EXPECT_EQ(keys.count("vessel[].diametre_m"), 0U);
}

TEST(ConfigReference, EachKeyOfAProfileIsRead) {
    const ReferenceKeys keys = profile_file_keys();
    EXPECT_GT(keys.size(), 100U);
    expect_each_is_read(keys, kReadProfile);
}

TEST(ConfigReference, AKeyWithoutADefaultShowsNone) {
    const ReferenceKeys keys = scene_file_keys();
    EXPECT_EQ(keys.at("fixture[].event[].position_m").fallback, "");
    EXPECT_EQ(keys.at("fixture[].event[].after_contact_s").range, "0 to 1000000000");
    EXPECT_EQ(keys.at("fixture[].event[].present").fallback, "false");
    EXPECT_EQ(keys.at("vessel[].mass_kg").fallback, "0.01");
    EXPECT_EQ(profile_file_keys().at("change[].loss.mean_burst").type, "number");
}

TEST(ConfigReference, UnitsComeFromTheNames) {
    EXPECT_EQ(unit_of_key("damping_Ns_per_m"), "N s/m");
    EXPECT_EQ(unit_of_key("position_m"), "m");
    EXPECT_EQ(unit_of_key("loss"), "");
    for (const auto& [path, declared] : session_file_keys()) {
        if (path.find("_per_") == std::string::npos || path.ends_with("trials_per_modality")) continue;
        EXPECT_NE(unit_of_key(path).find('/'), std::string::npos) << path;
    }
}

TEST(ConfigReference, KeysOutsideOfTablesHaveAHeading) {
    const std::string page = keys_as_markdown(profile_file_keys());
    EXPECT_THAT(page, HasSubstr("## Before the first table\n\n| key | type | unit | default | range |"));
    EXPECT_THAT(page, HasSubstr("| `about` | text |"));
    EXPECT_THAT(page, HasSubstr("## [down], [up]\n"));
}

}  // namespace
}  // namespace thimble
