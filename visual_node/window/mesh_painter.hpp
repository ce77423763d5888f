// Draws a Mesh by OpenGL 3.3 or OpenGL ES 3: one program, one call.
#pragma once

#include <boost/core/noncopyable.hpp>

#include "visual_node/window/mesh.hpp"
#include "visual_node/window/shader.hpp"

namespace thimble {

class MeshPainter : boost::noncopyable {
  public:
    // Made while a context is current; used and destroyed in the same thread. Throws Error as build_program() does.
    MeshPainter();
    ~MeshPainter();

    // Over what is there, into a framebuffer of this size, y from the top.
    void paint(const Mesh& mesh, int width, int height) const;

  private:
    GLuint program_, array_ = 0, vertices_ = 0, indices_ = 0;
    GLint pixel_;
};

}  // namespace thimble
