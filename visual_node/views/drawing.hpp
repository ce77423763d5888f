// Drawing in ImGui for the panels: colours by name, whole pixels, text that ends where it should, and the keys and buttons of
// commands.hpp.
#pragma once

#include <array>
#include <functional>
#include <imgui.h>
#include <initializer_list>
#include <optional>
#include <span>

#include "visual_node/views/commands.hpp"
#include "visual_node/views/stop_control.hpp"
#include "visual_node/views/text_line.hpp"
#include "visual_node/views/view_layout.hpp"
#include "visual_node/window/image.hpp"

namespace thimble {

// `opacity` 0 to 1.
ImU32 paint(Colour colour, double opacity = 1);
ImVec4 gui_colour(Colour colour);
ImVec2 point(double x, double y);
ImVec2 corner(const Rect& rect);      // top left
ImVec2 far_corner(const Rect& rect);  // bottom right
ImVec2 extent(const Rect& rect);

// Small text for axes and legends. Returns its width.
double draw_text(ImDrawList& list, const ImVec2& where, Colour colour, const char* text);
// Ends at `where`.x.
void draw_text_left_of(ImDrawList& list, const ImVec2& where, Colour colour, const char* text);
double small_text_height();

// Dashes of `dash` pixels and gaps as long, from top to bottom.
void draw_dashed_vertical(ImDrawList& list, double x, double top, double bottom, double width, double dash,
                          Colour colour);

// Filled: hides what is behind it. Bare: the window's own background is its background, because each pixel that is painted
// twice costs where OpenGL is software.
enum class Ground { kFilled, kBare };

// A plain ImGui window at this place, which can neither be moved nor closed, and scrolls what does not fit. Call ImGui::End()
// after it in any case.
void begin_fixed(const char* name, const Rect& rect, Ground ground);

// The keys typed since the last frame, in order; at most so many.
struct TypedCommands {
    std::array<Command, 16> commands{};
    std::size_t count = 0;

    const Command* begin() const { return commands.data(); }
    const Command* end() const { return commands.data() + count; }
};
// Arrows are the delay's steps and Escape is No, as far as `keys` has them. None while the user types a number into a
// field. Inside an ImGui frame.
TypedCommands typed_commands(std::span<const Key> keys);

// A button that fills `cell`, with its key beside its name and its help as a tooltip. True when pressed. `chosen`: it is lit.
// Within a window of ImGui.
bool draw_button(std::span<const Key> keys, Command command, const Rect& cell, bool chosen = false,
                 const char* name = nullptr);

// The row in which ImGui stands, of the window's width.
Rect row_here(double height);
// Buttons of the same width beside one another, those lit for which `chosen` is true; the one that was pressed.
std::optional<Command> draw_button_row(std::span<const Key> keys, std::initializer_list<Command> commands,
                                       const Rect& row, double scale,
                                       const std::function<bool(Command)>& chosen = {});

// Slider of the one-way delay; true when it was moved, with the new value.
bool draw_delay_slider(const Rect& cell, double& delay_s);

// Every key with its help, within `area`.
void draw_key_help(std::span<const Key> keys, const Rect& area, double scale);

// A strip for the emergency stop: its button, or, while a stop holds, the one that releases it.
void draw_stop_strip(StopControl& stops, const Rect& strip, double scale, SessionTime now);

}  // namespace thimble
