#include "visual_node/window/gl_window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <cstdlib>
#include <imgui.h>

#include <gmock/gmock.h>

#include "common/runtime/wall_clock.hpp"
#include "tests/refusal.hpp"
#include "tests/window/virtual_screen.hpp"
#include "visual_node/window/gui_layer.hpp"
#include "visual_node/window/image.hpp"

namespace thimble {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

std::string refusal_of_window() {
    return refusal([] { GlWindow window{WindowSettings{}}; }, ExitCode::kUsage);
}

// The window system answers when it likes: asks for a minute.
bool comes_true(GlWindow& window, const std::function<bool()>& request) {
    for (int i = 0; i < 6000 && !request(); ++i) window.wait_events(milliseconds{10});
    return request();
}

TEST(GlWindow, SaysThatTheScreenDoesNotAnswer) {
    setenv("DISPLAY", ":4711", 1);
    EXPECT_THAT(refusal_of_window(), HasSubstr(":4711"));
    unsetenv("DISPLAY");
}

using GlWindowOnAScreen = OnAScreen;

TEST_F(GlWindowOnAScreen, ReadsBackWhatItCleared) {
    GlWindow window{WindowSettings{}};
    window.begin_frame({255, 128, 0});
    const Image image = window.read_pixels();
    window.end_frame();
    ASSERT_EQ(image.width, 800);
    ASSERT_EQ(image.height, 600);
    for (const int x : {0, 399, 799}) {
        const Rgb colour = image.at(x, x % 600);
        EXPECT_EQ(colour, (Rgb{255, 128, 0}));
    }
}

TEST_F(GlWindowOnAScreen, GrowsWithTheContentScale) {
    WindowSettings settings;
    settings.width = 400;
    settings.height = 300;
    settings.content_scale = 2;
    GlWindow window{settings};
    EXPECT_EQ(window.width(), 800);
    EXPECT_EQ(window.height(), 600);
    EXPECT_EQ(window.content_scale(), 2);
}

TEST_F(GlWindowOnAScreen, TellsItsNewSize) {
    GlWindow window{WindowSettings{}};
    glfwSetWindowSize(window.handle(), 1000, 500);
    bool told = false;
    EXPECT_TRUE(comes_true(window, [&] {
        for (const WindowEvent& event : window.poll_events()) {
            told |= event.kind == WindowEvent::Kind::kResize && event.x == 1000 && event.y == 500;
        }
        return window.width() == 1000 && window.height() == 500;
    }));
    window.begin_frame({0, 0, 255});  // the driver looks at the new size when it swaps
    window.end_frame();
    window.begin_frame({0, 0, 255});
    EXPECT_EQ(window.read_pixels().at(999, 499), (Rgb{0, 0, 255}));
}

TEST_F(GlWindowOnAScreen, AKeyThatIsTappedBetweenTwoFramesIsPressedInTheNextOne) {
    GlWindow window{WindowSettings{}};
    GuiLayer gui(window);
    const auto left_is_pressed = [&] {
        window.begin_frame(kBlack);
        gui.begin();
        const bool pressed = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_LeftArrow), false);
        gui.end();
        window.end_frame();
        return pressed;
    };
    EXPECT_FALSE(left_is_pressed());
    ASSERT_TRUE(screen_->wait_for_window("Thimble"));
    ASSERT_TRUE(screen_->hand({"mousemove", "100", "100", "key", "Left"}));
    bool is_up = false;
    for (int i = 0; i < 6000 && !is_up; ++i) {
        for (const WindowEvent& event : window.wait_events(milliseconds{10}))
            is_up |= event.kind == WindowEvent::Kind::kKey && !event.pressed;
    }
    ASSERT_TRUE(is_up);
    EXPECT_TRUE(left_is_pressed());
    EXPECT_FALSE(left_is_pressed());
    EXPECT_FALSE(ImGui::IsKeyDown(ImGui::GetKeyIndex(ImGuiKey_LeftArrow)));
}

TEST_F(GlWindowOnAScreen, OutlivesItsScreen) {
    // Xlib's state belongs to the whole program: what breaks here must not meet the next test.
    EXPECT_EXIT(
        {
            GlWindow window{WindowSettings{}};
            window.begin_frame(kBlack);
            window.end_frame();
            const bool alive = !window.lost();
            screen_->kill();
            for (int i = 0; i < 6000 && !window.lost(); ++i) {
                window.wait_events(milliseconds{10});
                window.begin_frame(kBlack);
                window.end_frame();
            }
            std::_Exit(alive && window.lost() && window.should_close() ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

TEST(PngFile, GivesBackWhatWasWritten) {
    Image image{2, 3, {}};
    for (int i = 0; i < 18; ++i) image.rgb.push_back(static_cast<std::uint8_t>(13 * i));
    const TemporaryDirectory folder;
    const auto path = folder / "png_file_test.png";
    write_png(path, image);
    const Image read = read_png(path);
    EXPECT_EQ(read.width, 2);
    EXPECT_EQ(read.height, 3);
    EXPECT_EQ(read.rgb, image.rgb);
}

TEST(PngFile, SaysWhatItCannotWriteOrRead) {
    const Image dot{1, 1, {1, 2, 3}};
    EXPECT_THAT([&] { write_png("/nowhere/a.png", dot); },
                testing::ThrowsMessage<Error>(HasSubstr("/nowhere/a.png")));
    EXPECT_THAT([] { read_png("/nowhere/a.png"); },
                testing::ThrowsMessage<Error>(HasSubstr("/nowhere/a.png")));
}

}  // namespace
}  // namespace thimble
