#include "visual_node/window/captions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <imgui.h>
#include <numbers>

#include <fmt/format.h>

namespace thimble {
namespace {

constexpr const char* kTask =
    "Push the needle into the tissue until something stops it.\n"
    "Hold it there, no deeper and no harder, until you hear the beep.\n"
    "Then pull it out.";
constexpr const char* kGoOn = "Press the space bar, or click, when you are ready.";

std::string which_of(const Page& page) {
    if (page.trial == 0) return {};
    if (page.trials == 0) return fmt::format("Trial {}", page.trial);
    return fmt::format("Trial {} of {}", page.trial, page.trials);
}

std::string break_text(const Page& page) {
    if (page.remaining_s <= 0) return "Say when you want to continue.";
    return break_time(page) + " to go";
}

ImU32 to_ink(const Rgb& colour, int alpha = 255) { return IM_COL32(colour[0], colour[1], colour[2], alpha); }

void draw_centred(ImDrawList& list, ImFont* font, const std::string& text, float y, ImU32 ink, float width) {
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, FLT_MAX, 0, text.c_str());
    const float x = (width - size.x) / 2;
    list.AddText(font, font->FontSize, ImVec2(x, y), ink, text.c_str());
}

// How much of a line fits into the width, at least a character; the blank it is broken at belongs to none.
std::size_t fitting(const ImFont& font, const std::string& line, float width) {
    const char* const begin = line.c_str();
    const char* end = font.CalcWordWrapPositionA(1, begin, begin + line.size(), width);
    if (end == begin) ++end;
    while ((*end & 0xC0) == 0x80) ++end;  // not within a character
    return static_cast<std::size_t>(end - begin);
}

// Line by line, each in the middle; returns where the next would stand.
float draw_lines(ImFont* font, const std::string& text, float y, ImU32 ink, float width) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::string line = text.substr(begin, end - begin);
        do {
            const std::size_t length = line.empty() ? 0 : fitting(*font, line, 0.95F * width);
            draw_centred(list, font, line.substr(0, length), y, ink, width);
            y += 1.4F * font->FontSize;
            line.erase(0, std::max(length, std::min(line.find_first_not_of(' ', length), line.size())));
        } while (!line.empty());
        begin = end + 1;
    }
    return y;
}

// A place of a Picture in ImGui's units.
ImVec2 place(double x, double y) {
    const ImVec2 scale = ImGui::GetIO().DisplayFramebufferScale;
    return {static_cast<float>(x) / scale.x, static_cast<float>(y) / scale.y};
}

void draw_needle(ImDrawList& list, const Picture& picture) {
    const double half = picture.needle_width / 2, x = picture.needle_x, tip = picture.needle_tip_y;
    const double shoulder = tip - std::min(2 * picture.needle_width, tip);  // where the taper begins
    const ImU32 white = to_ink(colours::kNeedle);
    list.AddRectFilled(place(x - half, 0), place(x + half, shoulder), white);
    // Blunt by a pixel on either side, so that the end is seen where it is and not where the taper becomes thin.
    list.AddQuadFilled(place(x - half, shoulder), place(x + half, shoulder), place(x + 1, tip),
                       place(x - 1, tip), white);
}

// With the numbers of its scale, "N" behind the last.
void draw_bar(ImDrawList& list, const Picture::Bar& bar, double scale) {
    const double bottom = bar.top + bar.height;
    list.AddRectFilled(place(bar.left, bar.top), place(bar.left + bar.full_length, bottom),
                       to_ink(colours::kBarGround));
    list.AddRectFilled(place(bar.left, bar.top), place(bar.left + bar.length, bottom), to_ink(colours::kBar));
    const double line = std::max(1.0, std::round(scale));
    const int ticks = static_cast<int>(std::floor(bar.full_N / bar.tick_N * (1 + 1e-12)));
    for (int i = 0; i <= ticks; ++i) {
        const double middle = bar.left + bar.full_length * (i * bar.tick_N / bar.full_N),
                     x = std::round(middle);
        list.AddRectFilled(place(x, bottom), place(x + line, bottom + 6 * scale), to_ink(colours::kInk));
        const std::string number = fmt::format("{:g}", i * bar.tick_N);
        const auto width = static_cast<double>(ImGui::CalcTextSize(number.c_str()).x);
        list.AddText(place(std::round(middle - width / 2), bottom + 7 * scale), to_ink(colours::kInk),
                     (i == ticks ? number + " N" : number).c_str());
    }
}

