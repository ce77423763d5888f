// What is painted with OpenGL 3.3: the tissue, and flat shapes.
#pragma once

#include <array>
#include <epoxy/gl.h>
#include <glm/glm.hpp>

#include "visual_node/window/image.hpp"
#include "visual_node/window/picture.hpp"

namespace thimble {

// A program on the graphics card, and its uniforms by name.
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

// Triangles of one colour each, in pixels: collected, then drawn at once. The memory is asked for once.
class FlatShapes {
  public:
    FlatShapes();
    ~FlatShapes();
    FlatShapes(const FlatShapes&) = delete;
    FlatShapes& operator=(const FlatShapes&) = delete;

    void triangle(glm::vec2 a, glm::vec2 b, glm::vec2 c, glm::vec3 colour);
    void rectangle(double left, double top, double right, double bottom, glm::vec3 colour);
    void ellipse(glm::vec2 middle, glm::vec2 radii, glm::vec3 colour);
    // `to_clip`: from pixels, y downwards, to clip coordinates.
    void paint(const glm::mat4& to_clip);

  private:
    struct Vertex {
        glm::vec2 place;
        glm::vec3 colour;
    };
    static constexpr std::size_t kMostVertices = 1536;

    Shader shader_;
    GLint to_clip_;
    GLuint array_ = 0, buffer_ = 0;
    std::array<Vertex, kMostVertices> vertices_{};
    std::size_t count_ = 0;
};

// The tissue: a block seen from a little above, its surface a mesh that the vertex shader dents.
class TissueBlock {
  public:
    TissueBlock();
    ~TissueBlock();
    TissueBlock(const TissueBlock&) = delete;
    TissueBlock& operator=(const TissueBlock&) = delete;

    // `to_clip`: from pixels, y downwards, to clip coordinates.
    void paint(const Picture& picture, const glm::mat4& to_clip) const;

  private:
    Shader shader_;
    GLint to_clip_, surface_, block_, dimple_, tilt_, colour_;
    GLuint array_ = 0, vertices_ = 0, indices_ = 0;
    GLsizei index_count_ = 0;
};

}  // namespace thimble
