// Xlib's reaction to the end of the X server: by default it ends the program. Here it only remembers.
#pragma once

namespace thimble {

// For the display that GLFW uses; call after glfwInit(). Nothing to do, and harmless, under Wayland.
void survive_screen_loss();
// The connection has broken. Nothing may be asked of GLFW any more.
bool screen_lost();

}  // namespace thimble
