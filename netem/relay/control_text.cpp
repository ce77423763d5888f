#include "netem/relay/control_text.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "common/config.hpp"
#include "common/error.hpp"
#include "netem/formats/text_lines.hpp"
#include "netem/profiles/profiles.hpp"

namespace thimble {
namespace {

constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
constexpr std::string_view kKeyCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.";

std::vector<std::string> lines_of(std::string_view text) {
    std::vector<std::string> lines;
    for (LineReader reader(text, "request"); reader.next();) {
        if (const auto line = trimmed(reader.line()); !line.empty()) lines.emplace_back(line);
    }
    return lines;
}

struct Assignment {
    bool up = true, down = true;
    std::string key, value;
};

// normal instead of "normal", and 50ms: shells eat the quotes.
std::string quoted_if_bare(std::string_view value) {
    constexpr std::array<std::string_view, 4> kToml{"true", "false", "inf", "nan"};
    const bool word = kLetters.find(value.front()) != std::string_view::npos;
    const bool has_unit = kLetters.find(value.back()) != std::string_view::npos && !value.starts_with("0x");
    const bool bare = (word || has_unit) && value.find_first_of("\"'[]{}=#,\\\n") == std::string_view::npos;
    const bool has_sign = value.front() == '+' || value.front() == '-';
    if (!bare || std::find(kToml.begin(), kToml.end(), value.substr(has_sign ? 1 : 0)) != kToml.end())
        return std::string(value);
    return fmt::format("\"{}\"", value);
}

Assignment parse_assignment(std::string_view text) {
    const std::size_t equals = text.find('=');
    const std::string_view key = trimmed(text.substr(0, equals));
    const std::string_view value = equals == std::string_view::npos ? "" : trimmed(text.substr(equals + 1));
    if (key.empty() || value.empty() || key.find_first_not_of(kKeyCharacters) != std::string_view::npos ||
        value.find('\n') != std::string_view::npos) {
        throw Error(ExitCode::kUsage,
                    "'{}' is not a setting: write KEY=VALUE, e.g. up.delay_s=0.1 or loss=0.01",
                    text.substr(0, 80));
    }
    Assignment made;
    made.up = !key.starts_with("down.");
    made.down = !key.starts_with("up.");
    made.key = made.up && made.down ? key : key.substr(key.find('.') + 1);
    made.value = quoted_if_bare(value);
    return made;
}

LinkSettings assign(const LinkSettings& base, Way way, const std::string& text) {
    if (text.empty()) return base;
    const ConfigFile file = ConfigFile::parse(text, way == Way::kUp ? "up" : "down");
    LinkSettings made;
    file.read_all([&] { made = read_link_settings(file.root(), base, session_sources({}, way)); });
    return made;
}

}  // namespace

ControlRequest parse_request(std::string_view text) {
    if (text.size() > kLongestRequestBytes) {
        throw Error(ExitCode::kUsage, "a request is at most {} bytes long", kLongestRequestBytes);
    }
    std::vector<std::string> lines = lines_of(text);
    const std::string verb = lines.empty() ? "" : lines.front();
    if (verb == "show" && lines.size() == 1) return {ControlRequest::Verb::kShow, {}};
    if (verb != "set" || lines.size() == 1) {
        throw Error(ExitCode::kUsage,
                    "the first line of a request is 'show', alone, or 'set', followed by lines KEY = VALUE");
    }
    lines.erase(lines.begin());
    return {ControlRequest::Verb::kSet, std::move(lines)};
}

LinkPair assign(const LinkPair& base, const std::vector<std::string>& assignments) {
    std::string up, down;
    for (const std::string& text : assignments) {
        const Assignment a = parse_assignment(text);
        if (a.up) up += fmt::format("{} = {}\n", a.key, a.value);
        if (a.down) down += fmt::format("{} = {}\n", a.key, a.value);
    }
    return {assign(base.up, Way::kUp, up), assign(base.down, Way::kDown, down)};
}

}  // namespace thimble
