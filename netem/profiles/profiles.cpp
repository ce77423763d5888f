#include "netem/profiles/profiles.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "common/error.hpp"
#include "common/text_file.hpp"
#include "netem/formats/tc_text.hpp"
#include "netem/formats/text_lines.hpp"

namespace thimble {
namespace {

constexpr std::size_t kMostChanges = 100'000;

const BuiltInFile* built_in(std::string_view name) {
    const auto& files = built_in_profile_files();
    const auto found = std::find_if(files.begin(), files.end(),
                                    [name](const BuiltInFile& file) { return file.name == name; });
    return found == files.end() ? nullptr : &*found;
}

std::string find_built_in(std::string_view name) {
    if (const BuiltInFile* file = built_in(name)) return std::string(file->text);
    throw Error(ExitCode::kUsage, "{}: no such file comes with the program", name);
}

FileFinder beside(const std::filesystem::path& file) {
    return [folder = file.parent_path()](std::string_view name) { return read_whole_file(folder / name); };
}

FileFinder in_folder(const std::filesystem::path& folder, const std::filesystem::path& below,
                     const FileRead& read) {
    return [folder, below, read](std::string_view name) {
        if (read) read((below / name).string());
        return read_whole_file(folder / below / name);
    };
}

// A file first, so that a name that is also built in means what lies beside the session.
LinkProfile session_profile(const std::filesystem::path& folder, const std::string& name,
                            const FileRead& read) {
    if (!std::filesystem::is_regular_file(folder / name)) return load_profile(name);
    const std::string text = in_folder(folder, {}, read)(name);
    const auto find = in_folder(folder, std::filesystem::path(name).parent_path(), read);
    return parse_profile(text, (folder / name).string(), find);
}

std::size_t read_direction(const ConfigTable& change) {
    std::size_t direction = 2;
    change.read("direction", direction, {"up", "down", "both"}, "Direction that changes.");
    return direction;
}

// Changes build on one another, in the order of the file.
void read_changes(const ConfigFile& file, const FileFinder& find, LinkProfile& profile) {
    const LinkSources sources = sources_of(find);
    LinkSettings up = profile.up, down = profile.down;
    Duration before{};
    const auto describe = [&](const ConfigTable& change) {
        read_at(change);
        read_direction(change);
        read_link_settings(change, up, sources);
    };
    const std::vector<ConfigTable> changes = file.root().tables("change", describe);
    if (changes.size() > kMostChanges)
        file.root().fail("change", fmt::format("are more than {}", kMostChanges));
    for (const ConfigTable& change : changes) {
        const Duration at = read_at(change);
        if (at < before) change.fail("at_s", "must not be before the previous change");
        before = at;
        const std::size_t direction = read_direction(change);
        if (direction != 1) {
            up = read_link_settings(change, up, sources);
            profile.up_changes.push_back({at, up});
        }
        if (direction != 0) {
            down = read_link_settings(change, down, sources);
            profile.down_changes.push_back({at, down});
        }
    }
}

LinkProfile of_words(const std::string& words) {
    TcWays tc = parse_tc(words);
    LinkProfile profile;
    profile.name = words;
    profile.source = {"tc's words"};
    profile.up = std::move(tc.up);
    profile.down = std::move(tc.down);
    profile.one_way = tc.one_way;
    profile.seed = tc.seed;
    profile.notes = std::move(tc.notes);
    return profile;
}

std::string in_quotes(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
    return out + '"';
}

}  // namespace

const std::vector<std::string_view>& profile_names() {
    static const std::vector<std::string_view> names{
        "ideal", "paper50", "lan", "tactile",       "wifi", "5g-nsa",   "iss-direct",
        "leo",   "lte",     "4g",  "transatlantic", "geo",  "iss-tdrs", "moon"};
    return names;
}

LinkProfile read_profile(const ConfigFile& file, std::string_view name, const FileFinder& find) {
    LinkProfile profile;
    profile.name = name;
    file.root().read("about", profile.about, "One line that describes the network.");
    file.root().read("source", profile.source, "Source of each value; assumptions are marked.");
    profile.up = read_link_settings(file.table("up"), {}, sources_of(find));
    profile.down = read_link_settings(file.table("down"), {}, sources_of(find));
    read_changes(file, find, profile);
    return profile;
}

LinkProfile parse_profile(std::string_view text, std::string_view name, const FileFinder& find) {
    const ConfigFile file = ConfigFile::parse(text, name);
    LinkProfile profile;
    file.read_all([&] { profile = read_profile(file, name, find); });
    return profile;
}

const LinkProfile* built_in_profile(std::string_view name) {
    static const std::vector<LinkProfile> profiles = [] {
        std::vector<LinkProfile> all;
        all.reserve(profile_names().size());
        for (const std::string_view one : profile_names()) {
            const BuiltInFile* file = built_in(std::string(one) + ".toml");
            all.push_back(parse_profile(file->text, file->name, find_built_in));
            all.back().name = one;
        }
        return all;
    }();
    const auto found = std::find_if(profiles.begin(), profiles.end(),
                                    [name](const LinkProfile& profile) { return profile.name == name; });
    return found == profiles.end() ? nullptr : &*found;
}

LinkProfile load_profile(const std::string& given) {
    if (const LinkProfile* profile = built_in_profile(given)) return *profile;
    if (std::filesystem::is_regular_file(given))
        return parse_profile(read_whole_file(given), given, beside(given));
    if (looks_like_tc_words(given)) return of_words(given);
    throw Error(ExitCode::kUsage, "{}: there is no such profile file; the built-in ones are {}", given,
                fmt::join(profile_names(), ", "));
}

LinkSources session_sources(const std::filesystem::path& folder, Way way, const FileRead& read) {
    LinkSources sources = sources_of(in_folder(folder, {}, read));
    sources.profile = [folder, way, read](const std::string& name) {
        const LinkProfile profile = session_profile(folder, name, read);
        const bool up = way == Way::kUp;
        if (!(up ? profile.up_changes : profile.down_changes).empty()) {
            throw Error(ExitCode::kUsage,
                        "{}: changes with time; write the changes of a session in [[timeline]]", name);
        }
        return up || profile.one_way ? profile.up : profile.down;
    };
    return sources;
}

std::string print_profile(const LinkProfile& profile) {
    std::string text = fmt::format("about = {}\nsource = [\n", in_quotes(profile.about));
    for (const std::string& line : profile.source) text += fmt::format("    {},\n", in_quotes(line));
    text += fmt::format("]\n\n[up]\n{}\n[down]\n{}", print_profile_link(profile.up),
                        print_profile_link(profile.down));
    return text;
}

}  // namespace thimble
