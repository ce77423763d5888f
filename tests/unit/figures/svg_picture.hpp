// An SVG that gnuplot wrote, read back: its texts and panels as boxes, and what a reader would stumble over.
#pragma once

#include <string>
#include <vector>

namespace thimble {

struct PictureBox {
    double left = 0, top = 0, right = 0, bottom = 0;  // px, y downwards

    bool overlaps(const PictureBox& other, double more_than_px = 1) const;
    bool holds(const PictureBox& other, double slack_px = 1) const;
};

struct PictureText {
    std::string words, anchor;  // "start", "middle", "end"
    bool upright = false;       // turned by a quarter
    PictureBox box;             // by the widths of DejaVu Sans, about
};

struct PictureArea {
    std::string colour;  // as the SVG has it: "rgb( 86, 180, 233)"
    PictureBox box;
};

class SvgPicture {
  public:
    explicit SvgPicture(const std::string& svg);

    const std::vector<PictureText>& texts() const { return texts_; }
    const std::vector<PictureArea>& areas() const { return areas_; }   // filled polygons
    const std::vector<PictureBox>& panels() const { return panels_; }  // by their axes
    bool says(const std::string& words) const;                         // in one of its texts

    // A line per fault: no panel, a panel's axis without numbers or names, texts that overlap or leave the picture, cells over
    // the axes, <title>s. Empty if all is well. Panels in one row may share the numbers of the leftmost, those in one column
    // the numbers of the lowest.
    std::string faults() const;

  private:
    std::string text_faults() const;
    std::string axis_faults() const;
    std::string area_faults() const;
    bool has_row_numbers(const PictureBox& panel) const;
    bool has_column_numbers(const PictureBox& panel) const;

    std::string svg_;
    PictureBox picture_;
    std::vector<PictureText> texts_;
    std::vector<PictureArea> areas_;
    std::vector<PictureBox> panels_;
};

}  // namespace thimble