void draw_ellipse(ImDrawList& list, const ImVec2& middle, float wide, float high, ImU32 ink) {
    constexpr int kCorners = 48;
    for (int i = 0; i < kCorners; ++i) {
        const double angle = 2 * std::numbers::pi * i / kCorners;
        list.PathLineTo({middle.x + wide * static_cast<float>(std::cos(angle)),
                         middle.y + high * static_cast<float>(std::sin(angle))});
    }
    list.PathFillConvex(ink);
}

void draw_fingertip(ImDrawList& list, const Picture::Fingertip& finger) {
    const ImVec2 middle = place(finger.x, finger.y),
                 nail_middle = place(finger.x, finger.y - 0.35 * finger.radius);
    const float r = place(finger.radius, 0).x;
    const ImU32 skin = to_ink(colours::kSkin);
    Rgb nail{};
    for (std::size_t i = 0; i < nail.size(); ++i) {
        nail[i] = static_cast<std::uint8_t>(
            std::lround(std::lerp(0.85 * colours::kSkin[i], colours::kBlanched[i], finger.blanching)));
    }
    draw_ellipse(list, middle, r, 1.35F * r, skin);
    list.AddRectFilled(place(finger.x - finger.radius, finger.y),
                       place(finger.x + finger.radius, finger.y + 1.5 * finger.radius), skin);
    draw_ellipse(list, nail_middle, 0.66F * r, 0.72F * r, to_ink(nail));
}

// Within `area`, on a soft dark ground, so that it can be read over each layer. Lines break at `width`; 0: nowhere.
void draw_label(ImDrawList& list, const CutawayLabel& label, const Rect& area, float width = 0) {
    const char* const text = label.text.c_str();
    const ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, width > 0 ? width : -1);
    ImVec2 corner = place(label.at.x, label.at.y);
    const float line = ImGui::GetFontSize(), margin = 0.25F * line;
    const ImVec2 from = place(area.x, area.y), to = place(area.right(), area.bottom());
    if (label.ends_there) corner.x -= size.x;
    corner.x = std::floor(std::max(from.x + margin, std::min(corner.x, to.x - size.x - margin)));
    corner.y = std::floor(std::max(from.y, std::min(corner.y - line / 2, to.y - size.y)));
    list.AddRectFilled({corner.x - margin, corner.y}, {corner.x + size.x + margin, corner.y + size.y},
                       IM_COL32(16, 17, 20, 150), margin);
    list.AddText(ImGui::GetFont(), line, corner, to_ink(label.colour), text, nullptr, width);
}

}  // namespace

PageText page_text(const Page& page) {
    switch (page.kind) {
        case PageKind::kNone:
            return {};
        case PageKind::kWelcome:
            return {"Welcome", kTask};
        case PageKind::kPractice:
            return {"Practice", std::string(kTask) + "\n\nThis one does not count."};
        case PageKind::kReady:
            return {"Ready?", which_of(page)};
        case PageKind::kBreak:
            return {"A break", break_text(page)};
        case PageKind::kPaused:
            return {"Paused", "It will continue in a moment."};
        case PageKind::kDone:
            return {"Done", "Thank you. You may release the handle."};
        case PageKind::kWait:
            return {"One moment", which_of(page)};
        case PageKind::kQuestion:
            return {"",
                    "Choose with the mouse, or with the digits and the arrow keys. Then press Enter or click "
                    "OK."};
    }
    return {};
}

PageText page_text(const Page& page, const Instructions& instructions, bool subject_goes_on) {
    PageText text = page_text(page);
    if (page.kind == PageKind::kNone) return text;
    const PageWords& own = instructions.of(page.kind);
    if (own.title) text.title = fill_in(*own.title, page);
    if (own.body) text.body = fill_in(*own.body, page);
    const std::string go_on = instructions.go_on.value_or(own.body ? "" : kGoOn);
    if (go_on.empty() || !subject_goes_on || !waits_to_go_on(page.kind)) return text;
    text.body += text.body.empty() ? go_on : "\n\n" + go_on;
    return text;
}

