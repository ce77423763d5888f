// The screen, judged by its pixels.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/views/pixels.hpp"
#include "tests/window/virtual_screen.hpp"
#include "visual_node/visual_node.hpp"
#include "visual_node/window/image.hpp"
#include "visual_node/window/window_loop.hpp"

namespace thimble {
namespace {

constexpr double kRest_m = 0.020;

ForceFeedback sample(double needle_m, double surface_m, double force_N) {
    return {.position_needle_m = needle_m,
            .position_surface_m = surface_m,
            .force_total_N = -force_N,
            .phase = needle_m < surface_m ? TissuePhase::kFree : TissuePhase::kContact};
}

// The scene a subject gets, through the node that decides what that is.
Scene seen(Modality modality, const ForceFeedback& feedback) {
    VisualNode node{VisualSettings{}};
    node.start_trial(from_nanoseconds(1), {.modality = modality}, 1);
    node.on_picture(node.next_frame(), sample(0, kRest_m, 0));
    node.on_force(node.next_frame(), sample(0, kRest_m, 0));
    node.on_picture(node.next_frame(), feedback);
    node.on_force(node.next_frame(), feedback);
    return node.frame(node.next_frame()).value();
}

// A window, and the picture of a scene in it.
class ScenePicture : public OnAScreen {
  protected:
    static Image picture(const Scene& scene, int width = 800, int height = 600, double scale = 1,
                         bool embedded = false) {
        GlWindow window({.width = static_cast<int>(width / scale),
                         .height = static_cast<int>(height / scale),
                         .vsync = false,
                         .content_scale = scale,
                         .embedded = embedded});
        WindowDisplay display(Duration::zero());
        WindowLoop loop({&window, &display}, Duration::zero(), true);
        display.draw(from_nanoseconds(1), scene);
        return loop.picture();
    }
};

int count(const Image& image, const Rgb& colour, int y) {
    int found = 0;
    for (int x = 0; x < image.width; ++x) found += image.at(x, y) == colour ? 1 : 0;
    return found;
}

// The lowest row with the needle's white on its axis; -1: none.
int needle_end(const Image& image) {
    int end = -1;
    for (int y = 0; y < image.height; ++y) {
        for (int x = image.width / 2 - 3; x <= image.width / 2 + 3; ++x)
            end = image.at(x, y) == colours::kNeedle ? y : end;
    }
    return end;
}

TEST_F(ScenePicture, BarIsAsLongAsTheForceSays) {
    const auto expect_bar = [](double force_N, const PictureSize& size) {
        const Scene scene = seen(Modality::kVF, sample(0.03, 0.025, force_N));
        const Picture::Bar bar = picture_of(scene, size).bar.value();
        const Image image = picture(scene, size.width, size.height, size.content_scale);
        const int y = static_cast<int>(bar.top + bar.height / 2);
        const double full = 400 * size.content_scale;
        EXPECT_NEAR(count(image, colours::kBar, y), std::min(force_N / 12, 1.0) * full, 2)
            << force_N << " N, " << size.width << " wide, scale " << size.content_scale;
        EXPECT_NEAR(count(image, colours::kBar, y) + count(image, colours::kBarGround, y), full, 2);
    };
    for (const double force_N : {0.0, 1.5, 6.0, 11.9, 12.0, 30.0}) expect_bar(force_N, {800, 600, 1});
    for (const double scale : {1.0, 1.5}) expect_bar(6, {1200, 900, scale});
}

TEST_F(ScenePicture, NeedleEndsAtTheSurfaceHoweverDeepItIs) {
    for (const double needle_m : {0.025, 0.030, 0.060, 0.123}) {
        const Scene scene = seen(Modality::kHF, sample(needle_m, 0.025, 1));
        const Picture at = picture_of(scene, {});
        const Image image = picture(scene);
        EXPECT_NEAR(needle_end(image), at.surface_y + at.dimple_depth, 2) << needle_m;
        EXPECT_EQ(image.rgb, picture(seen(Modality::kHF, sample(0.025, 0.025, 1))).rgb) << needle_m;
    }
}

TEST_F(ScenePicture, NeedleMovesOutsideTheTissue) {
    const int high = needle_end(picture(seen(Modality::kHF, sample(0.000, kRest_m, 0))));
    const int low = needle_end(picture(seen(Modality::kHF, sample(0.015, kRest_m, 0))));
    EXPECT_NEAR(low - high, 0.015 * picture_of({}, {}).pixels_per_m, 2);
}

TEST_F(ScenePicture, SurfaceDimplesAroundTheNeedle) {
    const Image flat = picture(seen(Modality::kHF, sample(0.019, kRest_m, 0)));
    const Image dented = picture(seen(Modality::kHF, sample(0.035, 0.035, 1)));
    // The front's upper edge, in the middle and at the side: the first row from below that is lit as the top is.
    const Picture at = picture_of(seen(Modality::kHF, sample(0.035, 0.035, 1)), {});
    const auto changed = [&](double x_of_radius) {
        const int x = static_cast<int>(at.needle_x + x_of_radius * at.dimple_radius);
        int rows = 0;
        for (int y = 0; y < flat.height; ++y) rows += flat.at(x, y) != dented.at(x, y) ? 1 : 0;
        return rows;
    };
    EXPECT_GT(changed(1), 20);
    // Where the needle is, the ground is lower by as much as the surface has gone.
    EXPECT_NEAR(needle_end(dented) - picture_of(seen(Modality::kHF, sample(0.019, kRest_m, 0)), {}).surface_y,
                0.015 * at.pixels_per_m, 2);
}

TEST_F(ScenePicture, FingertipBlanches) {
    Scene scene = seen(Modality::kCF, sample(0.03, 0.025, 0));
    scene.fingertip_shown = true;
    const Picture::Fingertip finger = picture_of(scene, {}).fingertip.value();
    const auto nail = [&](double force_N) {
        scene.fingertip_N = force_N;
        return picture(scene).at(static_cast<int>(finger.x),
                                 static_cast<int>(finger.y - 0.35 * finger.radius));
    };
    const Rgb relaxed = nail(0), pressed = nail(2), pale = nail(4);
    EXPECT_GT(pressed[2], relaxed[2] + 20);
    EXPECT_GT(pale[2], pressed[2] + 20);
    EXPECT_EQ(pale, nail(9));
}

// WebGL 2 of a browser is OpenGL ES 3.
TEST_F(ScenePicture, OpenGLESDrawsTheSame) {
    Scene scene = seen(Modality::kCCF, sample(0.1, 0.025, 3));
    for (const bool cut_away : {false, true}) {
        if (cut_away) {
            scene.cut_away =
                CutAway{0.1, 0.12, -3, 0, std::nullopt, TissuePhase::kPenetrated, Modality::kCCF, true};
        }
        const Image desktop = picture(scene), embedded = picture(scene, 800, 600, 1, true);
        ASSERT_EQ(desktop.rgb.size(), embedded.rgb.size());
        std::size_t differ = 0;
        for (std::size_t i = 0; i < desktop.rgb.size(); ++i)
            differ += std::abs(desktop.rgb[i] - embedded.rgb[i]) > 8 ? 1U : 0U;
        EXPECT_LT(differ, desktop.rgb.size() / 500) << (cut_away ? "cut-away" : "subject");
    }
}

// docs/pictures shows what a subject sees with each modality at the fixture, 3 N against the needle. With
// THIMBLE_WRITE_PICTURES set they are made anew.
TEST_F(ScenePicture, DocumentedPicturesAreWhatIsDrawn) {
    for (const Modality modality : kModalities) {
        const Image image = picture(seen(modality, sample(0.032, 0.032, 3)));
        const auto path = std::filesystem::path(THIMBLE_SOURCE_DIR) / "docs/pictures" /
                          (std::string(to_string(modality)) + ".png");
        if (std::getenv("THIMBLE_WRITE_PICTURES") != nullptr) write_png(path, image);
        const Image kept = read_png(path);
        ASSERT_EQ(kept.width, image.width);
        ASSERT_EQ(kept.height, image.height);
        // Drivers round edges differently: few pixels may differ, the picture may not.
        const Rect whole{0, 0, static_cast<double>(image.width), static_cast<double>(image.height)};
        EXPECT_LT(count_different(image, kept, whole), image.width * image.height / 200)
            << to_string(modality);
        EXPECT_LT(std::filesystem::file_size(path), 60'000U);
    }
}

}  // namespace
}  // namespace thimble
