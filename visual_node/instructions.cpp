#include "visual_node/instructions.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace thimble {
namespace {

// By PageKind; a page without a name is not shown.
constexpr std::array<const char*, kPageKinds> kPageNames{"",       "welcome", "practice", "ready",   "break",
                                                         "paused", "done",    "wait",     "question"};

long whole_seconds(const Page& page) { return static_cast<long>(std::ceil(std::max(0.0, page.remaining_s))); }

std::vector<std::string_view> placeholders_of(PageKind kind) {
    if (kind == PageKind::kDone) return {"{trials}"};
    if (kind == PageKind::kBreak) return {"{trial}", "{trials}", "{break_s}", "{break_time}"};
    if (kind == PageKind::kQuestion) return {};
    return {"{trial}", "{trials}"};
}

// In free play the number of trials is not planned.
std::string value_of(std::string_view placeholder, const Page& page) {
    if (placeholder == "{trial}") return std::to_string(page.trial);
    if (placeholder == "{trials}") return page.trials == 0 ? "?" : std::to_string(page.trials);
    if (placeholder == "{break_s}") return std::to_string(whole_seconds(page));
    return break_time(page);
}

struct Piece {
    std::string_view text;
    bool placeholder = false;  // with its braces
};

// The piece at the beginning of `words`, taken off it. An empty one: a brace stands alone there.
Piece take_piece(std::string_view& words) {
    std::size_t length = std::min(words.find_first_of("{}"), words.size());
    Piece piece{words.substr(0, length)};
    if (length == 0 && words.size() > 1 && words[1] == words[0]) {
        piece.text = words.substr(0, 1);
        length = 2;
    } else if (length == 0) {
        const std::size_t end = words.find_first_of("{}", 1);
        if (words[0] == '}' || end == std::string_view::npos || words[end] == '{') return {};
        length = end + 1;
        piece = {words.substr(0, length), true};
    }
    words.remove_prefix(length);
    return piece;
}

void check(const ConfigTable& table, const std::string& key, std::string_view words, PageKind kind) {
    const auto known = placeholders_of(kind);
    while (!words.empty()) {
        const Piece piece = take_piece(words);
        if (piece.text.empty()) table.fail(key, "has a single brace: write {{ or }} for a brace");
        if (!piece.placeholder || std::find(known.begin(), known.end(), piece.text) != known.end()) continue;
        table.fail(key, "has the placeholder {}; this page has {}", piece.text,
                   known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", ")));
    }
}

std::optional<std::string> read_words(const ConfigTable& table, const std::string& key, PageKind kind,
                                      std::string_view help) {
    auto words = read_page_text(table, key, help);
    if (words) check(table, key, *words, kind);
    return words;
}

struct Range {
    char32_t first, last;
};
// Hebrew to Arabic Extended, their presentation forms, ancient and African scripts, and the marks and overrides of direction.
constexpr std::array<Range, 9> kRightToLeft{{{0x0590, 0x08FF},
                                             {0x200F, 0x200F},
                                             {0x202B, 0x202B},
                                             {0x202E, 0x202E},
                                             {0x2067, 0x2067},
                                             {0xFB1D, 0xFDFF},
                                             {0xFE70, 0xFEFE},
                                             {0x10800, 0x10FFF},
                                             {0x1E800, 0x1EFFF}}};

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool has_word(std::string_view text, std::string_view word) {
    for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        if ((at == 0 || !is_letter(text[at - 1])) && (end == text.size() || !is_letter(text[end])))
            return true;
    }
    return false;
}

}  // namespace

std::string Instructions::text() const {
    std::string all;
    for (const PageWords& page : pages) all += page.title.value_or("") + "\n" + page.body.value_or("") + "\n";
    return all + go_on.value_or("");
}

char32_t take_character(std::string_view& text) {
    const auto lead = static_cast<unsigned char>(text[0]);
    const std::size_t length = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
    char32_t character = length == 1 ? lead : lead & (0x7FU >> length);
    for (std::size_t i = 1; i < std::min(length, text.size()); ++i)
        character = (character << 6U) | (static_cast<unsigned char>(text[i]) & 0x3FU);
    text.remove_prefix(std::min(length, text.size()));
    return character;
}

char32_t right_to_left(std::string_view text) {
    while (!text.empty()) {
        const char32_t character = take_character(text);
        const bool found = std::any_of(kRightToLeft.begin(), kRightToLeft.end(), [&](const Range& range) {
            return character >= range.first && character <= range.last;
        });
        if (found) return character;
    }
    return 0;
}

void refuse_right_to_left(const ConfigTable& table, const std::string& key, std::string_view text) {
    const char32_t character = right_to_left(text);
    if (character == 0) return;
    table.fail(key,
               "holds U+{:04X}, from a script that is written from right to left: the window draws every "
               "line from left to right, so it would be unreadable. Use another language",
               static_cast<unsigned>(character));
}

std::optional<std::string> read_page_text(const ConfigTable& table, const std::string& key,
                                          std::string_view help) {
    std::string words;
    table.read(key, words, help);
    if (!table.has(key)) return std::nullopt;
    refuse_right_to_left(table, key, words);
    return words;
}

Instructions read_instructions(const ConfigTable& table, Instructions instructions) {
    for (std::size_t i = 1; i < kPageKinds; ++i) {
        const std::string name = kPageNames[i];
        const auto kind = static_cast<PageKind>(i);
        PageWords& words = instructions.pages[i];
        auto title =
            read_words(table, name + "_title", kind, "Title of the page, instead of the built-in one.");
        auto body = read_words(table, name, kind,
                               "Text of the page, instead of the built-in one; it may have several lines.");
        if (title) words.title = std::move(title);
        if (body) words.body = std::move(body);
    }
    auto go_on = read_page_text(table, "go_on",
                                "Text below welcome, practice and ready with next_by = \"subject\": how to "
                                "continue.");
    if (go_on) instructions.go_on = std::move(go_on);
    return instructions;
}

std::string fill_in(std::string_view words, const Page& page) {
    std::string filled;
    while (!words.empty()) {
        const Piece piece = take_piece(words);
        if (piece.text.empty()) break;  // nothing that read_instructions() lets through
        filled += piece.placeholder ? value_of(piece.text, page) : std::string(piece.text);
    }
    return filled;
}

std::string break_time(const Page& page) {
    const long left_s = whole_seconds(page);
    return fmt::format("{}:{:02}", left_s / 60, left_s % 60);
}

std::vector<std::string> named_modalities(const Instructions& instructions) {
    std::vector<std::string> found;
    for (std::size_t i = 1; i < kPageKinds; ++i) {
        const PageWords& words = instructions.pages[i];
        const std::string text = words.title.value_or("") + "\n" + words.body.value_or("");
        for (const Modality modality : kModalities) {
            if (!has_word(text, to_string(modality))) continue;
            found.push_back(fmt::format("[instructions] {} names {}: a subject must not know the modality",
                                        kPageNames[i], to_string(modality)));
        }
    }
    return found;
}

}  // namespace thimble
