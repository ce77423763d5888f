#include "visual_node/visual_node.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "tests/unit/session_time.hpp"
#include "visual_node/recording_display.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

SessionControl trial(Modality modality, std::uint64_t seed = 1) {
    return {.study_seed = seed, .subject = 3, .experiment = 2, .modality = modality};
}

ForceFeedback feedback(double needle_m, double surface_m, double total_N = 0,
                       TissuePhase phase = TissuePhase::kFree) {
    return {.position_needle_m = needle_m,
            .position_surface_m = surface_m,
            .force_total_N = total_N,
            .phase = phase};
}

// A picture as late as the force, or no delay.
void give(VisualNode& node, SessionTime now, const ForceFeedback& feedback, SessionTime answered = {}) {
    node.on_picture(now, feedback, answered);
    node.on_force(now, feedback);
}

VisualNode started(Modality modality, SessionTime start = {}, const VisualSettings& settings = {}) {
    VisualNode node{settings};
    node.start_trial(start, trial(modality), 1);
    return node;
}

// The scene drawn when the only feedback of a trial is `message`, so long ago.
Scene scene_of(const ForceFeedback& message, Modality modality, const VisualSettings& settings = {},
               Duration silence = {}) {
    VisualNode node = started(modality, at(seconds{1}), settings);
    const SessionTime now = node.next_frame();
    give(node, now - silence, message);
    return node.frame(now).value();
}

ForceFeedback arbitrary_feedback() {
    const auto metres = [] { return 1e-4 * *rc::gen::inRange(-2000, 2000); };
    ForceFeedback message = feedback(metres(), metres(), 0.01 * *rc::gen::inRange(-3000, 1000),
                                     static_cast<TissuePhase>(*rc::gen::inRange(0, 3)));
    message.position_proxy_m = metres();
    message.velocity_surface_m_per_s = metres();
    message.force_tissue_N = 0.01 * *rc::gen::inRange(-100, 100);
    message.force_fixture_N = 0.01 * *rc::gen::inRange(-3000, 0);
    message.contact_time_s = 0.01 * *rc::gen::inRange(0, 500);
    message.fixture_present = *rc::gen::arbitrary<bool>();
    return message;
}

Modality arbitrary_modality() { return static_cast<Modality>(*rc::gen::inRange(0, 4)); }

bool same(const Scene& a, const Scene& b) {
    return a.position_needle_m == b.position_needle_m && a.position_surface_m == b.position_surface_m &&
           a.bar_N == b.bar_N && a.bar_full_scale_N == b.bar_full_scale_N && a.touching == b.touching &&
           a.sample_time == b.sample_time;
}

TEST(VisualNode, TheInsertedPartIsNeverVisible) {
    EXPECT_TRUE(rc::check("needle never beyond the surface, and how deep it is makes no difference", [] {
        const Modality modality = arbitrary_modality();
        ForceFeedback message = arbitrary_feedback();
        const Scene scene = scene_of(message, modality);
        RC_ASSERT(scene.position_needle_m <= scene.position_surface_m);
        RC_ASSERT(scene.position_surface_m == message.position_surface_m);
        if (message.position_needle_m < message.position_surface_m) {
            RC_ASSERT(scene.position_needle_m == message.position_needle_m);
            return;
        }
        message.position_needle_m = message.position_surface_m + 1e-4 * *rc::gen::inRange(0, 2000);
        RC_ASSERT(same(scene_of(message, modality), scene));
    }));
}

TEST(VisualNode, TheFixtureIsNeverVisible) {
    EXPECT_TRUE(rc::check("nothing of the fixture changes the scene", [] {
        const Modality modality = arbitrary_modality();
        const ForceFeedback message = arbitrary_feedback();
        ForceFeedback other = arbitrary_feedback();
        other.position_needle_m = message.position_needle_m;
        other.position_surface_m = message.position_surface_m;
        other.phase = message.phase;
        // The bar of VF shows the total force, that is its purpose; in other modalities not even that is
        // seen.
        if (modality == Modality::kVF) other.force_total_N = message.force_total_N;
        RC_ASSERT(same(scene_of(message, modality), scene_of(other, modality)));
    }));
}

