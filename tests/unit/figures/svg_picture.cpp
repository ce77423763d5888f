#include "tests/unit/figures/svg_picture.hpp"

#include <algorithm>
#include <cmath>
#include <regex>

#include <fmt/format.h>

namespace thimble {
namespace {

using Matches = std::sregex_iterator;

// Of the height of its font; DejaVu Sans.
double width_of(char c) {
    if (std::string_view("ijlI|'").find(c) != std::string_view::npos) return 0.29;
    if (std::string_view(".,: ;").find(c) != std::string_view::npos) return 0.33;
    if (std::string_view("frt()-/[]").find(c) != std::string_view::npos) return 0.39;
    if (std::string_view("mMWw%+=").find(c) != std::string_view::npos) return 0.9;
    return 0.62;
}

double width_px(const std::string& text, double size_px) {
    double width_px = 0;
    for (const char c : text) {
        const bool continues = (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
        if (!continues) width_px += size_px * width_of(c);
    }
    return width_px;
}

struct Words {
    std::string text;
    double width_px = 0;
};

// The <tspan>s of a <text>, each with a size of its own or that of its group; text without markup has none.
Words words_of(const std::string& inside, double size_px) {
    static const std::regex span(R"re(<tspan([^>]*)>([^<]*)</tspan>)re"),
        size(R"re(font-size="([0-9.]+)")re");
    if (inside.find('<') == std::string::npos) return {inside, width_px(inside, size_px)};
    Words words;
    for (Matches it(inside.begin(), inside.end(), span), end; it != end; ++it) {
        const std::string attributes = (*it)[1], text = (*it)[2];
        std::smatch own;
        words.text += text;
        words.width_px +=
            width_px(text, std::regex_search(attributes, own, size) ? std::stod(own[1]) : size_px);
    }
    return words;
}

PictureBox text_box(double x, double y, double width_px, double size_px, const std::string& anchor,
                    bool upright) {
    const double before = anchor == "middle" ? width_px / 2 : anchor == "end" ? width_px : 0;
    const double above = 0.74 * size_px, below = 0.2 * size_px;
    if (upright) return {x - above, y - width_px + before, x + below, y + before};
    return {x - before, y - above, x - before + width_px, y + below};
}

std::vector<PictureText> texts_in(const std::string& svg) {
    static const std::regex text(
        R"re(<g transform="translate\(([0-9.-]+),([0-9.-]+)\)( rotate\([0-9.-]+\))?"[^>]*font-size="([0-9.]+)"\s*text-anchor="(\w+)">\s*<text[^>]*>([\s\S]*?)</text>)re");
    std::vector<PictureText> texts;
    for (Matches it(svg.begin(), svg.end(), text), end; it != end; ++it) {
        const std::smatch& found = *it;
        const double size_px = std::stod(found[4]);
        const Words words = words_of(found[6], size_px);
        if (words.text.find_first_not_of(' ') == std::string::npos) continue;
        const bool upright = found[3].matched;
        texts.push_back(
            {words.text, found[5], upright,
             text_box(std::stod(found[1]), std::stod(found[2]), words.width_px, size_px, found[5], upright)});
    }
    return texts;
}

void include(PictureBox& box, double x, double y) {
    box = {std::min(box.left, x), std::min(box.top, y), std::max(box.right, x), std::max(box.bottom, y)};
}

// The value of an attribute from `at` on. Not by std::regex, which goes one call deeper with every character.
std::string quoted_after(const std::string& svg, const char* name, std::size_t at) {
    const std::size_t open = svg.find('\'', svg.find(name, at));
    return open == std::string::npos ? "" : svg.substr(open + 1, svg.find('\'', open + 1) - open - 1);
}

std::vector<PictureArea> areas_in(const std::string& svg) {
    static const std::regex point(R"re(([0-9.-]+),([0-9.-]+))re");
    const std::string polygon = "<polygon fill = ";
    std::vector<PictureArea> areas;
    const Matches end;
    for (std::size_t at = svg.find(polygon); at != std::string::npos; at = svg.find(polygon, at + 1)) {
        const std::string points = quoted_after(svg, "points", at);
        PictureBox box{1e9, 1e9, -1e9, -1e9};
        for (Matches p(points.begin(), points.end(), point); p != end; ++p)
            include(box, std::stod((*p)[1]), std::stod((*p)[2]));
        areas.push_back({quoted_after(svg, "fill", at), box});
    }
    return areas;
}

// Left and lower axis are one line from the upper left to the lower right. Some panels have the lower axis alone: they count as
// kNoLeftAxis_px high. gnuplot draws the axes of some panels twice.
std::vector<PictureBox> panels_in(const std::string& svg) {
    constexpr double kNoLeftAxis_px = 80, kLongerThanATic_px = 30;
    static const std::regex axes(
        R"re(<path stroke='rgb\( 68,  68,  68\)'\s+d='(?:M[0-9.,]+ )?M([0-9.]+),([0-9.]+) L([0-9.]+),([0-9.]+)(?: L([0-9.]+),([0-9.]+))?( L)?)re");
    std::vector<PictureBox> panels;
    for (Matches it(svg.begin(), svg.end(), axes), end; it != end; ++it) {
        const std::smatch& at = *it;
        PictureBox panel{std::stod(at[1]), std::stod(at[2]), std::stod(at[3]), std::stod(at[4])};
        if (at[5].matched)
            panel = {panel.left, panel.top, std::stod(at[5]), std::stod(at[6])};
        else
            panel.top -= kNoLeftAxis_px;
        const bool closed = at[7].matched, tic = panel.right - panel.left < kLongerThanATic_px;
        const bool known = std::any_of(panels.begin(), panels.end(),
                                       [&](const PictureBox& other) { return other.holds(panel); });
        if (!closed && !tic && !known) panels.push_back(panel);
    }
    return panels;
}

PictureBox picture_of(const std::string& svg) {
    static const std::regex view(R"re(viewBox="0 0 ([0-9.]+) ([0-9.]+)")re");
    std::smatch found;
    if (!std::regex_search(svg, found, view)) return {};
    return {0, 0, std::stod(found[1]), std::stod(found[2])};
}

}  // namespace

bool PictureBox::overlaps(const PictureBox& other, double more_than_px) const {
    return std::min(right, other.right) - std::max(left, other.left) > more_than_px &&
           std::min(bottom, other.bottom) - std::max(top, other.top) > more_than_px;
}

bool PictureBox::holds(const PictureBox& other, double slack_px) const {
    return other.left >= left - slack_px && other.right <= right + slack_px && other.top >= top - slack_px &&
           other.bottom <= bottom + slack_px;
}

SvgPicture::SvgPicture(const std::string& svg)
    : svg_(svg),
      picture_(picture_of(svg)),
      texts_(texts_in(svg)),
      areas_(areas_in(svg)),
      panels_(panels_in(svg)) {}

bool SvgPicture::says(const std::string& words) const {
    return std::any_of(texts_.begin(), texts_.end(),
                       [&](const PictureText& text) { return text.words.find(words) != std::string::npos; });
}

std::string SvgPicture::faults() const {
    std::string faults = text_faults() + axis_faults() + area_faults();
    if (svg_.find("<title>") != std::string::npos) faults += "a <title> that shows under the pointer\n";
    return faults;
}

std::string SvgPicture::text_faults() const {
    std::string faults;
    for (std::size_t i = 0; i < texts_.size(); ++i) {
        if (!picture_.holds(texts_[i].box))
            faults += fmt::format("'{}' leaves the picture\n", texts_[i].words);
        for (std::size_t j = 0; j < i; ++j) {
            if (texts_[i].box.overlaps(texts_[j].box))
                faults += fmt::format("'{}' lies over '{}'\n", texts_[i].words, texts_[j].words);
        }
    }
    return faults;
}

bool SvgPicture::has_row_numbers(const PictureBox& panel) const {
    return std::any_of(texts_.begin(), texts_.end(), [&](const PictureText& text) {
        const double middle = (text.box.top + text.box.bottom) / 2;
        return text.anchor == "end" && text.box.right <= panel.left && panel.left - text.box.right < 25 &&
               middle > panel.top - 8 && middle < panel.bottom + 8;
    });
}

bool SvgPicture::has_column_numbers(const PictureBox& panel) const {
    return std::any_of(texts_.begin(), texts_.end(), [&](const PictureText& text) {
        const double middle = (text.box.left + text.box.right) / 2;
        return text.anchor == "middle" && text.box.top > panel.bottom && text.box.top - panel.bottom < 25 &&
               middle > panel.left - 8 && middle < panel.right + 8;
    });
}

std::string SvgPicture::axis_faults() const {
    std::string faults = panels_.empty() ? "no panel\n" : "";
    for (const PictureBox& panel : panels_) {
        bool row = false, column = false;
        for (const PictureBox& other : panels_) {
            row = row || (std::abs(other.bottom - panel.bottom) < 1 && has_row_numbers(other));
            column = column || (std::abs(other.left - panel.left) < 1 && has_column_numbers(other));
        }
        if (!row) faults += fmt::format("no numbers left of the panel at {}, {}\n", panel.left, panel.top);
        if (!column) faults += fmt::format("no numbers below the panel at {}, {}\n", panel.left, panel.top);
    }
    return faults;
}

// A filled area lies within a panel, or above all of them as a sample of the key.
std::string SvgPicture::area_faults() const {
    std::string faults;
    double head_px = picture_.bottom;
    for (const PictureBox& panel : panels_) head_px = std::min(head_px, panel.top);
    for (const PictureArea& area : areas_) {
        const bool inside = std::any_of(panels_.begin(), panels_.end(),
                                        [&](const PictureBox& panel) { return panel.holds(area.box); });
        if (!inside && area.box.bottom > head_px)
            faults += fmt::format("{} over the axes at {}, {}\n", area.colour, area.box.left, area.box.top);
    }
    return faults;
}

}  // namespace thimble
