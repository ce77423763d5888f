#include "visual_node/views/readings_panel.hpp"

#include "visual_node/views/drawing.hpp"
#include "visual_node/views/energy.hpp"
#include "visual_node/views/monitor_text.hpp"

namespace thimble {
namespace {

constexpr double kNameShare = 0.32;   // of the panel's width
constexpr double kLineHeight = 1.25;  // of the text's

void draw_reading(ImDrawList& list, const Rect& line, const char* name, const char* value, Colour colour) {
    draw_text_left_of(list, point(line.x + line.width * kNameShare, line.y), kSkyBlue, name);
    draw_text(list, point(line.x + line.width * kNameShare + line.height / 2, line.y), colour, value);
}

Colour colour_of(const Reading& reading, const Monitor& monitor) {
    const bool energy = std::string_view(reading.name) == "port energy";
    return energy && judge_energy(monitor.energy_in_J) == EnergyBalance::kActive ? kOrange : kWhite;
}

}  // namespace

void draw_readings(const Rect& rect, const SessionLink& link, SessionTime now) {
    begin_fixed("readings", rect, Ground::kBare);
    const bool silent = link.receiver().silent(now);
    const double height = small_text_height() * kLineHeight;
    const ImVec2 begin = ImGui::GetCursorScreenPos();
    Rect line{static_cast<double>(begin.x), static_cast<double>(begin.y), rect.width, height};
    ImDrawList& list = *ImGui::GetWindowDrawList();
    draw_reading(list, line, "age", age_text(link.receiver().age(now)).c_str(),
                 silent ? kVermillion : kWhite);
    for (const Reading& reading : read_monitor(link.monitor(), link.receiver().trial())) {
        line.y += height;
        draw_reading(list, line, reading.name, reading.value.c_str(),
                     silent ? kFaded : colour_of(reading, link.monitor()));
    }
    // What is drawn by hand takes its room here, or a small window would not scroll.
    ImGui::Dummy(point(1, line.bottom() - static_cast<double>(begin.y)));
    ImGui::End();
}

}  // namespace thimble
