#include "visual_node/views/panels.hpp"

#include <algorithm>
#include <cmath>

#include "visual_node/views/drawing.hpp"
#include "visual_node/views/monitor_text.hpp"

namespace thimble {
namespace {

constexpr double kLine_m = 0.02;  // grid

struct SideFrame {
    SideViewScale z;
    double pixels = 1;
    double middle = 0;  // y of the needle
};

void draw_depths(ImDrawList& list, const SideFrame& frame) {
    const Rect& box = frame.z.box;
    for (double depth_m = frame.z.low_m; depth_m < frame.z.high_m + kLine_m / 2; depth_m += kLine_m) {
        const double x = std::min(std::floor(frame.z.x(depth_m)), box.right() - 1);
        list.AddRectFilled(point(x, box.y), point(x + 1, box.bottom()), paint(kGrid));
        if (depth_m + kLine_m > frame.z.high_m) continue;
        const TextLine number = TextLine::of("{:.0f}", depth_m * 1e3 + 0.0);
        draw_text(list, point(x + 2 * frame.pixels, box.bottom() - small_text_height() - 1), kWhite,
                  number.c_str());
    }
}

// Pressed in by the needle until it breaks; the rest of the surface is drawn where the contact point is as well, because
// nobody models it.
void draw_tissue(ImDrawList& list, const SideFrame& frame, const Monitor& monitor) {
    const Rect& box = frame.z.box;
    const double x = std::clamp(frame.z.x(monitor.position_surface_m), box.x, box.right());
    list.AddRectFilled(point(x, box.y), far_corner(box), paint(kSurfaceOnDark, 0.25));
    const double width = 2 * frame.pixels;
    list.AddRectFilled(point(std::floor(x - width / 2), box.y),
                       point(std::floor(x + width / 2), box.bottom()), paint(kSurfaceOnDark));
}

void draw_needle(ImDrawList& list, const SideFrame& frame, const Monitor& monitor) {
    const Rect& box = frame.z.box;
    const double tip = std::clamp(frame.z.x(monitor.position_needle_m), box.x, box.right());
    const bool inside = monitor.phase == TissuePhase::kPenetrated;
    const double entry = inside ? std::clamp(frame.z.x(monitor.position_surface_m), box.x, tip) : tip;
    const double half = 2 * frame.pixels;
    list.AddRectFilled(point(box.x, frame.middle - half), point(entry, frame.middle + half), paint(kWhite));
    if (inside) {
        list.AddRectFilled(point(entry, frame.middle - half), point(tip, frame.middle + half),
                           paint(kNeedleOnDark));
    }
    const double tip_length = 8 * frame.pixels;
    list.AddTriangleFilled(point(tip - tip_length, frame.middle - 2 * half), point(tip, frame.middle),
                           point(tip - tip_length, frame.middle + 2 * half),
                           paint(inside ? kNeedleOnDark : kWhite));
}

void draw_fixture(ImDrawList& list, const SideFrame& frame, const Monitor& monitor) {
    if (!monitor.fixture_present) return;
    const Rect& box = frame.z.box;
    const double x = frame.z.x(monitor.position_fixture_m);
    draw_dashed_vertical(list, x, box.y, box.bottom(), 3 * frame.pixels, 4 * frame.pixels, kReddishPurple);
    // min(needle, fixture): what the hand feels as if it were there.
    const double proxy_m = std::min(monitor.position_needle_m, monitor.position_fixture_m);
    const double radius = 5 * frame.pixels;
    list.AddCircle(point(frame.z.x(proxy_m), frame.middle), static_cast<float>(radius), paint(kYellow), 16,
                   static_cast<float>(1.5 * frame.pixels));
}

void draw_legend(ImDrawList& list, const Rect& rect, const SideFrame& frame, const Monitor& monitor) {
    struct Entry {
        Colour colour{};
        const char* name = "";
        bool shown = false;
    };
    const double y = frame.z.box.y - small_text_height() - 2;
    double x = rect.x + 8 * frame.pixels;
    x += draw_text(list, point(x, y), kWhite, "side view, mm");
    const bool inside = monitor.phase == TissuePhase::kPenetrated;
    for (const Entry& entry :
         {Entry{kSurfaceOnDark, "surface", true}, Entry{kNeedleOnDark, "inserted", inside},
          Entry{kReddishPurple, "fixture", monitor.fixture_present},
          Entry{kYellow, "god-object", monitor.fixture_present}}) {
        if (!entry.shown) continue;
        x += 16 * frame.pixels;
        x += draw_text(list, point(x, y), entry.colour, entry.name);
    }
}

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

void draw_side_view(ImDrawList& list, const Rect& rect, double scale, const Monitor& monitor) {
    SideFrame frame;
    const double deepest_m = std::max(monitor.position_surface_m, monitor.position_fixture_m);
    frame.z = side_view_scale(plot_box(rect, scale), monitor.position_needle_m, deepest_m);
    frame.pixels = std::max(1.0, scale);
    frame.middle = std::floor(frame.z.box.y + frame.z.box.height / 2);
    list.PushClipRect(corner(frame.z.box), far_corner(frame.z.box), true);
    draw_tissue(list, frame, monitor);
    draw_depths(list, frame);
    draw_fixture(list, frame, monitor);
    draw_needle(list, frame, monitor);
    list.PopClipRect();
    draw_legend(list, rect, frame, monitor);
}

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