TEST(VisualNode, BarHasWholePixelsAndAnEnd) {
    EXPECT_TRUE(rc::check("bar is the resisting force, clipped, rounded down to a pixel", [] {
        const ForceFeedback message = arbitrary_feedback();
        const double bar_N = scene_of(message, Modality::kVF).bar_N;
        const double force_N = std::fmin(std::fmax(-message.force_total_N, 0), 12);
        const double pixels = bar_N * 400 / 12;
        RC_ASSERT(std::fabs(pixels - std::round(pixels)) < 1e-9);
        RC_ASSERT(bar_N <= force_N + 1e-12);
        RC_ASSERT(bar_N > force_N - 12.0 / 400 - 1e-12);
    }));
    struct Bar {
        double full_N;
        int pixels;
        double total_N, bar_N;
    };
    for (const Bar& bar : {Bar{12, 400, -100, 12},
                           {12, 400, 5, 0},  // pulling out
                           {12, 400, -0.029, 0},
                           {12, 400, -0.031, 0.03},
                           {6, 12, -1.2, 1},
                           {6, 12, -5.99, 5.5},
                           {6, 12, std::nan(""), 0}}) {
        const VisualSettings settings{.bar_full_scale_N = bar.full_N, .bar_resolution = bar.pixels};
        const Scene scene = scene_of(feedback(0.05, 0.1, bar.total_N), Modality::kVF, settings);
        EXPECT_DOUBLE_EQ(scene.bar_N, bar.bar_N) << bar.total_N;
        EXPECT_EQ(scene.bar_full_scale_N, bar.full_N);
    }
}

// Of the bar, and of the fingers of a person without devices.
TEST(VisualNode, WhatIsShownFollowsThePolicyFromTheLimitOn) {
    constexpr Duration kAfter = milliseconds{100};
    struct Late {
        StaleMode mode;
        Duration silence;
        double shown_N;
    };
    for (const Late& late : {Late{StaleMode::kZero, kAfter - Duration{1}, 6},
                             {StaleMode::kZero, kAfter, 0},
                             {StaleMode::kHold, milliseconds{900}, 6},
                             {StaleMode::kRamp, kAfter, 6},
                             {StaleMode::kRamp, milliseconds{110}, 3},
                             {StaleMode::kRamp, milliseconds{120}, 0}}) {
        const VisualSettings settings{.stale = {late.mode, kAfter, milliseconds{20}}, .fingertip = true};
        const auto shown = [&](Modality modality) {
            return scene_of(feedback(0.05, 0.1, -6), modality, settings, late.silence);
        };
        EXPECT_DOUBLE_EQ(shown(Modality::kVF).bar_N, late.shown_N);
        EXPECT_DOUBLE_EQ(shown(Modality::kCF).fingertip_N, late.shown_N);
        EXPECT_EQ(shown(Modality::kVF).stale, late.silence >= kAfter) << "for the screen to say so";
        EXPECT_EQ(shown(Modality::kVF).position_needle_m, 0.05) << "the needle stays where it was last seen";
    }
}

// The bar in VF, and two fingers for a person without devices in CF and CCF.
TEST(VisualNode, EachModalityShowsItsOwn) {
    for (const bool fingertip : {false, true}) {
        const VisualSettings settings{.fingertip = fingertip};
        for (const Modality modality : kModalities) {
            SCOPED_TRACE(to_string(modality));
            const bool pressed = fingertip && (modality == Modality::kCF || modality == Modality::kCCF);
            const Scene none = scene_of(feedback(0.05, 0.1, std::nan("")), modality, settings);
            EXPECT_EQ(none.bar_shown, modality == Modality::kVF);
            EXPECT_EQ(none.fingertip_shown, pressed);
            EXPECT_EQ(none.bar_N + none.fingertip_N + none.thumb_N, 0);
            const Scene resisted = scene_of(feedback(0.05, 0.1, -3), modality, settings);
            EXPECT_EQ(resisted.bar_N, modality == Modality::kVF ? 3 : 0);
            EXPECT_EQ(resisted.fingertip_N, pressed ? 3 : 0);
            EXPECT_EQ(resisted.thumb_N, 0);
            VisualNode node = started(modality, {}, settings);
            give(node, at({}), feedback(0.05, 0.1, 3));
            const Scene drawn = node.frame(node.next_frame()).value();
            EXPECT_EQ(drawn.fingertip_N, 0);
            EXPECT_EQ(drawn.thumb_N, pressed ? 3 : 0);
            node.end_trial(drawn.sample_time);
            EXPECT_EQ(node.frame(node.next_frame()).value().thumb_N, 0);
        }
    }
}

TEST(VisualNode, ASceneKnowsItsTrialItsStampsAndTheSurfaceAtRest) {
    VisualNode node{VisualSettings{}};
    for (const std::uint32_t number : {4U, 5U}) {
        node.start_trial(at(seconds{number}), trial(Modality::kHF), number);
        const double rest_m = 0.01 * number;
        give(node, at(seconds{number}), feedback(0, rest_m));
        ForceFeedback second = feedback(0.2, rest_m + 0.005);
        second.echo_time = at(milliseconds{17});
        give(node, at(seconds{number}), second, at(milliseconds{19}));
        const SessionTime drawn = node.next_frame();
        const Scene scene = node.frame(drawn).value();
        EXPECT_LT(node.next_frame() - drawn, milliseconds{17});
        EXPECT_EQ(scene.trial, number);
        EXPECT_EQ(scene.position_surface_rest_m, rest_m);
        EXPECT_EQ(scene.position_surface_m, rest_m + 0.005);
        EXPECT_EQ(scene.hand_time, at(milliseconds{17}));
        EXPECT_EQ(scene.answer_time, at(milliseconds{19}));
    }
}

