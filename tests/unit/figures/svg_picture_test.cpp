// The reader of pictures finds what it is for: a picture for each fault.
#include "tests/unit/figures/svg_picture.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thimble {
namespace {

using testing::HasSubstr;

std::string text(double x, double y, const std::string& words, const std::string& anchor,
                 const std::string& turn = "") {
    return fmt::format(
        "<g transform=\"translate({},{}){}\" font-family=\"DejaVu Sans\" font-size=\"13.00\"  "
        "text-anchor=\"{}\">\n"
        "\t\t<text><tspan font-family=\"DejaVu Sans\" >{}</tspan></text>\n",
        x, y, turn, anchor, words);
}

std::string picture(const std::string& more) {
    return "<svg viewBox=\"0 0 400 300\"\n>"
           "<path stroke='rgb( 68,  68,  68)'  d='M90.00,40.00 L90.00,240.00 L390.00,240.00 M1,2  '/>" +
           text(80, 100, "1.5", "end") + text(200, 262, "HF", "middle") + more;
}

std::string faults(const std::string& more) { return SvgPicture(picture(more)).faults(); }

TEST(SvgPicture, IsContentWithAPlainFigure) {
    EXPECT_EQ(faults(""), "");
    EXPECT_EQ(faults(text(200, 20, "a title", "middle")), "");
    EXPECT_EQ(
        faults("<polygon fill = 'rgb(1)' fill-opacity = '1' points = '100,240 120,240 120,90 100,90 '/>"),
        "");
    EXPECT_TRUE(SvgPicture(picture("")).says("HF"));
    EXPECT_FALSE(SvgPicture(picture("")).says("VF"));
}

TEST(SvgPicture, FindsTextsThatOverlapOrLeave) {
    EXPECT_THAT(faults(text(205, 260, "CF", "middle")), HasSubstr("'CF' lies over 'HF'"));
    EXPECT_THAT(faults(text(5, 20, "centred too far left", "middle")), HasSubstr("leaves the picture"));
    EXPECT_THAT(faults(text(200, 310, "below", "middle")), HasSubstr("leaves the picture"));
    EXPECT_THAT(faults(text(20, 40, "an axis much longer than its panel", "middle", " rotate(270)")),
                HasSubstr("leaves the picture"));
}

TEST(SvgPicture, FindsAxesWithoutNumbers) {
    const std::string bare =
        "<svg viewBox=\"0 0 400 300\"\n>"
        "<path stroke='rgb( 68,  68,  68)'  d='M90.00,40.00 L90.00,240.00 L390.00,240.00 M1,2  '/>";
    EXPECT_THAT(SvgPicture(bare).faults(), HasSubstr("no numbers left"));
    EXPECT_THAT(SvgPicture(bare).faults(), HasSubstr("no numbers below"));
    EXPECT_THAT(SvgPicture("<svg viewBox=\"0 0 400 300\"\n>").faults(), HasSubstr("no panel"));
}

TEST(SvgPicture, FindsCellsOverTheAxesAndTooltips) {
    EXPECT_THAT(faults("<polygon fill = 'rgb(1)' points = '80,240 120,240 120,90 80,90 '/>"),
                HasSubstr("over the axes"));
    EXPECT_THAT(faults("<g id=\"p\" ><title>gnuplot_plot_1a</title>"), HasSubstr("<title>"));
}

}  // namespace
}  // namespace thimble
