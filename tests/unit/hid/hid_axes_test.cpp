// Reports of both SpaceMouse styles and of described devices; what is refused; models and their udev rules.
#include "master/devices/hid/hid_axes.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/unit/hid/fake_hid.hpp"

namespace thimble::test {
namespace {

Report axes_report(std::uint8_t number, const std::vector<int>& values) {
    Report report{number};
    for (const int value : values) {
        report.push_back(static_cast<std::uint8_t>(value & 0xff));
        report.push_back(static_cast<std::uint8_t>((value >> 8) & 0xff));
    }
    return report;
}

TEST(SpaceMouseAxes, OldStyleHasTwoReportsAndNewStyleOne) {
    HidAxes old_style = HidAxes::of_spacemouse(), new_style = HidAxes::of_spacemouse();
    EXPECT_EQ(old_style.take(axes_report(1, {350, -175, 0})), ReportVerdict::kTaken);
    EXPECT_EQ(old_style.take(axes_report(2, {0, 35, -350})), ReportVerdict::kTaken);
    EXPECT_EQ(new_style.take(axes_report(1, {350, -175, 0, 0, 35, -420})), ReportVerdict::kTaken);
    const std::array<double, 6> wanted{1, -0.5, 0, 0, 0.1, -1};  // beyond the scale is full deflection
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_DOUBLE_EQ(old_style.values()[i], wanted[i]) << i;
        EXPECT_DOUBLE_EQ(new_style.values()[i], wanted[i]) << i;
    }
}

TEST(SpaceMouseAxes, ShortGarbledAndOtherReportsChangeNothing) {
    HidAxes axes = HidAxes::of_spacemouse();
    axes.take(axes_report(1, {35, 70, 105}));
    const auto before = axes.values();
    for (const Report& bad : {Report{}, Report{1}, Report{1, 0, 0, 0, 0, 0}, Report(8, 1),
                              axes_report(2, {0, 0, 0, 0, 0, 0}), axes_report(1, {0, 30000, 0})})
        EXPECT_EQ(axes.take(bad), ReportVerdict::kBad) << bad.size() << " bytes";
    EXPECT_EQ(axes.take(Report{3, 1, 0}), ReportVerdict::kOther);   // buttons
    EXPECT_EQ(axes.take(Report{0x17, 80}), ReportVerdict::kOther);  // battery
    EXPECT_EQ(axes.values(), before);
}

TEST(HidButtons, OfEitherKindHaveTheNumbersOfHid) {
    HidAxes cap = HidAxes::of_spacemouse();
    EXPECT_FALSE(cap.pressed(1));
    cap.take(Report{3, 2, 0x80});
    EXPECT_TRUE(cap.pressed(2) && cap.pressed(16));
    EXPECT_FALSE(cap.pressed(0) || cap.pressed(1) || cap.pressed(33));
    cap.take(axes_report(1, {0, 70, 0}));
    EXPECT_TRUE(cap.pressed(2)) << "an axis says nothing of buttons";
    cap.take(Report{3, 0, 0});
    EXPECT_FALSE(cap.pressed(2));

    auto pad = HidAxes::described_by(*parse_report_descriptor(kGamepadDescriptor));
    ASSERT_TRUE(pad);
    EXPECT_TRUE(pad->has_button(8));
    EXPECT_FALSE(pad->has_button(9) || pad->has_button(0));
    pad->take(Report{1, 128, 128, 128, 128, 0x80});
    EXPECT_TRUE(pad->pressed(8));
    EXPECT_FALSE(pad->pressed(1));

    // Of a receiver those of the cap, not the mouse's.
    auto receiver = HidAxes::described_by(*parse_report_descriptor(kReceiverDescriptor));
    ASSERT_TRUE(receiver);
    EXPECT_TRUE(receiver->has_button(2));
    EXPECT_FALSE(receiver->has_button(3));
    receiver->take(Report{2, 1, 0, 0, 0});
    EXPECT_FALSE(receiver->pressed(1));
    receiver->take(Report{4, 1});
    EXPECT_TRUE(receiver->pressed(1));
}

TEST(DescribedAxes, OfAReceiverAreTheCapsAndNotTheMouses) {
    auto axes = HidAxes::described_by(*parse_report_descriptor(kReceiverDescriptor));
    ASSERT_TRUE(axes);
    for (std::size_t axis = 0; axis < kHidAxes; ++axis) EXPECT_TRUE(axes->has(axis)) << axis;
    EXPECT_EQ(axes->take(axes_report(3, {350, -175, 0, 35, 0, -350})), ReportVerdict::kTaken);
    const auto pushed = axes->values();
    EXPECT_DOUBLE_EQ(pushed[0], 1);
    EXPECT_DOUBLE_EQ(pushed[1], -0.5);
    EXPECT_DOUBLE_EQ(pushed[5], -1);
    // A key, the mouse, a button, the maker's own: none of them moves the hand.
    for (const Report& other : {Report{1, 2, 0, 4, 0, 0, 0, 0, 0}, Report{2, 1, 100, 156, 1}, Report{4, 3},
                                Report{16, 1, 2, 3, 4, 5, 6}}) {
        EXPECT_EQ(axes->take(other), ReportVerdict::kOther);
        EXPECT_EQ(axes->values(), pushed);
    }
    EXPECT_EQ(axes->take(Report{3, 1, 2}), ReportVerdict::kBad);
}

// An adapter for two pads: axes of both are not one hand.
TEST(DescribedAxes, OfTwoSticksAreTheFirstOnes) {
    Report two{0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x85, 0x01, 0x09, 0x30, 0x15, 0x00,
               0x25, 0x7f, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02, 0xc0, 0x09, 0x05, 0xa1,
               0x01, 0x85, 0x02, 0x09, 0x30, 0x09, 0x31, 0x95, 0x02, 0x81, 0x02, 0xc0};
    auto axes = HidAxes::described_by(*parse_report_descriptor(two));
    ASSERT_TRUE(axes);
    EXPECT_TRUE(axes->has(0));
    EXPECT_FALSE(axes->has(1));
    EXPECT_EQ(axes->take(Report{2, 127, 127}), ReportVerdict::kOther);
    EXPECT_EQ(axes->take(Report{1, 127}), ReportVerdict::kTaken);
}

TEST(DescribedAxes, AreScaledToTheirRange) {
    auto axes = HidAxes::described_by(*parse_report_descriptor(kGamepadDescriptor));
    ASSERT_TRUE(axes);
    EXPECT_TRUE(axes->has(0));
    EXPECT_TRUE(axes->has(5));  // Rz, the second stick
    EXPECT_FALSE(axes->has(3));
    EXPECT_EQ(axes->take(Report{1, 0, 255, 128, 127, 0}), ReportVerdict::kTaken);
    EXPECT_DOUBLE_EQ(axes->values()[0], -1);
    EXPECT_DOUBLE_EQ(axes->values()[1], 1);
    EXPECT_NEAR(axes->values()[2], 0, 0.005);
    EXPECT_EQ(axes->take(Report{1, 0}), ReportVerdict::kBad);
    EXPECT_EQ(axes->take(Report{2, 0, 0, 0, 0, 0}), ReportVerdict::kOther);
    EXPECT_DOUBLE_EQ(axes->values()[1], 1);
}

TEST(DescribedAxes, OfThirtyTwoBitsReachBothEnds) {
    auto axes = HidAxes::described_by(*parse_report_descriptor(
        Report{0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0x09, 0x30, 0x17, 0x00, 0x00, 0x00, 0x80,
               0x27, 0xff, 0xff, 0xff, 0x7f, 0x75, 0x20, 0x95, 0x01, 0x81, 0x02, 0xc0}));
    ASSERT_TRUE(axes);
    axes->take(Report{0xff, 0xff, 0xff, 0x7f});
    EXPECT_DOUBLE_EQ(axes->values()[0], 1);
    axes->take(Report{0x00, 0x00, 0x00, 0x80});
    EXPECT_DOUBLE_EQ(axes->values()[0], -1);
}

TEST(DescribedAxes, AKeyboardHasNone) {
    const auto layout =
        parse_report_descriptor(Report{0x05, 0x01, 0x09, 0x06, 0xa1, 0x01, 0x05, 0x07, 0x19, 0xe0, 0x29, 0xe7,
                                       0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0});
    ASSERT_TRUE(layout);
    EXPECT_FALSE(HidAxes::described_by(*layout));
}

TEST(HidModels, MiceAndStrangersAreNone) {
    EXPECT_TRUE(find_hid_model(0x046d, 0xc626)->six_axes);
    EXPECT_TRUE(find_hid_model(0x256f, 0xc635)->six_axes);
    EXPECT_FALSE(find_hid_model(0x256f, 0xc650)->six_axes);
    EXPECT_FALSE(find_hid_model(0x057e, 0x2009)->six_axes);
    EXPECT_FALSE(find_hid_model(0x046d, 0xc077));  // a mouse of the vendor's
}

// A model that the program knows and the rules forget could be opened by root only.
TEST(HidModels, EachHasItsUdevRule) {
    std::ifstream file(THIMBLE_SOURCE_DIR "/deploy/udev/70-thimble-hid.rules");
    const std::string rules{std::istreambuf_iterator<char>(file), {}};
    int known = 0;
    for (const unsigned vendor : {0x046dU, 0x256fU}) {
        for (unsigned product = 0xc600; product < 0xc700; ++product) {
            const auto model =
                find_hid_model(static_cast<std::uint16_t>(vendor), static_cast<std::uint16_t>(product));
            const bool ruled =
                rules.find(fmt::format("*:{:04X}:{:04X}.*", vendor, product)) != std::string::npos;
            EXPECT_EQ(ruled, model && model->six_axes) << std::hex << vendor << ':' << product;
            known += ruled ? 1 : 0;
        }
    }
    EXPECT_EQ(known, 22);
    EXPECT_EQ(rules.find("057E:2009"), std::string::npos) << "no hand";
}

}  // namespace
}  // namespace thimble::test
