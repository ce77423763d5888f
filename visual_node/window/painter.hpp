// Draws a Picture with OpenGL 3.3: the tissue as a lit block whose surface is a mesh, everything else as flat shapes. Made
// while a context is current; used and destroyed in the same thread.
#pragma once

#include <memory>

#include "visual_node/window/picture.hpp"

namespace thimble {

class Painter {
  public:
    // Throws Error (run failed) with the driver's words if it cannot compile a shader.
    Painter();
    ~Painter();
    Painter(const Painter&) = delete;
    Painter& operator=(const Painter&) = delete;

    // Into the lower left picture.size pixels of the current framebuffer. Does not clear.
    void paint(const Picture& picture);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace thimble
