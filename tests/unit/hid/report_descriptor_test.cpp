// Report descriptors as devices have them, and what is none.
#include "master/devices/hid/report_descriptor.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/hid/fake_hid.hpp"

namespace thimble::test {
namespace {

// Joystick: 10 bits of X and Y from -512 to 511 without a report number, 4 constant bits, and a slider.
const Report kJoystick{0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0x09, 0x01, 0xa1, 0x00, 0x09, 0x30,
                       0x09, 0x31, 0x16, 0x00, 0xfe, 0x26, 0xff, 0x01, 0x75, 0x0a, 0x95, 0x02,
                       0x81, 0x02, 0x75, 0x04, 0x95, 0x01, 0x81, 0x03, 0x09, 0x36, 0x15, 0x00,
                       0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x01, 0x81, 0x02, 0xc0, 0xc0};

TEST(ReportDescriptor, OfAGamepad) {
    const auto layout = parse_report_descriptor(kGamepadDescriptor);
    ASSERT_TRUE(layout);
    EXPECT_EQ(layout->applications, (std::vector<HidUsage>{{kGenericDesktop, kGamepadUsage}}));
    EXPECT_TRUE(layout->numbered);
    ASSERT_EQ(layout->fields.size(), 12U);
    const HidField& second = layout->fields[1];
    EXPECT_EQ(second.usage, 0x31);
    EXPECT_EQ(second.bit_offset, 8U);
    EXPECT_EQ(second.maximum, 255);
    const Report report{1, 10, 200, 0, 0, 0x81};
    EXPECT_EQ(value_of(*layout, second, report), 200);
    EXPECT_EQ(value_of(*layout, layout->fields[4], report), 1);  // first button
    EXPECT_EQ(value_of(*layout, layout->fields[5], report), 0);
    EXPECT_EQ(value_of(*layout, layout->fields[11], report), 1);  // last
    EXPECT_EQ(value_of(*layout, second, Report{2, 10, 200, 0, 0, 0}), std::nullopt);
    EXPECT_EQ(value_of(*layout, second, Report{1, 10}), std::nullopt);
}

TEST(ReportDescriptor, FieldsAcrossBytesAreSigned) {
    const auto layout = parse_report_descriptor(kJoystick);
    ASSERT_TRUE(layout);
    EXPECT_FALSE(layout->numbered);
    ASSERT_EQ(layout->fields.size(), 3U);
    EXPECT_EQ(layout->fields[0].minimum, -512);
    EXPECT_EQ(layout->fields[2].bit_offset, 24U);
    // X = -512: 10 bits 1000000000; Y = 511: 0111111111.
    const Report report{0x00, 0xfe, 0x07, 0x80};
    EXPECT_EQ(value_of(*layout, layout->fields[0], report), -512);
    EXPECT_EQ(value_of(*layout, layout->fields[1], report), 511);
    EXPECT_EQ(value_of(*layout, layout->fields[2], report), 128);
}

TEST(ReportDescriptor, OfAReceiverHasAllItsApplications) {
    const auto layout = parse_report_descriptor(kReceiverDescriptor);
    ASSERT_TRUE(layout);
    EXPECT_EQ(layout->applications, (std::vector<HidUsage>{{kGenericDesktop, 0x06},
                                                           {kGenericDesktop, kMouseUsage},
                                                           {kGenericDesktop, kMultiAxisUsage},
                                                           {0xff00, 0x01}}));
    EXPECT_TRUE(layout->is({kGenericDesktop, kMultiAxisUsage}));
    EXPECT_FALSE(layout->is({kGenericDesktop, kGamepadUsage}));
    const auto in = [&](std::size_t application) {
        return std::count_if(layout->fields.begin(), layout->fields.end(),
                             [=](const HidField& field) { return field.application == application; });
    };
    EXPECT_EQ(in(0), 8);  // modifiers; the keys are an array
    EXPECT_EQ(in(1), 3 + 3);
    EXPECT_EQ(in(2), 6 + 2);
}

// HID 1.11, 6.2.2.8: a main item takes the usage page that was declared last, also behind its usages.
TEST(ReportDescriptor, TheUsagePageIsTheOneThatTheMainItemMeets) {
    const auto layout = parse_report_descriptor(
        Report{0x05, 0x09, 0x09, 0x04, 0x05, 0x01, 0xa1, 0x01,  // page 9, usage 4, page 1: a joystick
               0x05, 0x09, 0x09, 0x30, 0x09, 0x31, 0x05, 0x01,  // X and Y, named on the buttons' page
               0x0b, 0x02, 0x00, 0x09, 0x00,                    // button 2, which brings its page along
               0x15, 0x00, 0x25, 0x7f, 0x75, 0x08, 0x95, 0x03, 0x81, 0x02,  //
               0x19, 0x01, 0x29, 0x02, 0x05, 0x09, 0x95, 0x02, 0x81, 0x02,  // buttons 1 and 2
               0x09, 0x32, 0xa4, 0x05, 0x01, 0xb4, 0x95, 0x01, 0x81, 0x02,  // pushed and popped: still page 9
               0xc0});
    ASSERT_TRUE(layout);
    EXPECT_EQ(layout->applications, (std::vector<HidUsage>{{kGenericDesktop, kJoystickUsage}}));
    std::vector<HidUsage> usages;
    for (const HidField& field : layout->fields) usages.push_back({field.usage_page, field.usage});
    EXPECT_EQ(usages, (std::vector<HidUsage>{{1, 0x30}, {1, 0x31}, {9, 2}, {9, 1}, {9, 2}, {9, 0x32}}));
}

TEST(ReportDescriptor, OfAHundredApplicationsIsNone) {
    Report many{0x05, 0x01};
    for (int i = 0; i < 100; ++i) many.insert(many.end(), {0x09, 0x04, 0xa1, 0x01, 0xc0});
    EXPECT_FALSE(parse_report_descriptor(many));
}

TEST(ReportDescriptor, WhatIsNone) {
    EXPECT_FALSE(parse_report_descriptor({}));
    Report cut = kGamepadDescriptor;
    cut.pop_back();  // a collection without an end
    EXPECT_FALSE(parse_report_descriptor(cut));
    EXPECT_FALSE(parse_report_descriptor(Report{0xc0}));        // an end without a beginning
    EXPECT_FALSE(parse_report_descriptor(Report{0x06, 0x01}));  // data missing
    EXPECT_FALSE(parse_report_descriptor(Report{0xfe}));        // a long item without its length
    EXPECT_FALSE(parse_report_descriptor(Report{0xb4}));        // popped, never pushed
    EXPECT_FALSE(parse_report_descriptor(Report{0x85, 0x00}));  // report number 0
    EXPECT_FALSE(parse_report_descriptor(Report(1000, 0xa4)));  // pushed without end
    Report huge{0x09, 0x30, 0x27, 0xff, 0xff, 0xff, 0x7f, 0x77, 0xff, 0xff,
                0xff, 0xff, 0x97, 0xff, 0xff, 0xff, 0xff, 0x81, 0x02};
    EXPECT_FALSE(parse_report_descriptor(huge));
}

// Reports of 32000 bits, a field of one bit each: no more than the limit are kept.
TEST(ReportDescriptor, KeepsNoMoreFieldsThanItsLimit) {
    const auto layout = parse_report_descriptor(Report{0x05, 0x01, 0x09, 0x04, 0xa1, 0x01, 0x09, 0x30, 0x25,
                                                       0x01, 0x75, 0x01, 0x96, 0x00, 0x7d, 0x81, 0x02, 0xc0});
    ASSERT_TRUE(layout);
    EXPECT_EQ(layout->fields.size(), 256U);
}

}  // namespace
}  // namespace thimble::test
