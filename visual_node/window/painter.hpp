// The tissue of a Picture by OpenGL 3.3: a lit block seen from a little above, its surface a mesh that the vertex shader dents.
#pragma once

#include <epoxy/gl.h>

#include <boost/core/noncopyable.hpp>

#include "visual_node/window/mesh.hpp"
#include "visual_node/window/picture.hpp"

namespace thimble {

// Sources without their first line: "#version" and the precision are those of the current context. Throws Error (run failed) with the
// driver's words about the shader `name`.
GLuint build_program(const char* name, const char* vertex_source, const char* fragment_source);

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

// Draws a Mesh by OpenGL 3.3 or OpenGL ES 3: one program, one call.
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
