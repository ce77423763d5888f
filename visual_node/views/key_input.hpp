// Keys and buttons of one list (commands.hpp) in ImGui.
#pragma once

#include <array>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>

#include "visual_node/views/commands.hpp"
#include "visual_node/views/view_layout.hpp"

namespace thimble {

// The keys typed since the last frame, in order; at most so many.
struct TypedCommands {
    std::array<Command, 16> commands{};
    std::size_t count = 0;

    const Command* begin() const { return commands.data(); }
    const Command* end() const { return commands.data() + count; }
};
// Arrows are the delay's steps and Escape is No, as far as `keys` has them. None while the user types a number into a field. Inside an ImGui frame.
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

// Every key with its help, in a window over the others.
void draw_key_help(std::span<const Key> keys, double scale);

}  // namespace thimble
