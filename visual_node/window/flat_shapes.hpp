// Triangles of one colour each, in pixels: collected, then drawn at once. The memory is asked for once.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "visual_node/window/shader.hpp"

namespace thimble {

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

}  // namespace thimble
