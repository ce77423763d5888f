#include "visual_node/views/player_panel.hpp"

#include <algorithm>

#include "visual_node/views/drawing.hpp"
#include "visual_node/views/key_input.hpp"
#include "visual_node/views/monitor_text.hpp"

namespace thimble {
namespace {

// Pixels at content scale 1.
constexpr double kPanelWidth = 300, kRow = 30, kPlotHeight = 120;

Rect row_here(double width, double height) {
    const ImVec2 here = ImGui::GetCursorScreenPos();
    return {static_cast<double>(here.x), static_cast<double>(here.y), width, height};
}

double row_width() { return static_cast<double>(ImGui::GetContentRegionAvail().x); }

void text_in(Colour colour, const char* text) {
    ImGui::PushStyleColor(ImGuiCol_Text, gui_colour(colour));
    ImGui::TextWrapped("%s", text);
    ImGui::PopStyleColor();
}

}  // namespace

Rect PlayerPanel::place(double width, double height, double scale) {
    const double panel = std::min(kPanelWidth * scale, width);
    return {width - panel, 0, panel, height};
}

void PlayerPanel::draw_row(std::initializer_list<Command> commands, const Rect& row, double scale,
                           SessionTime now) {
    ImGui::SetWindowFontScale(0.9F);  // four beside one another
    const double pitch = row.width / static_cast<double>(commands.size());
    Rect cell{row.x, row.y, pitch - 2 * scale, row.height - 4 * scale};
    for (const Command command : commands) {
        if (draw_button(player_keys(), command, cell)) model_.press(now, command);
        cell.x += pitch;
    }
    ImGui::SetWindowFontScale(1);
}

void PlayerPanel::draw_delay(const Rect& column, double scale, SessionTime now) {
    double delay_s = model_.link().delay_s();
    if (draw_delay_slider(row_here(column.width, kRow * scale), delay_s)) model_.set_delay(now, delay_s);
    const Rect row = row_here(column.width, kRow * scale);
    draw_row({Command::kDelayDown, Command::kDelayUp, Command::kPreset0, Command::kPreset2}, row, scale, now);
}

void PlayerPanel::draw_modalities(double scale, SessionTime now) {
    for (const Modality modality : kModalities) {
        const Command command = command_of(modality);
        const Rect cell = row_here(row_width(), (kRow - 4) * scale);
        if (draw_button(player_keys(), command, cell, modality == model_.modality()))
            model_.press(now, command);
        ImGui::SetWindowFontScale(0.85F);
        text_in(kWhite, key_of(player_keys(), command).help);
        ImGui::SetWindowFontScale(1);
    }
    const Rect row = row_here(row_width(), kRow * scale);
    draw_row({Command::kStart, Command::kPause, Command::kEndTrial}, row, scale, now);
}

void PlayerPanel::draw_plot(double scale, SessionTime now) {
    const Rect rect = row_here(row_width(), kPlotHeight * scale);
    plot_.draw(*ImGui::GetWindowDrawList(), rect, scale, player_plot(), model_.link().history(), now);
    ImGui::Dummy(extent(rect));
}

void PlayerPanel::draw(SessionTime now, const OverlayFrame& frame) {
    for (const Command command : typed_commands(player_keys())) model_.press(now, command);
    const double scale = frame.window.content_scale();
    const Rect rect = place(frame.window.width(), frame.window.height(), scale);
    begin_fixed("player", rect, Ground::kFilled);
    // Hint and alarm first: they are what is read without looking for it.
    const TextLine alarm = model_.link().alarm(now);
    const bool alarmed = !alarm.view().empty();
    text_in(alarmed ? kVermillion : kYellow, alarmed ? alarm.c_str() : model_.hint(now));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, point(2 * scale, 2 * scale));
    draw_delay({rect.x, rect.y, row_width(), kRow * scale}, scale, now);
    draw_modalities(scale, now);
    draw_plot(scale, now);
    ImGui::Text("round trip: %s", round_trip_text(model_.link().monitor().round_trip_s).c_str());
    if (draw_button(player_keys(), Command::kHelp, row_here(row_width(), (kRow - 4) * scale),
                    model_.help())) {
        model_.press(now, Command::kHelp);
    }
    ImGui::PopStyleVar();
    ImGui::End();
    if (model_.help()) draw_key_help(player_keys(), scale);
}

}  // namespace thimble
