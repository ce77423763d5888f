// Draws a Picture with OpenGL 3.3: the tissue as a lit block whose surface is a mesh, everything else as flat shapes. Made
// while a context is current; used and destroyed in the same thread. Throws Error (run failed) with the driver's words if it cannot compile a shader.
#pragma once

#include "visual_node/window/gl_shapes.hpp"

namespace thimble {

class Painter {
  public:
    // Into the lower left picture.size pixels of the current framebuffer. Does not clear.
    void paint(const Picture& picture);

  private:
    TissueBlock tissue_;
    FlatShapes shapes_;
};

}  // namespace thimble
