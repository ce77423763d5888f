#include "visual_node/views/panels.hpp"

#include <algorithm>
#include <cmath>

#include "visual_node/views/drawing.hpp"
#include "visual_node/views/monitor_text.hpp"

namespace thimble {
namespace {

constexpr double kNameShare = 0.3;    // of the panel's width
constexpr double kLineHeight = 1.15;  // of the text's

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
    // The bars drawn by hand take their room here, or a small window would not scroll.
    ImGui::Dummy(point(1, line.bottom() - static_cast<double>(begin.y)));
    ImGui::End();
}

namespace {

// Pixels at content scale 1.
constexpr double kReplayRow = 30, kScrubHeight = 28, kMarkWidth = 2, kHandleWidth = 5;

void draw_mark(ImDrawList& list, const ScrubScale& scrub, double time_s, double scale, Colour colour) {
    const double width = std::max(1.0, std::floor(kMarkWidth * scale));
    const double x = std::floor(scrub.x(time_s) - width / 2);
    list.AddRectFilled(point(x, scrub.bar.y), point(x + width, scrub.bar.bottom()), paint(colour));
}

void draw_marks(ImDrawList& list, const ScrubScale& scrub, const ReplayState& state, double scale) {
    for (std::size_t i = 0; i < state.changes; ++i) {
        draw_dashed_vertical(list, scrub.x(state.change_s[i]), scrub.bar.y, scrub.bar.bottom(),
                             kMarkWidth * scale, 4 * scale, kSkyBlue);
    }
    if (state.contact_s >= 0) draw_mark(list, scrub, state.contact_s, scale, kBluishGreen);
    if (state.beep_s >= 0) draw_mark(list, scrub, state.beep_s, scale, kYellow);
}

void draw_scrub_bar(ReplayModel& model, double scale, SessionTime now) {
    const Rect row = row_here(kScrubHeight * scale);
    const ScrubScale scrub{row, model.state().duration_s};
    ImGui::InvisibleButton("##scrub", extent(row));
    if (ImGui::IsItemActive()) model.seek(now, scrub.time_s(static_cast<double>(ImGui::GetIO().MousePos.x)));
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(corner(row), far_corner(row), paint(kGrid));
    const double here = scrub.x(model.position_s());
    list.AddRectFilled(corner(row), point(here, row.bottom()), paint(kBlue));
    draw_marks(list, scrub, model.state(), scale);
    const double half = kHandleWidth * scale / 2;
    list.AddRectFilled(point(here - half, row.y), point(here + half, row.bottom()), paint(kWhite));
}

void mark_text(Colour colour, const char* name, double time_s) {
    if (time_s < 0) return;
    ImGui::TextColored(gui_colour(colour), "%s %.2f s", name, time_s);
    ImGui::SameLine();
}

void draw_words(const ReplayModel& model, const Monitor& monitor) {
    const ReplayState& state = model.state();
    ImGui::Text("%.3f of %.3f s, %s", model.position_s(), state.duration_s, to_string(monitor.modality));
    ImGui::SameLine();
    ImGui::Text("%.0f ms %s", monitor.network_delay_s * 1e3,
                TextLine::of("{}", monitor.network.view()).c_str());
    mark_text(kBluishGreen, "contact", state.contact_s);
    mark_text(kYellow, "beep", state.beep_s);
    if (state.changes > 0) {
        ImGui::TextColored(gui_colour(kSkyBlue), "network x%u", state.changes);
    } else {
        ImGui::NewLine();
    }
}

}  // namespace

void draw_replay(ReplayModel& model, const Monitor& monitor, double scale, SessionTime now) {
    draw_scrub_bar(model, scale, now);
    draw_words(model, monitor);
    const auto row = [&](std::initializer_list<Command> commands) {
        const auto chosen = [&](Command command) {
            const auto speed = speed_of(command);
            return speed ? *speed == model.speed() : command == Command::kPlayPause && !model.paused();
        };
        const auto hit =
            draw_button_row(replay_keys(), commands, row_here(kReplayRow * scale), scale, chosen);
        if (hit) model.press(now, *hit);
    };
    row({Command::kFrameBack, Command::kPlayPause, Command::kFrameOn});
    row({Command::kFarBack, Command::kBack, Command::kOn, Command::kFarOn});
    row({Command::kToBegin, Command::kToEnd});
    row({Command::kSpeed0, Command::kSpeed1, Command::kSpeed2});
    row({Command::kSpeed3, Command::kSpeed4, Command::kSpeed5});
}

}  // namespace thimble
