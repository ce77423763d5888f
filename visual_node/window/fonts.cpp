#include "visual_node/window/fonts.hpp"

#include <filesystem>
#include <imgui.h>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/error.hpp"

namespace thimble {
namespace {

constexpr float kText_px = 16;  // at content scale 1
constexpr float kLargeText_px = 32;
// Debian's fonts-dejavu-core. Without it ImGui's own font, of 13 pixels and thus coarse when enlarged.
constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

ImVector<ImWchar> ranges_of(ImFontAtlas& atlas, const std::string& text) {
    ImFontGlyphRangesBuilder builder;
    builder.AddRanges(atlas.GetGlyphRangesDefault());
    builder.AddText(text.c_str());
    ImVector<ImWchar> ranges;
    builder.BuildRanges(&ranges);
    return ranges;
}

ImFont* add_font(ImFontAtlas& atlas, float size_px, const ImVector<ImWchar>& ranges) {
    if (std::filesystem::exists(kFont)) return atlas.AddFontFromFileTTF(kFont, size_px, nullptr, ranges.Data);
    ImFontConfig own;
    own.SizePixels = size_px;
    return atlas.AddFontDefault(&own);
}

// ImGui's own reader makes U+FFFD of what is too large for its characters.
std::set<unsigned> characters_of(const std::string& text) {
    std::set<unsigned> characters;
    const char* const end = text.data() + text.size();
    for (const char* at = text.data(); at < end;) {
        const auto lead = static_cast<unsigned char>(*at);
        const int length = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
        unsigned character = length == 1 ? lead : lead & (0x7FU >> length);
        for (int i = 1; i < length && at + i < end; ++i)
            character = (character << 6U) | (static_cast<unsigned char>(at[i]) & 0x3FU);
        characters.insert(character);
        at += length;
    }
    return characters;
}

}  // namespace

Fonts build_fonts(ImFontAtlas& atlas, double content_scale, const std::string& text) {
    const auto scale = static_cast<float>(content_scale);
    const ImVector<ImWchar> ranges =
        ranges_of(atlas, text);  // the atlas keeps a pointer to them until it is built
    Fonts fonts;
    fonts.plain = add_font(atlas, kText_px * scale, ranges);
    fonts.large = add_font(atlas, kLargeText_px * scale, ranges);
    atlas.Build();
    return fonts;
}

std::string undrawable(const std::string& text) {
    ImFontAtlas atlas;
    const Fonts fonts = build_fonts(atlas, 0.5, text);
    std::vector<std::string> missing;
    for (const unsigned character : characters_of(text)) {
        if (character == '\n') continue;
        const bool known = character <= IM_UNICODE_CODEPOINT_MAX &&
                           fonts.plain->FindGlyphNoFallback(static_cast<ImWchar>(character)) != nullptr;
        if (!known) missing.push_back(fmt::format("U+{:04X}", character));
    }
    return fmt::format("{}", fmt::join(missing, ", "));
}

void check_drawable(const std::string& instructions) {
    const std::string missing = undrawable(instructions);
    if (missing.empty()) return;
    throw Error(ExitCode::kUsage,
                fmt::format("the window's font cannot draw what [instructions] holds: {}. Write it without",
                            missing));
}

}  // namespace thimble
