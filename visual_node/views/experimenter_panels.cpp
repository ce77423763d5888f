#include "visual_node/views/experimenter_panels.hpp"

#include <cmath>

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
    draw_readings(layout.readings, link, now);
    draw_controls(layout.controls, scale, model_, now);
    draw_question(scale, model_, now);
    if (model_.help()) draw_key_help(experimenter_keys(), scale);
}

}  // namespace thimble
