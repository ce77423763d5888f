// The tissue of a Picture by OpenGL 3.3: a lit block seen from a little above, its surface a mesh that the vertex shader dents.
#pragma once

#include <epoxy/gl.h>

#include <boost/core/noncopyable.hpp>

#include "visual_node/window/picture.hpp"

namespace thimble {

class Painter : boost::noncopyable {
  public:
    // Made while a context is current; used and destroyed in the same thread. Throws Error (run failed) with the driver's words if it
    // cannot compile a shader.
    Painter();
    ~Painter();

    // Into the lower left picture.size pixels of the current framebuffer. Does not clear. The rest of a Picture is draw_over_tissue()'s
    // (captions.hpp).
    void paint(const Picture& picture) const;

  private:
    GLint find(const char* uniform) const { return glGetUniformLocation(program_, uniform); }

    GLuint program_, array_ = 0, vertices_ = 0, indices_ = 0;
    GLsizei index_count_ = 0;
};

}  // namespace thimble
