#include <algorithm>
#include <imgui.h>

#include <fmt/format.h>

#include "visual_node/window/page_view.hpp"

namespace thimble {
namespace {

constexpr ImU32 kBeepInk = IM_COL32(255, 214, 64, 255);
constexpr ImU32 kChosen = IM_COL32(41, 128, 219, 255);

// A button that looks pressed once it is the answer. Its text wraps, which ImGui's own does not.
bool answer_button(const std::string& label, bool chosen, float width) {
    const float font = ImGui::GetFontSize(), inner = width - font;
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 text = ImGui::CalcTextSize(label.c_str(), nullptr, false, inner);
    const ImVec2 size{width, text.y + 0.8F * font};
    if (chosen) ImGui::PushStyleColor(ImGuiCol_Button, kChosen);
    const bool clicked = ImGui::Button(("##" + label).c_str(), size);
    if (chosen) ImGui::PopStyleColor();
    const ImVec2 at{corner.x + (size.x - text.x) / 2, corner.y + (size.y - text.y) / 2};
    ImGui::GetWindowDrawList()->AddText(ImGui::GetFont(), font, at, ImGui::GetColorU32(ImGuiCol_Text),
                                        label.c_str(), nullptr, inner);
    return clicked;
}

void draw_ends(const Question& q, float width) {
    if (q.low.empty() && q.high.empty()) return;
    ImGui::TextUnformatted(q.low.c_str());
    ImGui::SameLine(width - ImGui::CalcTextSize(q.high.c_str()).x);
    ImGui::TextUnformatted(q.high.c_str());
}

void draw_choices(QuestionForm& form, float width) {
    const Question& q = *form.question();
    for (std::size_t i = 0; i < q.choices.size(); ++i) {
        const auto value = static_cast<double>(i + 1);
        if (answer_button(fmt::format("{}  {}", i + 1, q.choices[i]), form.value() == value, width))
            form.choose(value);
    }
}

void draw_likert(QuestionForm& form, float width) {
    const Question& q = *form.question();
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const auto points = static_cast<float>(q.to);
    for (int i = 1; i <= static_cast<int>(q.to); ++i) {
        if (i > 1) ImGui::SameLine();
        if (answer_button(fmt::format("{}", i), form.value() == i, (width - (points - 1) * gap) / points))
            form.choose(i);
    }
    draw_ends(q, width);
}

// A line with its ends, and a mark once the subject has clicked. The whole strip takes clicks.
void draw_scale(QuestionForm& form, float width) {
    const Question& q = *form.question();
    const float height = 2 * ImGui::GetFontSize(), thick = 0.15F * ImGui::GetFontSize();
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::InvisibleButton("scale", {width, height});
    if (ImGui::IsItemActive()) {
        const auto way = static_cast<double>((ImGui::GetIO().MousePos.x - corner.x) / width);
        form.choose(q.from + way * (q.to - q.from));
    }
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text);
    const float middle = corner.y + height / 2;
    list.AddLine({corner.x, middle}, {corner.x + width, middle}, ink, thick);
    for (const float end : {corner.x, corner.x + width})
        list.AddLine({end, middle - height / 4}, {end, middle + height / 4}, ink, thick);
    if (form.value()) {
        const auto way = static_cast<float>((*form.value() - q.from) / (q.to - q.from));
        list.AddCircleFilled({corner.x + way * width, middle}, 0.45F * ImGui::GetFontSize(), kChosen);
    }
    draw_ends(q, width);
}

void draw_number(const GuiLayer& gui, QuestionForm& form, float width) {
    if (answer_button("-", false, width / 5)) form.move(-1);
    ImGui::SameLine();
    ImGui::PushFont(gui.large_font());
    const std::string number = form.value() ? fmt::format("{:.0f}", *form.value()) : "___";
    ImGui::SetCursorPosX((width - ImGui::CalcTextSize(number.c_str()).x) / 2);
    ImGui::TextUnformatted(number.c_str());
    ImGui::PopFont();
    ImGui::SameLine(width - width / 5);
    if (answer_button("+", false, width / 5)) form.move(1);
}

void draw_answers(const GuiLayer& gui, QuestionForm& form, float width) {
    switch (form.question()->kind) {
        case QuestionKind::kChoice:
            return draw_choices(form, width);
        case QuestionKind::kLikert:
            return draw_likert(form, width);
        case QuestionKind::kScale:
            return draw_scale(form, width);
        case QuestionKind::kNumber:
            return draw_number(gui, form, width);
    }
}

// A paragraph as wide as the panel.
void draw_text(const std::string& text) {
    if (text.empty()) return;
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::Dummy({0, 0.6F * ImGui::GetFontSize()});
}

// Marks the end of text and answers. OK is disabled until it was on the screen; until then an arrow shows that more
// follows.
void note_end(QuestionForm& form) {
    const float font = ImGui::GetFontSize(), bottom = ImGui::GetWindowPos().y + ImGui::GetWindowHeight();
    if (ImGui::GetCursorScreenPos().y <= bottom) return form.read_to_end();
    const float x = ImGui::GetWindowPos().x + ImGui::GetWindowWidth() / 2, y = bottom - 0.5F * font;
    ImGui::GetForegroundDrawList()->AddTriangleFilled({x - font, y - font}, {x + font, y - font}, {x, y},
                                                      kChosen);
}

// As many pages as the subject has turned; each question begins at its first line.
void scroll(QuestionForm& form) {
    if (ImGui::IsWindowAppearing()) ImGui::SetScrollY(0);
    const int pages = form.take_pages();
    if (pages == 0) return;
    const float page = 0.8F * ImGui::GetWindowHeight();
    ImGui::SetScrollY(
        std::clamp(ImGui::GetScrollY() + static_cast<float>(pages) * page, 0.0F, ImGui::GetScrollMaxY()));
}

}  // namespace

bool draw_question(const GuiLayer& gui, const ShownQuestion& question, QuestionForm& form,
                   const std::string& how, double scene_width) {
    const ImVec2 screen{static_cast<float>(scene_width), ImGui::GetIO().DisplaySize.y};
    const float width = std::min(0.9F * screen.x, 44 * ImGui::GetFontSize());
    ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
    ImGui::SetNextWindowSize({width, 0});
    // As high as its content, at most as the screen: then it scrolls.
    const ImGuiWindowFlags flags = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings;
    bool given = false;
    // Of each question its own window: another one begins at its top.
    if (ImGui::Begin(fmt::format("question {}", form.number()).c_str(), nullptr, flags)) {
        scroll(form);
        const float inner = ImGui::GetContentRegionAvail().x;
        ImGui::PushFont(gui.large_font());
        draw_text(question.title);
        ImGui::PopFont();
        draw_text(question.question.text);
        draw_answers(gui, form, inner);
        note_end(form);
        ImGui::Dummy({0, ImGui::GetFontSize()});
        ImGui::BeginDisabled(!form.given());
        given = answer_button("OK", false, inner / 4);
        ImGui::EndDisabled();
        draw_text(how);
    }
    ImGui::End();
    return given;
}

void draw_beep(double scene_width) {
    const ImVec2 screen{static_cast<float>(scene_width), ImGui::GetIO().DisplaySize.y};
    const float thick = 0.05F * screen.y;
    ImGui::GetForegroundDrawList()->AddRect(
        {thick / 2, thick / 2}, {screen.x - thick / 2, screen.y - thick / 2}, kBeepInk, 0, 0, thick);
}

}  // namespace thimble
