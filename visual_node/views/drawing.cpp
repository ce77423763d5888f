#include "visual_node/views/drawing.hpp"

#include <algorithm>
#include <cmath>

namespace thimble {
namespace {

// Of ImGui's text, which is meant to be read at arm's length.
constexpr float kSmallText = 0.8F;

float small_text_size() { return std::floor(ImGui::GetFontSize() * kSmallText); }

void add(TypedCommands& typed, std::span<const Key> keys, Command command) {
    const bool known =
        std::any_of(keys.begin(), keys.end(), [&](const Key& key) { return key.command == command; });
    if (known && typed.count < typed.commands.size()) typed.commands[typed.count++] = command;
}

TextLine key_name(const Key& key) {
    const std::string_view special = special_key_name(key.character);
    return special.empty() ? TextLine::of("{}", key.character) : TextLine::of("{}", special);
}

bool pressed(ImGuiKey_ key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key)); }

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

TypedCommands typed_commands(std::span<const Key> keys) {
    TypedCommands typed;
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput) return typed;
    for (const ImWchar character : io.InputQueueCharacters) {
        if (const auto command = find_command(keys, character)) add(typed, keys, *command);
    }
    const auto type = [&](ImGuiKey_ key, char special, Command otherwise) {
        if (pressed(key))
            add(typed, keys, find_command(keys, static_cast<unsigned>(special)).value_or(otherwise));
    };
    type(ImGuiKey_LeftArrow, io.KeyShift ? kShiftLeftKey : kLeftKey, Command::kDelayDown);
    type(ImGuiKey_RightArrow, io.KeyShift ? kShiftRightKey : kRightKey, Command::kDelayUp);
    type(ImGuiKey_Home, kHomeKey, Command::kCount);
    type(ImGuiKey_End, kEndKey, Command::kCount);
    if (pressed(ImGuiKey_Escape)) add(typed, keys, Command::kNo);
    return typed;
}

bool draw_button(std::span<const Key> keys, Command command, const Rect& cell, bool chosen,
                 const char* name) {
    const Key& key = key_of(keys, command);
    ImGui::SetCursorScreenPos(corner(cell));
    if (chosen) {
        ImGui::PushStyleColor(ImGuiCol_Button, gui_colour(kBlue));
        ImGui::PushStyleColor(ImGuiCol_ButtonHovered, gui_colour(kBlue));
    }
    // Arrows and the like are named in the help only: their names are longer than the buttons.
    const char* shown = name == nullptr ? key.button : name;
    const bool plain = special_key_name(key.character).empty() || key.character == ' ';
    const int id = static_cast<int>(command);
    const TextLine label = plain ? TextLine::of("{} [{}]##{}", shown, key_name(key).view(), id)
                                 : TextLine::of("{}##{}", shown, id);
    const bool hit = ImGui::Button(label.c_str(), extent(cell));
    if (chosen) ImGui::PopStyleColor(2);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", key.help);
    return hit;
}

Rect row_here(double height) {
    const ImVec2 here = ImGui::GetCursorScreenPos();
    return {static_cast<double>(here.x), static_cast<double>(here.y),
            static_cast<double>(ImGui::GetContentRegionAvail().x), height};
}

std::optional<Command> draw_button_row(std::span<const Key> keys, std::initializer_list<Command> commands,
                                       const Rect& row, double scale,
                                       const std::function<bool(Command)>& chosen) {
    std::optional<Command> hit;
    ImGui::SetWindowFontScale(0.9F);  // four beside one another
    const double pitch = row.width / static_cast<double>(commands.size());
    Rect cell{row.x, row.y, pitch - 2 * scale, row.height - 4 * scale};
    for (const Command command : commands) {
        if (draw_button(keys, command, cell, chosen && chosen(command))) hit = command;
        cell.x += pitch;
    }
    ImGui::SetWindowFontScale(1);
    return hit;
}

bool draw_delay_slider(const Rect& cell, double& delay_s) {
    ImGui::SetCursorScreenPos(corner(cell));
    ImGui::SetNextItemWidth(static_cast<float>(cell.width));
    auto delay_ms = static_cast<float>(delay_s * 1e3);
    const bool moved = ImGui::SliderFloat("##delay", &delay_ms, 0, static_cast<float>(kDelayLimit_s * 1e3),
                                          "delay %.0f ms", ImGuiSliderFlags_AlwaysClamp);
    if (moved) delay_s = std::round(static_cast<double>(delay_ms)) * 1e-3;
    return moved;
}

void draw_key_help(std::span<const Key> keys, const Rect& area, double scale) {
    ImGui::SetNextWindowPos(point(area.x + area.width / 2, area.y + area.height / 2), ImGuiCond_Always,
                            {0.5F, 0.5F});
    ImGui::SetNextWindowSizeConstraints({0, 0}, extent(area));
    ImGui::SetNextWindowFocus();
    ImGui::Begin("Keys", nullptr,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings);
    for (const Key& key : keys) {
        ImGui::TextColored(gui_colour(kOrange), "%s", key_name(key).c_str());
        ImGui::SameLine(static_cast<float>(90 * scale));
        ImGui::Text("%s", key.button);
        ImGui::SameLine(static_cast<float>(236 * scale));
        ImGui::TextUnformatted(key.help);
    }
    ImGui::TextColored(gui_colour(kOrange), "Backspace: EMERGENCY STOP");
    const bool player = std::none_of(keys.begin(), keys.end(),
                                     [](const Key& key) { return key.command == Command::kRepeat; });
    if (player) ImGui::TextUnformatted("Esc: release needle. F2: times. F12: save picture. F10: end.");
    ImGui::End();
}

void draw_stop_strip(StopControl& stops, const Rect& strip, double scale, SessionTime now) {
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});  // no scroll bar
    begin_fixed("stop", strip, Ground::kFilled);
    ImGui::PopStyleVar();
    const bool holds = stops.holds();
    const Colour colour = holds ? kYellow : kVermillion;
    const Rect cell{strip.x + 6 * scale, strip.y + 6 * scale, strip.width - 12 * scale,
                    strip.height - 12 * scale};
    ImGui::SetCursorScreenPos(corner(cell));
    for (const ImGuiCol_ part : {ImGuiCol_Button, ImGuiCol_ButtonHovered, ImGuiCol_ButtonActive})
        ImGui::PushStyleColor(part, paint(colour));
    ImGui::PushStyleColor(ImGuiCol_Text, paint(kBlack));
    ImGui::Button(holds ? "STOPPED: no force\nhold for 1 s to release###stop" : "STOP  [Backspace]###stop",
                  extent(cell));
    ImGui::PopStyleColor(4);
    const double near = stops.press(now, ImGui::IsItemActive(), "the stop button of a view");
    if (near > 0) {
        const double bottom = cell.bottom(), high = 6 * scale;
        ImGui::GetWindowDrawList()->AddRectFilled(point(cell.x, bottom - high),
                                                  point(cell.x + near * cell.width, bottom), paint(kBlue));
    }
    ImGui::End();
}

}  // namespace thimble