TEST(VisualNode, TheFirstInstantBelongsToTheTrial) {
    VisualNode node = started(Modality::kVF, at(seconds{3}));
    EXPECT_DOUBLE_EQ(node.beep(at(seconds{3} + milliseconds{40})).sample_age_s, 0.040) << "nothing seen yet";
    Scene scene{.sample_time = at(seconds{3}) - Duration{1}};
    EXPECT_FALSE(node.to_percept({scene, at(seconds{4})}));
    scene.sample_time = at(seconds{3});
    EXPECT_TRUE(node.to_percept({scene, at(seconds{4})}));
}

TEST(VisualNode, TouchingIsSeen) {
    EXPECT_FALSE(scene_of(feedback(0.09, 0.1), Modality::kHF).touching);
    EXPECT_TRUE(scene_of(feedback(0.1, 0.1), Modality::kHF).touching);
    EXPECT_TRUE(scene_of(feedback(0.11, 0.11, 0, TissuePhase::kContact), Modality::kHF).touching);
    for (const TissuePhase phase : {TissuePhase::kContact, TissuePhase::kPenetrated})
        EXPECT_TRUE(scene_of(feedback(0.099, 0.1, 0, phase), Modality::kHF).touching);
}

TEST(VisualNode, ShowsTheNewestFeedback) {
    VisualNode node = started(Modality::kHF);
    EXPECT_FALSE(node.frame(node.next_frame()).has_value()) << "nothing to show yet";
    const SessionTime now = node.next_frame();
    give(node, now - milliseconds{2}, feedback(0.01, 0.1));
    give(node, now - milliseconds{1}, feedback(0.02, 0.1));
    const Scene scene = node.frame(now).value();
    EXPECT_EQ(scene.position_needle_m, 0.02);
    EXPECT_EQ(scene.sample_time, now - milliseconds{1});
}

TEST(VisualNode, ThePictureComesBeforeTheFirstForceAndTheBarWithIt) {
    VisualNode node = started(Modality::kVF, at(seconds{1}), {.stale = {StaleMode::kZero, milliseconds{1}}});
    const SessionTime first = node.next_frame();
    node.on_picture(first, feedback(0.02, 0.1, -6));
    const Scene early = node.frame(first).value();
    EXPECT_EQ(early.position_needle_m, 0.02);
    EXPECT_EQ(early.bar_N, 0) << "that force is still in the network";
    EXPECT_FALSE(early.stale);
    const SessionTime second = node.next_frame();
    node.on_picture(second, feedback(0.03, 0.1, -6));
    node.on_force(second, feedback(0.02, 0.1, -3));
    const Scene later = node.frame(second).value();
    EXPECT_EQ(later.position_needle_m, 0.03);
    EXPECT_EQ(later.bar_N, 3);
    node.on_force(node.next_frame(), feedback(0.02, 0.1, -3));
    EXPECT_TRUE(node.frame(node.next_frame())->stale) << "no picture comes any more";
}