PageText unknown_question(const Page& page) {
    return {"Please call the experimenter",
            fmt::format("Question {} is from other pages than this window's: start the window again with the "
                        "session's pages ([instructions] pages).",
                        page.trial)};
}

void draw_over_tissue(const Picture& picture) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImDrawListFlags flags = list.Flags;
    list.Flags &= ~ImDrawListFlags_AntiAliasedFill;  // whole pixels
    draw_needle(list, picture);
    if (picture.bar) draw_bar(list, *picture.bar, picture.size.content_scale);
    if (picture.fingertip) draw_fingertip(list, *picture.fingertip);
    list.Flags = flags;
}

void draw_over_cutaway(const Scene& scene, const CutawayPlan& plan) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const CutawayLabel& label : cutaway_labels(scene, plan)) draw_label(list, label, plan.area);
}

void draw_headline(const std::string& text, const CutawayPlan& plan) {
    const CutawayLabel label{{plan.area.x + 22 * plan.unit, plan.area.y + 24 * plan.unit}, text, kWhite};
    draw_label(*ImGui::GetBackgroundDrawList(), label, plan.area, static_cast<float>(0.36 * plan.area.width));
}

void draw_shade(double scene_width, double opacity) {
    const ImVec2 size{static_cast<float>(scene_width), ImGui::GetIO().DisplaySize.y};
    ImGui::GetBackgroundDrawList()->AddRectFilled(
        ImVec2(0, 0), size, to_ink(colours::kBackground, static_cast<int>(std::lround(255 * opacity))));
}

void draw_page(const GuiLayer& gui, const PageText& text, double scene_width, double opacity) {
    draw_shade(scene_width, opacity);
    const ImVec2 size{static_cast<float>(scene_width), ImGui::GetIO().DisplaySize.y};
    const float y = draw_lines(gui.large_font(), text.title, 0.3F * size.y, to_ink(colours::kNeedle), size.x);
    draw_lines(ImGui::GetFont(), text.body, y + ImGui::GetFontSize(), to_ink(colours::kInk), size.x);
}

void draw_key_help(const std::string& keys) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x / 2, size.y / 2), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                   ImGuiWindowFlags_NoInputs | ImGuiWindowFlags_NoSavedSettings;
    if (ImGui::Begin("keys", nullptr, flags)) ImGui::TextUnformatted(keys.c_str());
    ImGui::End();
}

void draw_times(const FrameTimes& times) {
    const auto ms = [](const Histogram& h, double q) { return 1e3 * to_seconds(h.quantile(q)); };
    std::array<char, 160> line{};
    if (times.one_clock() && times.hand_to_swap.count() > 0) {
        fmt::format_to_n(line.data(), line.size() - 1,
                         "hand to picture {:.1f} ms (median; 99 %: {:.1f})   network {:.1f}   waiting {:.1f} "
                         "  drawing {:.1f}",
                         ms(times.hand_to_swap, 0.5), ms(times.hand_to_swap, 0.99),
                         ms(times.slave_to_arrival, 0.5), ms(times.arrival_to_frame, 0.5),
                         ms(times.draw, 0.5));
    } else {
        fmt::format_to_n(line.data(), line.size() - 1, "waiting {:.1f} ms   drawing {:.1f} ms",
                         ms(times.arrival_to_frame, 0.5), ms(times.draw, 0.5));
    }
    const float y = ImGui::GetIO().DisplaySize.y - 1.3F * ImGui::GetFontSize();
    ImGui::GetForegroundDrawList()->AddText(ImVec2(0.5F * ImGui::GetFontSize(), y), to_ink(colours::kInk),
                                            line.data());
}

void draw_notice(const std::string& notice, double scene_width) {
    if (notice.empty()) return;
    draw_centred(*ImGui::GetForegroundDrawList(), ImGui::GetFont(), notice, 0.5F * ImGui::GetFontSize(),
                 to_ink(colours::kInk), static_cast<float>(scene_width));
}

}  // namespace thimble
