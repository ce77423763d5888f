// A program of shaders that OpenGL 3.3, OpenGL ES 3 and WebGL 2 take alike.
#pragma once

#include <epoxy/gl.h>

namespace thimble {

// Sources without their first line: "#version" and the precision are those of the current context. Throws Error (run failed) with the
// driver's words about the shader `name`.
GLuint build_program(const char* name, const char* vertex_source, const char* fragment_source);

}  // namespace thimble
