// A program on the graphics card, and its uniforms by name.
#pragma once

#include <epoxy/gl.h>
#include <glm/glm.hpp>

#include "visual_node/window/image.hpp"

namespace thimble {

class Shader {
  public:
    // Throws Error (run failed) with `name` and the driver's words.
    Shader(const char* name, const char* vertex_source, const char* fragment_source);
    ~Shader() { glDeleteProgram(program_); }
    Shader(const Shader&) = delete;
    Shader& operator=(const Shader&) = delete;

    void use() const { glUseProgram(program_); }
    GLint find(const char* uniform) const { return glGetUniformLocation(program_, uniform); }

  private:
    GLuint program_ = 0;
};

inline glm::vec3 to_vec3(const Rgb& colour) { return glm::vec3(colour[0], colour[1], colour[2]) / 255.0F; }

}  // namespace thimble
