#include "visual_node/views/key_input.hpp"

#include <algorithm>
#include <cmath>

#include "visual_node/views/drawing.hpp"

namespace thimble {
namespace {

void add(TypedCommands& typed, std::span<const Key> keys, Command command) {
    const bool known =
        std::any_of(keys.begin(), keys.end(), [&](const Key& key) { return key.command == command; });
    if (known && typed.count < typed.commands.size()) typed.commands[typed.count++] = command;
}

TextLine key_name(const Key& key) {
    return key.character == ' ' ? TextLine::of("Space") : TextLine::of("{}", key.character);
}

bool pressed(ImGuiKey_ key) { return ImGui::IsKeyPressed(ImGui::GetKeyIndex(key)); }

}  // namespace

TypedCommands typed_commands(std::span<const Key> keys) {
    TypedCommands typed;
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput) return typed;
    for (const ImWchar character : io.InputQueueCharacters) {
        if (const auto command = find_command(keys, character)) add(typed, keys, *command);
    }
    if (pressed(ImGuiKey_LeftArrow)) add(typed, keys, Command::kDelayDown);
    if (pressed(ImGuiKey_RightArrow)) add(typed, keys, Command::kDelayUp);
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
    const TextLine label =
        TextLine::of("{} [{}]##{}", name == nullptr ? key.button : name, key_name(key).view(), key.button);
    const bool hit = ImGui::Button(label.c_str(), extent(cell));
    if (chosen) ImGui::PopStyleColor(2);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", key.help);
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

void draw_key_help(std::span<const Key> keys, double scale) {
    const ImVec2 middle{ImGui::GetIO().DisplaySize.x / 2, ImGui::GetIO().DisplaySize.y / 2};
    ImGui::SetNextWindowPos(middle, ImGuiCond_Always, {0.5F, 0.5F});
    ImGui::SetNextWindowFocus();
    ImGui::Begin("Keys", nullptr,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings);
    for (const Key& key : keys) {
        ImGui::TextColored(gui_colour(kOrange), "%s", key_name(key).c_str());
        ImGui::SameLine(static_cast<float>(64 * scale));
        ImGui::Text("%s", key.button);
        ImGui::SameLine(static_cast<float>(180 * scale));
        ImGui::TextUnformatted(key.help);
    }
    ImGui::TextUnformatted("A preset sets the delay alone; jitter and loss stay the session file's.");
    ImGui::End();
}

}  // namespace thimble
