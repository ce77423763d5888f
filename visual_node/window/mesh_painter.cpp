#include <cstddef>

#include "visual_node/window/painter.hpp"

namespace thimble {
namespace {

constexpr const char* kMeshVertexSource = R"(layout(location = 0) in vec2 place;
layout(location = 1) in vec4 paint;
uniform vec2 pixel;  // in clip coordinates, y upwards
out vec4 colour;
void main() {
    colour = paint;
    gl_Position = vec4(place * pixel + vec2(-1.0, 1.0), 0.0, 1.0);
}
)";

constexpr const char* kMeshFragmentSource = R"(in vec4 colour;
out vec4 shown;
void main() { shown = colour; }
)";

template <class T>
void upload(GLenum target, GLuint buffer, const std::vector<T>& values) {
    glBindBuffer(target, buffer);
    glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(), GL_STREAM_DRAW);
}

}  // namespace

MeshPainter::MeshPainter()
    : program_(build_program("mesh", kMeshVertexSource, kMeshFragmentSource)),
      pixel_(glGetUniformLocation(program_, "pixel")) {
    glGenVertexArrays(1, &array_);
    glBindVertexArray(array_);
    glGenBuffers(1, &vertices_);
    glGenBuffers(1, &indices_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
    glEnableVertexAttribArray(0);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(Mesh::Vertex), nullptr);
    // NOLINTNEXTLINE(performance-no-int-to-ptr): OpenGL takes an offset as a pointer
    const auto* const colour_at = reinterpret_cast<const void*>(offsetof(Mesh::Vertex, rgba));
    glVertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(Mesh::Vertex), colour_at);
}

MeshPainter::~MeshPainter() {
    glDeleteBuffers(1, &vertices_);
    glDeleteBuffers(1, &indices_);
    glDeleteVertexArrays(1, &array_);
    glDeleteProgram(program_);
}

void MeshPainter::paint(const Mesh& mesh, int width, int height) const {
    if (mesh.indices().empty() || width <= 0 || height <= 0) return;
    glViewport(0, 0, width, height);
    glDisable(GL_DEPTH_TEST);  // from back to front
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glUseProgram(program_);
    glUniform2f(pixel_, 2 / static_cast<float>(width), -2 / static_cast<float>(height));
    glBindVertexArray(array_);
    upload(GL_ARRAY_BUFFER, vertices_, mesh.vertices());
    upload(GL_ELEMENT_ARRAY_BUFFER, indices_, mesh.indices());
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(mesh.indices().size()), GL_UNSIGNED_INT, nullptr);
    glDisable(GL_BLEND);
}

}  // namespace thimble
