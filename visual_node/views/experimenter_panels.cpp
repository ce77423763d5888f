#include "visual_node/views/experimenter_panels.hpp"

#include <cmath>
#include <string_view>

#include "visual_node/views/drawing.hpp"
#include "visual_node/views/monitor_text.hpp"
#include "visual_node/views/panels.hpp"
#include "visual_node/window/captions.hpp"

namespace thimble {
namespace {

struct ControlGrid {
    Rect area;  // moves with the scroll bar
    double scale = 1;
    ExperimenterModel& model;
    SessionTime now;

    Rect cell(int row, int column, int columns) const {
        return control_cell(area, scale, row, column, columns);
    }
    void button(Command command, int row, int column, int columns, bool chosen = false,
                const char* name = nullptr) const {
        if (draw_button(experimenter_keys(), command, cell(row, column, columns), chosen, name)) {
            model.press(now, command);
        }
    }
};

void draw_delay_rows(const ControlGrid& grid) {
    double delay_s = grid.model.link().delay_s();
    if (draw_delay_slider(grid.cell(kSliderRow, 0, 1), delay_s)) grid.model.set_delay(grid.now, delay_s);
    for (int i = 0; i < static_cast<int>(kOfferedNetworks.size()); ++i) {
        const auto command = static_cast<Command>(static_cast<int>(Command::kNetwork0) + i);
        grid.button(command, kNetworkRow + i / kNetworksPerRow, i % kNetworksPerRow, kNetworksPerRow,
                    grid.model.link().holds(command));
    }
    grid.button(Command::kDelayDown, kStepRow, 0, 2);
    grid.button(Command::kDelayUp, kStepRow, 1, 2);
}

void draw_trial_rows(const ControlGrid& grid) {
    for (const Modality modality : kModalities) {
        grid.button(command_of(modality), kModalityRow, static_cast<int>(modality), 4,
                    modality == grid.model.chosen());
    }
    const bool paused = grid.model.link().monitor().paused;
    grid.button(Command::kStart, kTrialRow, 0, 3);
    grid.button(Command::kPause, kTrialRow, 1, 3, paused, paused ? "Go on" : "Pause");
    grid.button(Command::kEndTrial, kTrialRow, 2, 3);
    grid.button(Command::kRepeat, kAfterRow, 0, 3);
    grid.button(Command::kExclude, kAfterRow, 1, 3);
    grid.button(Command::kHelp, kAfterRow, 2, 3, grid.model.help());
}

}  // namespace

void ExperimenterPanels::draw_banner(const Rect& rect, double scale, SessionTime now) const {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const SessionLink& link = model_.link();
    const TextLine alarm = link.alarm(now);
    const bool alarmed = !alarm.view().empty();
    // Over the rod of the needle, too, which leaves the scene upwards.
    list.AddRectFilled(corner(rect), far_corner(rect), paint(alarmed ? kVermillion : kBackground));
    const TextLine calm =
        TextLine::of("Trial {}, {}, {}", trial_text(link.receiver().trial(), link.monitor().trials).view(),
                     to_string(link.monitor().modality), state_text(link.monitor()).view());
    const double middle = rect.y + (rect.height - static_cast<double>(ImGui::GetFontSize())) / 2;
    list.AddText(point(8 * scale, std::floor(middle)), paint(alarmed ? kBlack : kWhite),
                 alarmed ? alarm.c_str() : calm.c_str());
}

// Below the banner, over scene and plots: in as many lines as the device's words take.
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
    if (const auto seen = scene()) draw_over_cutaway(*seen, plan_cutaway(layout.scene));
    for (std::size_t i = 0; i < kPlotCount; ++i) {
        plots_[i].draw(list, layout.plots[i], scale, experimenter_plots()[i], link.history(), now);
    }
    draw_fault({0, layout.scene.y, layout.readings.x, layout.scene.height}, scale);
    draw_readings(layout.readings, link, now);
    draw_controls(layout.controls, scale, model_, now);
    draw_question(scale, model_, now);
    if (stops_ != nullptr) draw_stop_strip(*stops_, layout.stop, scale, now);
    const Rect keys{0, 0, layout.banner.width, layout.stop.y};
    if (model_.help()) draw_key_help(experimenter_keys(), keys, scale);
}

void draw_controls(const Rect& rect, double scale, ExperimenterModel& model, SessionTime now) {
    begin_fixed("controls", rect, Ground::kBare);
    ImGui::SetWindowFontScale(0.9F);  // four modalities beside one another
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, point(2 * scale, 2 * scale));
    const ControlGrid grid{
        {rect.x, rect.y - static_cast<double>(ImGui::GetScrollY()), rect.width, rect.height},
        scale,
        model,
        now};
    draw_delay_rows(grid);
    draw_trial_rows(grid);
    ImGui::SetCursorScreenPos(corner(grid.cell(kNoticeRow, 0, 1)));
    const bool asking = model.link().orders().asking();
    const TextLine notice = model.notice();
    ImGui::TextUnformatted(asking && notice.view().empty() ? "waiting for the session" : notice.c_str());
    ImGui::PopStyleVar();
    ImGui::End();
}

void draw_question(double scale, ExperimenterModel& model, SessionTime now) {
    const auto trial = model.question();
    if (!trial) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const double width = 420 * scale, height = 84 * scale;
    const Rect rect{(static_cast<double>(display.x) - width) / 2,
                    (static_cast<double>(display.y) - height) / 2, width, height};
    ImGui::SetNextWindowFocus();
    begin_fixed("question", rect, Ground::kFilled);
    ImGui::Text("Exclude trial %u from the analysis?", *trial);
    if (draw_button(experimenter_keys(), Command::kYes, control_cell(rect, scale, 1, 0, 2))) {
        model.press(now, Command::kYes);
    }
    if (draw_button(experimenter_keys(), Command::kNo, control_cell(rect, scale, 1, 1, 2))) {
        model.press(now, Command::kNo);
    }
    ImGui::End();
}

}  // namespace thimble
