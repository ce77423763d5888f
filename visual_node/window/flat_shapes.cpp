#include "visual_node/window/flat_shapes.hpp"

#include <cassert>
#include <cmath>
#include <cstddef>
#include <glm/gtc/type_ptr.hpp>
#include <numbers>

namespace thimble {
namespace {

constexpr const char* kFlatVertexSource = R"(#version 330 core
layout(location = 0) in vec2 place;
layout(location = 1) in vec3 paint;
uniform mat4 to_clip;
out vec3 colour;

void main() {
    colour = paint;
    gl_Position = to_clip * vec4(place, 0.0, 1.0);
}
)";

constexpr const char* kFlatFragmentSource = R"(#version 330 core
in vec3 colour;
out vec4 shown;

void main() { shown = vec4(colour, 1.0); }
)";

constexpr int kCorners = 48;  // of an ellipse

}  // namespace

FlatShapes::FlatShapes()
    : shader_("flat shapes", kFlatVertexSource, kFlatFragmentSource), to_clip_(shader_.find("to_clip")) {
    glGenVertexArrays(1, &array_);
    glBindVertexArray(array_);
    glGenBuffers(1, &buffer_);
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    glBufferData(GL_ARRAY_BUFFER, sizeof(vertices_), nullptr, GL_STREAM_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), nullptr);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset, says OpenGL
                          reinterpret_cast<const void*>(offsetof(Vertex, colour)));
}

FlatShapes::~FlatShapes() {
    glDeleteBuffers(1, &buffer_);
    glDeleteVertexArrays(1, &array_);
}

void FlatShapes::triangle(glm::vec2 a, glm::vec2 b, glm::vec2 c, glm::vec3 colour) {
    assert(count_ + 3 <= kMostVertices);
    for (const glm::vec2 place : {a, b, c}) vertices_[count_++] = {place, colour};
}

void FlatShapes::rectangle(double left, double top, double right, double bottom, glm::vec3 colour) {
    const glm::vec2 a(left, top);
    const glm::vec2 b(right, top);
    const glm::vec2 c(right, bottom);
    const glm::vec2 d(left, bottom);
    triangle(a, b, c, colour);
    triangle(a, c, d, colour);
}

void FlatShapes::ellipse(glm::vec2 middle, glm::vec2 radii, glm::vec3 colour) {
    const auto corner = [&](int i) {
        const double angle = 2 * std::numbers::pi * i / kCorners;
        return middle + radii * glm::vec2(std::cos(angle), std::sin(angle));
    };
    for (int i = 0; i < kCorners; ++i) triangle(middle, corner(i), corner(i + 1), colour);
}

void FlatShapes::paint(const glm::mat4& to_clip) {
    shader_.use();
    glUniformMatrix4fv(to_clip_, 1, GL_FALSE, glm::value_ptr(to_clip));
    glBindVertexArray(array_);
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(count_ * sizeof(Vertex)), vertices_.data());
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(count_));
    count_ = 0;
}

}  // namespace thimble
