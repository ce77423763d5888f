#include "visual_node/views/player_panel.hpp"

#include <algorithm>
#include <string_view>

#include "visual_node/views/drawing.hpp"
#include "visual_node/views/monitor_text.hpp"
#include "visual_node/views/panels.hpp"

namespace thimble {
namespace {

// Pixels at content scale 1.
constexpr double kPanelWidth = 300, kRow = 30, kPlotHeight = 120;

void text_in(Colour colour, std::string_view text) {
    ImGui::PushStyleColor(ImGuiCol_Text, gui_colour(colour));
    ImGui::TextWrapped("%.*s", static_cast<int>(text.size()), text.data());
    ImGui::PopStyleColor();
}

}  // namespace

Rect PlayerPanel::place(double width, double height, double scale) {
    const double panel = std::min(kPanelWidth * scale, width);
    return {width - panel, 0, panel, height};
}

void PlayerPanel::draw_row(std::initializer_list<Command> commands, double scale, SessionTime now) {
    const auto holds = [this](Command command) { return model_.link().holds(command); };
    const auto hit = draw_button_row(player_keys(), commands, row_here(kRow * scale), scale, holds);
    if (hit) model_.press(now, *hit);
}

void PlayerPanel::draw_delay(double scale, SessionTime now) {
    double delay_s = model_.link().delay_s();
    if (draw_delay_slider(row_here(kRow * scale), delay_s)) model_.set_delay(now, delay_s);
    draw_row({Command::kDelayDown, Command::kDelayUp}, scale, now);
    draw_row({Command::kNetwork0, Command::kNetwork1, Command::kNetwork2}, scale, now);
    draw_row({Command::kNetwork3, Command::kNetwork4, Command::kNetwork5}, scale, now);
}

void PlayerPanel::draw_modalities(double scale, SessionTime now) {
    for (const Modality modality : kModalities) {
        const Command command = command_of(modality);
        const Rect cell = row_here((kRow - 4) * scale);
        if (draw_button(player_keys(), command, cell, modality == model_.modality()))
            model_.press(now, command);
        ImGui::SetWindowFontScale(0.85F);
        text_in(kWhite, key_of(player_keys(), command).help);
        ImGui::SetWindowFontScale(1);
    }
    draw_row({Command::kStart, Command::kPause, Command::kEndTrial}, scale, now);
}

void PlayerPanel::draw_plot(double scale, SessionTime now) {
    const Rect rect = row_here(kPlotHeight * scale);
    plot_.draw(*ImGui::GetWindowDrawList(), rect, scale, player_plot(), model_.link().history(), now);
    ImGui::Dummy(extent(rect));
}

void PlayerPanel::draw(SessionTime now, const OverlayFrame& frame) {
    for (const Command command : typed_commands(model_.keys())) model_.press(now, command);
    const double scale = frame.window.content_scale();
    const Rect rect = place(frame.window.width(), frame.window.height(), scale);
    begin_fixed("player", rect, Ground::kFilled);
    // Hint and alarm first: they are what is read without looking for it.
    const TextLine alarm = model_.link().alarm(now);
    const bool alarmed = !alarm.view().empty();
    text_in(alarmed ? kVermillion : kYellow, alarmed ? alarm.c_str() : model_.hint(now));
    const std::string_view fault = model_.link().receiver().fault();
    if (!fault.empty()) text_in(kVermillion, fault);
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, point(2 * scale, 2 * scale));
    if (model_.replaying()) {
        draw_replay(model_.replay(), model_.link().monitor(), scale, now);
        draw_plot(scale, now);
    } else {
        draw_delay(scale, now);
        draw_modalities(scale, now);
        draw_plot(scale, now);
        ImGui::Text("round trip: %s", round_trip_text(model_.link().monitor().round_trip_s).c_str());
    }
    if (draw_button(model_.keys(), Command::kHelp, row_here((kRow - 4) * scale), model_.help())) {
        model_.press(now, Command::kHelp);
    }
    ImGui::PopStyleVar();
    ImGui::End();
    if (model_.help()) draw_key_help(model_.keys(), scale);
}

PlayerOverlay::PlayerOverlay(std::uint64_t instance, const NetworkSettings& network)
    : sockets_(network),
      link_(sockets_.between(Port::kPlayerMonitor, Port::kSessionPlayerOrders)),
      panel_(instance, {link_, link_}) {}

void PlayerOverlay::tick(SessionTime now) {
    sockets_.tick(now);
    panel_.tick(now);
}

double PlayerOverlay::right_margin(const GlWindow& window) const {
    return PlayerPanel::place(window.width(), window.height(), window.content_scale()).width;
}

// The window is gone before the Monitor can show it, so it is not repeated.
void PlayerOverlay::closing(SessionTime now) {
    for (int i = 0; i < kUnseenOrderTimes; ++i) panel_.quit(now);
}

}  // namespace thimble
