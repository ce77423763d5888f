#include "visual_node/views/drawing.hpp"

#include <cmath>

namespace thimble {
namespace {

// Of ImGui's text, which is meant to be read at arm's length.
constexpr float kSmallText = 0.8F;

float small_text_size() { return std::floor(ImGui::GetFontSize() * kSmallText); }

}  // namespace

ImU32 paint(Colour colour, double opacity) {
    return IM_COL32(colour[0], colour[1], colour[2], static_cast<int>(std::lround(255 * opacity)));
}

ImVec4 gui_colour(Colour colour) { return ImGui::ColorConvertU32ToFloat4(paint(colour)); }

ImVec2 point(double x, double y) { return {static_cast<float>(x), static_cast<float>(y)}; }
ImVec2 corner(const Rect& rect) { return point(rect.x, rect.y); }
ImVec2 far_corner(const Rect& rect) { return point(rect.right(), rect.bottom()); }
ImVec2 extent(const Rect& rect) { return point(rect.width, rect.height); }

double small_text_height() { return static_cast<double>(small_text_size()); }

double draw_text(ImDrawList& list, const ImVec2& where, Colour colour, const char* text) {
    const float size = small_text_size();
    list.AddText(ImGui::GetFont(), size, where, paint(colour), text);
    return static_cast<double>(ImGui::GetFont()->CalcTextSizeA(size, FLT_MAX, 0, text).x);
}

void draw_text_left_of(ImDrawList& list, const ImVec2& where, Colour colour, const char* text) {
    const float size = small_text_size();
    const float width = ImGui::GetFont()->CalcTextSizeA(size, FLT_MAX, 0, text).x;
    list.AddText(ImGui::GetFont(), size, {std::floor(where.x - width), where.y}, paint(colour), text);
}

void draw_dashed_vertical(ImDrawList& list, double x, double top, double bottom, double width, double dash,
                          Colour colour) {
    const double left = std::floor(x - width / 2);
    for (double y = top; y < bottom; y += 2 * dash) {
        list.AddRectFilled(point(left, y), point(left + width, std::min(y + dash, bottom)), paint(colour));
    }
}

void begin_fixed(const char* name, const Rect& rect, Ground ground) {
    constexpr ImGuiWindowFlags kFixed =
        ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
        ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;
    ImGui::SetNextWindowPos(corner(rect));
    ImGui::SetNextWindowSize(extent(rect));
    ImGui::Begin(name, nullptr, ground == Ground::kBare ? kFixed | ImGuiWindowFlags_NoBackground : kFixed);
}

}  // namespace thimble
