#include "visual_node/views/player_panel.hpp"

#include <algorithm>
#include <string_view>

#include "visual_node/views/drawing.hpp"
#include "visual_node/views/monitor_text.hpp"
#include "visual_node/views/panels.hpp"

namespace thimble {
namespace {

// Pixels at content scale 1.
constexpr double kPanelWidth = 330, kRow = 30, kPlotHeight = 90;

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
    text_in(kSkyBlue, "How far away is the needle?");
    double delay_s = model_.link().delay_s();
    if (draw_delay_slider(row_here(kRow * scale), delay_s)) model_.set_delay(now, delay_s);
    draw_row({Command::kDelayDown, Command::kDelayUp}, scale, now);
    draw_row({Command::kNetwork0, Command::kNetwork1}, scale, now);
    draw_row({Command::kNetwork2, Command::kNetwork3}, scale, now);
    draw_row({Command::kNetwork4, Command::kNetwork5}, scale, now);
}

void PlayerPanel::draw_modalities(double scale, SessionTime now) {
    const Command chosen = command_of(model_.modality());
    text_in(kSkyBlue, "How do you feel the force?");
    for (const Modality modality : kModalities) {
        const Command command = command_of(modality);
        const Rect cell = row_here((kRow - 2) * scale);
        if (draw_button(player_keys(), command, cell, command == chosen)) model_.press(now, command);
    }
    text_in(kWhite, key_of(player_keys(), chosen).help);
    draw_row({Command::kStart, Command::kPause, Command::kEndTrial}, scale, now);
}

void PlayerPanel::draw_plot(double scale, SessionTime now) {
    // The plot fills the panel down to the two rows beneath it.
    const double left = static_cast<double>(ImGui::GetContentRegionAvail().y) - 2.2 * kRow * scale;
    const Rect rect = row_here(std::max(kPlotHeight * scale, left));
    plot_.draw(*ImGui::GetWindowDrawList(), rect, scale, player_plot(), model_.link().history(), now);
    ImGui::Dummy(extent(rect));
}

// An alarm and a device fault, if there are any.
void PlayerPanel::draw_words(SessionTime now) const {
    const TextLine alarm = model_.link().alarm(now);
    if (!alarm.view().empty()) text_in(kVermillion, alarm.view());
    const std::string_view fault = model_.link().receiver().fault();
    if (!fault.empty()) text_in(kVermillion, fault);
}

void PlayerPanel::draw_rows(double scale, SessionTime now) {
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, point(2 * scale, 2 * scale));
    if (model_.replaying()) {
        draw_replay(model_.replay(), model_.link().monitor(), scale, now);
        draw_plot(scale, now);
    } else {
        draw_modalities(scale, now);
        draw_delay(scale, now);
        draw_plot(scale, now);
        ImGui::Text("round trip: %s", round_trip_text(model_.link().monitor().round_trip_s).c_str());
    }
    const Rect row = row_here((kRow - 4) * scale);
    if (draw_button(model_.keys(), Command::kHelp, row, model_.help())) model_.press(now, Command::kHelp);
    ImGui::PopStyleVar();
}

// At the scene's left, where the needle never is.
void PlayerPanel::draw_hint(const Rect& scene, double scale) const {
    constexpr float kLarger = 1.25F;
    const double margin = 10 * scale, width = 0.36 * scene.width;
    const Rect box{scene.x + 20 * scale, scene.y + 64 * scale, width, 0};
    ImFont* const font = ImGui::GetFont();
    const float size = kLarger * ImGui::GetFontSize(), wrap = static_cast<float>(width - 2 * margin);
    const bool stopped = stops_ != nullptr && stops_->holds();
    const char* const text =
        stopped ? "Everything is stopped. To continue, hold the yellow button at the lower right for 1 s."
                : model_.hint();
    const ImVec2 extent = font->CalcTextSizeA(size, FLT_MAX, wrap, text);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddRectFilled(corner(box), point(box.right(), box.y + static_cast<double>(extent.y) + 2 * margin),
                       paint(kBackground, 0.8), static_cast<float>(margin));
    list.AddText(font, size, point(box.x + margin, box.y + margin), paint(kYellow), text, nullptr, wrap);
}

void PlayerPanel::draw(SessionTime now, const OverlayFrame& frame) {
    for (const Command command : typed_commands(model_.keys())) model_.press(now, command);
    model_.set_hand(frame.hand_holds, frame.hand_kind);
    const double scale = frame.window.content_scale(), height = frame.window.height();
    const Rect panel = place(frame.window.width(), height, scale);
    const Rect scene{0, 0, panel.x, height};
    const double strip = stops_ != nullptr && !model_.replaying() ? kStopHeight * scale : 0;
    draw_hint(scene, scale);
    begin_fixed("player", {panel.x, panel.y, panel.width, panel.height - strip}, Ground::kFilled);
    draw_words(now);
    draw_rows(scale, now);
    ImGui::End();
    if (strip > 0)
        draw_stop_strip(*stops_, {panel.x, panel.bottom() - strip, panel.width, strip}, scale, now);
    if (model_.help()) draw_key_help(model_.keys(), scene, scale);
}

PlayerOverlay::PlayerOverlay(std::uint64_t instance, const NetworkSettings& network)
    : sockets_(network),
      link_(sockets_.between(Port::kPlayerMonitor, Port::kSessionPlayerOrders)),
      stops_(instance + 1, stop_outlets(sockets_)),
      panel_(instance, {link_, link_}, &stops_) {}

void PlayerOverlay::tick(SessionTime now) {
    sockets_.tick(now);
    stops_.tick(now);
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