TEST(VisualNode, FramesComeAtSixtyHertzWithoutDrift) {
    VisualNode node = started(Modality::kHF, at(seconds{5}));
    give(node, at(seconds{5}), feedback(0, 0.1));
    const SessionTime first = node.next_frame();
    EXPECT_GE(first, at(seconds{5}));
    EXPECT_LT(first, at(seconds{5}) + Duration{16'666'668});
    EXPECT_FALSE(node.frame(first - Duration{1}).has_value());
    for (int k = 0; k < 6000; ++k) {
        const SessionTime now = node.next_frame();
        ASSERT_LE(std::abs((now - first).count() - k * 1'000'000'000LL / 60), 1) << k;
        ASSERT_TRUE(node.frame(now).has_value());
        ASSERT_FALSE(node.frame(now).has_value());
    }
    EXPECT_EQ(node.next_frame(), first + seconds{100});
}

TEST(VisualNode, ALateFrameKeepsThePhase) {
    VisualNode node = started(Modality::kHF);
    const SessionTime first = node.next_frame();
    node.frame(first + milliseconds{990});
    EXPECT_EQ(node.next_frame(), first + seconds{1});
    node.frame(first + seconds{2});  // as late as to be on the next one's time
    EXPECT_GT(node.next_frame(), first + seconds{2});
}

TEST(VisualNode, PhaseIsDrawnPerTrialAndRepeats) {
    const auto phase = [](std::uint64_t seed, std::uint32_t number, Modality modality, SessionTime start) {
        VisualNode node{VisualSettings{}};
        node.start_trial(start, trial(modality, seed), number);
        return (node.next_frame() - start).count();
    };
    std::set<std::int64_t> phases;
    double sum_s = 0;
    for (std::uint32_t number = 1; number <= 400; ++number) {
        const std::int64_t drawn = phase(1, number, Modality::kVF, at({}));
        EXPECT_EQ(phase(1, number, Modality::kHF, at(seconds{9})), drawn);
        EXPECT_NE(phase(2, number, Modality::kVF, at({})), drawn);
        phases.insert(drawn);
        sum_s += static_cast<double>(drawn) * 1e-9;
    }
    EXPECT_EQ(phases.size(), 400U);
    // Uniform over the period: four standard errors.
    EXPECT_NEAR(sum_s / 400, 0.5 / 60, 4 / 60.0 / std::sqrt(12.0 * 400));
}

TEST(VisualNode, EndsWithOneFrameWithoutABar) {
    VisualNode node{{.stale = {StaleMode::kHold}}};
    EXPECT_EQ(node.next_frame(), kNever);
    node.start_trial(at({}), trial(Modality::kVF), 1);
    give(node, at({}), feedback(0.05, 0.1, -6));
    node.end_trial(at(milliseconds{1}));
    give(node, at(milliseconds{1}), feedback(0.2, 0.3, -6));
    const auto last = node.frame(at(seconds{1}));
    ASSERT_TRUE(last.has_value());
    EXPECT_EQ(last->bar_N, 0);
    EXPECT_FALSE(last->stale) << "what is over is not late";
    EXPECT_EQ(last->position_needle_m, 0.05);
    EXPECT_EQ(node.next_frame(), kNever);
}

TEST(VisualNode, PerceptIsWhatTheScreenShowed) {
    const VisualSettings settings;
    VisualNode node(settings);
    RecordingDisplay display(settings.pipeline);
    node.start_trial(at({}), trial(Modality::kVF), 1);
    node.frame(node.next_frame());  // the first may come too early for a sample that is 3 ms old
    const SessionTime drawn = node.next_frame();
    give(node, drawn - milliseconds{3}, feedback(0.2, 0.11, -3, TissuePhase::kPenetrated));
    display.draw(drawn, node.frame(drawn).value());
    EXPECT_EQ(display.next_shown(), drawn + milliseconds{25});
    const Percept percept = node.to_percept(display.shown(display.next_shown()).value()).value();
    EXPECT_EQ(percept.position_needle_shown_m, 0.11);
    EXPECT_EQ(percept.position_surface_shown_m, 0.11);
    EXPECT_EQ(percept.bar_N, 3);
    EXPECT_TRUE(percept.touching_shown);
    EXPECT_DOUBLE_EQ(percept.sample_age_s, 0.028);
    EXPECT_FALSE(percept.beep);
    EXPECT_EQ(percept.finger, Finger::kNone);
}

TEST(VisualNode, BeepIsHeardAtOnceAndStays) {
    VisualNode node = started(Modality::kVF);
    Scene scene{.bar_N = 4, .sample_time = at(milliseconds{30})};
    EXPECT_FALSE(node.to_percept({scene, at(milliseconds{60})})->beep);
    const Percept heard = node.beep(at(milliseconds{70}));
    EXPECT_TRUE(heard.beep);
    EXPECT_EQ(heard.bar_N, 4) << "what was seen last is still on the screen";
    EXPECT_DOUBLE_EQ(heard.sample_age_s, 0.040);
    EXPECT_TRUE(node.to_percept({scene, at(milliseconds{80})})->beep);
    node.start_trial(at(milliseconds{100}), trial(Modality::kVF), 2);
    scene.sample_time = at(milliseconds{110});
    EXPECT_FALSE(node.to_percept({scene, at(milliseconds{140})})->beep);
}

TEST(VisualNode, NothingOfAnEarlierTrialIsSeen) {
    VisualNode node{VisualSettings{}};
    RecordingDisplay display(milliseconds{25});
    node.start_trial(at({}), trial(Modality::kVF), 1);
    give(node, at({}), feedback(0.2, 0.1, -9, TissuePhase::kPenetrated));
    const SessionTime drawn = node.next_frame();
    display.draw(drawn, node.frame(drawn).value());
    node.start_trial(drawn + milliseconds{1}, trial(Modality::kVF), 2);
    EXPECT_FALSE(node.to_percept(display.shown(drawn + milliseconds{25}).value()).has_value());
    EXPECT_FALSE(node.frame(node.next_frame()).has_value());
    EXPECT_FALSE(node.beep(drawn + milliseconds{30}).touching_shown);
}

}  // namespace
}  // namespace thimble
