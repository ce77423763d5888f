
#include <algorithm>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/config.hpp"
#include "common/error.hpp"
#include "common/own_program.hpp"
#include "common/text_file.hpp"
#include "session/settings/protocol.hpp"
#include "session/settings/system_settings.hpp"

namespace thimble {
namespace {

namespace fs = std::filesystem;

fs::path shipped_folder() { return shipped_files() / "sessions"; }

fs::path shipped_file(const std::string& name) { return shipped_folder() / (name + ".toml"); }

std::vector<std::string> shipped_names() {
    std::vector<std::string> names;
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(shipped_folder(), absent))
        if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

[[noreturn]] void refuse(const std::string& given) {
    const std::vector<std::string> names = shipped_names();
    const std::string known = names.empty() ? fmt::format(
                                                  "cannot read {}, the folder of the built-in session files: "
                                                  "is Thimble installed completely?",
                                                  shipped_folder().string())
                                            : fmt::format("the built-in ones are {}", fmt::join(names, ", "));
    throw Error(ExitCode::kUsage, fmt::format("{}: there is no such session file; {}", given, known));
}

// Of [session] and [protocol] only what the trials are. finish() refuses each key that was not asked for.
bool says_nothing_but_trials(const ConfigFile& config) {
    if (!config.table("protocol").has("experiments")) return false;
    const ConfigTable session = config.table("session"), protocol = config.table("protocol");
    for (const char* key : {"modalities", "delays_s", "order", "seed"})
        static_cast<void>(session.is_text(key));
    for (const char* key : {"experiments", "subjects", "trials_per_modality", "removals"})
        static_cast<void>(protocol.is_text(key));
    try {
        config.finish();
    } catch (const Error&) {
        return false;
    }
    return true;
}

}  // namespace

fs::path find_session_file(const std::string& given) {
    std::error_code absent;
    refuse_folder(given);
    if (fs::exists(given, absent)) return given;
    const bool plain = !given.empty() && given.find('/') == std::string::npos;
    if (plain && fs::exists(shipped_file(given), absent)) return shipped_file(given);
    refuse(given);
}

std::optional<std::string> shipped_name(const fs::path& file) {
    std::error_code absent;
    const std::string name = file.stem().string();
    if (!fs::equivalent(file, shipped_file(name), absent)) return std::nullopt;
    return name;
}

bool is_paper_session(const fs::path& file) {
    if (!says_nothing_but_trials(ConfigFile::load(file))) return false;
    const SystemSettings settings = load_system_settings(file);
    const std::vector<Protocol> protocols = session_protocols(settings);
    return settings.plan.kind == SubjectKind::kVirtual && protocols.size() == 1 &&
           plans_paper_trials(protocols[0]) &&
           protocols[0].subjects ==
               (protocols[0].experiment == 3 ? kSubjectsWithDelay : kSubjectsWithoutDelay);
}

}  // namespace thimble
