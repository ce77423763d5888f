#include "study/board/board_plan.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/text_file.hpp"
#include "study/compensators/compensator_study.hpp"

namespace thimble {
namespace {

constexpr const char* kNameCharacters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_.";

SystemSettings settings_of(const std::string& session, const std::string& name) {
    return read_system_settings(ConfigFile::parse(session, name));
}

// Two methods need numbers of the network, the same as in thimble compensators. A key of the entry itself wins.
std::string adapted_keys(const SystemSettings& settings) {
    const ControlSettings& control = settings.master.control;
    if (control.compensator == Compensator::kScaled) {
        const double loop_s = to_seconds(session_settings(settings).network_delay);
        return fmt::format("control.share = {}\n", 1.0 * stable_share(settings, loop_s));
    }
    if (control.compensator == Compensator::kWave) {
        const Duration jitter = control.jitter + 2 * settings.netem.force.jitter.spread;
        return fmt::format("control.wave_jitter_s = {}\n", to_seconds(jitter));
    }
    return "";
}

template <class Entries>
void keep_named(Entries& entries, const std::vector<std::string>& names) {
    const auto named = [&](const auto& entry) {
        return std::find(names.begin(), names.end(), entry.name) != names.end();
    };
    if (std::none_of(entries.begin(), entries.end(), named)) return;
    std::erase_if(entries, [&](const auto& entry) { return !named(entry); });
}

template <class Entries>
void add_names(std::vector<std::string>& names, const Entries& entries) {
    for (const auto& entry : entries) names.push_back(entry.name);
}

}  // namespace

BoardPlace place_of(const BoardPlan& plan, std::size_t row) {
    const std::size_t condition = row % plan.conditions.size();
    row /= plan.conditions.size();
    return {plan.controllers.at(row / plan.codecs.size()), plan.codecs.at(row % plan.codecs.size()),
            plan.conditions.at(condition)};
}

std::string row_name(const BoardPlace& place) {
    return fmt::format("{}, {}, {}", place.controller.name, place.codec.name, place.condition.name);
}

std::filesystem::path board_folder() { return shipped_files() / "board"; }

void add_plugin(BoardPlan& plan, const std::filesystem::path& file) {
    if (!std::filesystem::is_regular_file(file))
        throw Error(ExitCode::kUsage, "--plugin {}: no such file: check the path", file.string());
    const std::string name = file.stem().string(), place = std::filesystem::absolute(file).string();
    // The name is a field of tables, a word of --only and a part of file names.
    if (name.find_first_not_of(kNameCharacters) != std::string::npos || place.find('\'') != std::string::npos)
        throw Error(
            ExitCode::kUsage,
            "--plugin {}: rename the file: letters, digits, '-', '_' and '.' alone, and no \"'\" in its path",
            file.string());
    std::vector<std::string> known;
    add_names(known, plan.controllers);
    add_names(known, plan.codecs);
    add_names(known, plan.conditions);
    if (std::find(known.begin(), known.end(), name) != known.end())
        throw Error(ExitCode::kUsage,
                    "--plugin {}: the board already has a controller named {}: rename the file",
                    file.string(), name);
    plan.controllers.push_back({name, "a plug-in",
                                fmt::format("session.modalities = [\"HF\"]\ncontrol.plugin = '{}'\n", place),
                                place});
}

void keep_only(BoardPlan& plan, const std::vector<std::string>& names) {
    std::vector<std::string> known;
    add_names(known, plan.controllers);
    add_names(known, plan.codecs);
    add_names(known, plan.conditions);
    for (const std::string& name : names) {
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw Error(ExitCode::kUsage,
                        "--only {}: no controller, codec or condition has this name: choose from {}", name,
                        fmt::join(known, ", "));
    }
    keep_named(plan.controllers, names);
    keep_named(plan.codecs, names);
    keep_named(plan.conditions, names);
}

std::string plan_text(const BoardPlan& plan) {
    std::string text = fmt::format("board {}\nseed {}\ntrials {}\n", plan.version, plan.seed, plan.trials);
    const auto add = [&](const char* kind, const std::string& name, const std::string& keys) {
        text += fmt::format("\n# {} {}\n{}\n", kind, name, keys);
    };
    for (const BoardEntry& entry : plan.controllers) {
        add("controller", entry.name, entry.keys);
        if (!entry.plugin.empty()) text += fmt::format("# sha256 {}\n", sha256_of_file(entry.plugin));
    }
    for (const BoardEntry& entry : plan.codecs) add("codec", entry.name, entry.keys);
    for (const BoardCondition& entry : plan.conditions) add("condition", entry.name, entry.keys);
    return text;
}

std::string row_session(const BoardPlan& plan, const BoardPlace& place, std::uint32_t subject) {
    const std::string name = row_name(place);
    const std::array fragments{place.condition.keys, place.codec.keys, place.controller.keys,
                               fmt::format("session.seed = {}\nsession.subject = {}\n", plan.seed, subject)};
    std::string plain = joined_fragments(fragments, name);
    if (!place.controller.plugin.empty()) return plain;  // to read it loads the plug-in
    const std::array adapted{adapted_keys(settings_of(plain, name)), plain};
    return joined_fragments(adapted, name);
}

}  // namespace thimble
