#include "visual_node/views/experimenter_panels.hpp"

#include <cmath>
#include <string_view>

#include "visual_node/views/controls_panel.hpp"
#include "visual_node/views/drawing.hpp"
#include "visual_node/views/key_input.hpp"
#include "visual_node/views/monitor_text.hpp"
#include "visual_node/views/readings_panel.hpp"
#include "visual_node/views/side_view.hpp"

namespace thimble {

void ExperimenterPanels::draw_banner(const Rect& rect, double scale, SessionTime now) const {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const SessionLink& link = model_.link();
    const TextLine alarm = link.alarm(now);
    const bool alarmed = !alarm.view().empty();
    if (alarmed) list.AddRectFilled(corner(rect), far_corner(rect), paint(kVermillion));
    const TextLine calm =
        TextLine::of("Trial {}, {}, {}", trial_text(link.receiver().trial(), link.monitor().trials).view(),
                     to_string(link.monitor().modality), state_text(link.monitor()).view());
    const double middle = rect.y + (rect.height - static_cast<double>(ImGui::GetFontSize())) / 2;
    list.AddText(point(8 * scale, std::floor(middle)), paint(alarmed ? kBlack : kWhite),
                 alarmed ? alarm.c_str() : calm.c_str());
}

// Below the banner, over the side view: in as many lines as the device's words take.
void ExperimenterPanels::draw_fault(const Rect& rect, double scale) const {
    const std::string_view words = model_.link().receiver().fault();
    if (words.empty()) return;
    const double margin = 8 * scale;
    const auto wrap = static_cast<float>(rect.width - 2 * margin);
    const char* const end = words.data() + words.size();
    const ImVec2 size = ImGui::CalcTextSize(words.data(), end, false, wrap);
    const Rect box{rect.x, rect.y, rect.width, static_cast<double>(size.y) + margin};
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddRectFilled(corner(box), far_corner(box), paint(kVermillion));
    list.AddText(ImGui::GetFont(), ImGui::GetFontSize(),
                 point(box.x + margin, std::floor(box.y + margin / 2)), paint(kBlack), words.data(), end,
                 wrap);
}

void ExperimenterPanels::draw(SessionTime now, const OverlayFrame& frame) {
    for (const Command command : typed_commands(experimenter_keys())) model_.press(now, command);
    const double scale = frame.window.content_scale();
    const ExperimenterLayout layout = experimenter_layout(frame.window.width(), frame.window.height(), scale);
    const SessionLink& link = model_.link();
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    draw_banner(layout.banner, scale, now);
    if (link.receiver().heard()) draw_side_view(list, layout.side_view, scale, link.monitor());
    for (std::size_t i = 0; i < kPlotCount; ++i) {
        plots_[i].draw(list, layout.plots[i], scale, experimenter_plots()[i], link.history(), now);
    }
    draw_fault(layout.side_view, scale);
    draw_readings(layout.readings, link, now);
    draw_controls(layout.controls, scale, model_, now);
    draw_question(scale, model_, now);
    if (model_.help()) draw_key_help(experimenter_keys(), scale);
}

}  // namespace thimble
