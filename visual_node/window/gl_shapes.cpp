#include "visual_node/window/gl_shapes.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <glm/gtc/type_ptr.hpp>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "common/error.hpp"

namespace thimble {
namespace {

[[noreturn]] void refuse(const char* name, const char* words) {
    throw Error(ExitCode::kRunFailed,
                fmt::format("OpenGL refuses the shader '{}': {}; another driver may take it "
                            "(LIBGL_ALWAYS_SOFTWARE=1 draws in software)",
                            name, words));
}

GLuint compile(const char* name, GLenum kind, const char* source) {
    const GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint good = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (good == GL_TRUE) return shader;
    std::array<char, 1024> words{};
    glGetShaderInfoLog(shader, words.size(), nullptr, words.data());
    refuse(name, words.data());
}

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

// depth(): the surface of an elastic half-space under a rigid flat punch of radius a, u = u0 (2 / pi) arcsin(a / r) (Johnson,
// Contact Mechanics, 1985, eq. 3.38). The radius is ten times a needle's, so that it is seen: a drawing, no measurement.
// A vertex is (u, v, w): u from -1, left, to 1; v from -1, near, to 1, far; w = 1 beneath the near edge, at the bottom.
constexpr const char* kVertexSource = R"(#version 330 core
layout(location = 0) in vec3 place;
uniform mat4 to_clip;
uniform vec2 surface;  // x of the needle, y far from it
uniform vec3 block;    // half width, half depth, y of the bottom
uniform vec2 dimple;   // depth, radius
uniform float tilt;
out vec3 normal;
out float face;  // 0 on the surface, 1 on the front
out float down;  // 0 at the front's upper edge, 1 at its lower

float depth(vec2 at) {
    float r = length(at);
    return dimple.x * (r <= dimple.y ? 1.0 : asin(dimple.y / r) * 0.6366198);
}

void main() {
    vec2 at = place.xy * block.xy;
    float z = depth(at);
    float step = 0.5 * dimple.y;
    normal = normalize(vec3(depth(at + vec2(step, 0.0)) - depth(at - vec2(step, 0.0)),
                            depth(at + vec2(0.0, step)) - depth(at - vec2(0.0, step)), 2.0 * step));
    face = place.z < 0.0 ? 0.0 : 1.0;
    down = max(place.z, 0.0);
    float y = surface.y + z - at.y * tilt;
    gl_Position = to_clip * vec4(surface.x + at.x, mix(y, max(y, block.z), down), 0.0, 1.0);
}
)";

constexpr const char* kFragmentSource = R"(#version 330 core
in vec3 normal;
in float face;
in float down;
uniform vec3 colour;
out vec4 shown;

void main() {
    // Light from the upper left, in front.
    float light = clamp(dot(normalize(normal), normalize(vec3(-0.5, -0.35, 1.0))), 0.0, 1.0);
    float top = 0.45 + 0.65 * light;
    float front = 0.80 - 0.30 * down;
    shown = vec4(colour * mix(top, front, step(0.5, face)), 1.0);
}
)";

constexpr int kColumns = 96;  // even: a vertex lies on the needle's axis
constexpr int kRows = 40;

// Finer towards the middle, where the dimple is; -1 to 1.
float spread(int i, int count) {
    const float t = 2.0F * static_cast<float>(i) / static_cast<float>(count) - 1.0F;
    return 0.35F * t + 0.65F * t * t * t;
}

std::vector<glm::vec3> places() {
    std::vector<glm::vec3> all;
    for (int row = kRows; row >= 0; --row) {  // from afar, so that what is nearer is painted over it
        for (int i = 0; i <= kColumns; ++i) all.emplace_back(spread(i, kColumns), spread(row, kRows), -1);
    }
    for (int edge = 0; edge < 2; ++edge) {
        for (int i = 0; i <= kColumns; ++i) all.emplace_back(spread(i, kColumns), -1, edge);
    }
    return all;
}

// Two triangles per cell between one row of vertices and the next.
std::vector<GLuint> cells() {
    std::vector<GLuint> all;
    const GLuint stride = kColumns + 1;
    for (GLuint row = 0; row <= kRows + 1; ++row) {
        if (row == kRows) continue;  // the surface's last row and the front's first are the same edge
        for (GLuint i = 0; i < kColumns; ++i) {
            const GLuint a = row * stride + i;
            all.insert(all.end(), {a, a + 1, a + stride, a + 1, a + stride + 1, a + stride});
        }
    }
    return all;
}

}  // namespace

Shader::Shader(const char* name, const char* vertex_source, const char* fragment_source)
    : program_(glCreateProgram()) {
    const GLuint vertex = compile(name, GL_VERTEX_SHADER, vertex_source);
    const GLuint fragment = compile(name, GL_FRAGMENT_SHADER, fragment_source);
    glAttachShader(program_, vertex);
    glAttachShader(program_, fragment);
    glLinkProgram(program_);
    glDeleteShader(vertex);
    glDeleteShader(fragment);
    GLint good = GL_FALSE;
    glGetProgramiv(program_, GL_LINK_STATUS, &good);
    if (good == GL_TRUE) return;
    std::array<char, 1024> words{};
    glGetProgramInfoLog(program_, words.size(), nullptr, words.data());
    refuse(name, words.data());
}

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

TissueBlock::TissueBlock()
    : shader_("tissue", kVertexSource, kFragmentSource),
      to_clip_(shader_.find("to_clip")),
      surface_(shader_.find("surface")),
      block_(shader_.find("block")),
      dimple_(shader_.find("dimple")),
      tilt_(shader_.find("tilt")),
      colour_(shader_.find("colour")) {
    const auto vertices = places();
    const auto indices = cells();
    index_count_ = static_cast<GLsizei>(indices.size());
    glGenVertexArrays(1, &array_);
    glBindVertexArray(array_);
    glGenBuffers(1, &vertices_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(glm::vec3)),
                 vertices.data(), GL_STATIC_DRAW);
    glGenBuffers(1, &indices_);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(GLuint)),
                 indices.data(), GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
}

TissueBlock::~TissueBlock() {
    glDeleteBuffers(1, &vertices_);
    glDeleteBuffers(1, &indices_);
    glDeleteVertexArrays(1, &array_);
}

void TissueBlock::paint(const Picture& picture, const glm::mat4& to_clip) const {
    const auto f = [](double value) { return static_cast<float>(value); };
    shader_.use();
    glUniformMatrix4fv(to_clip_, 1, GL_FALSE, glm::value_ptr(to_clip));
    glUniform2f(surface_, f(picture.needle_x), f(picture.surface_y));
    glUniform3f(block_, f(picture.block_half_width), f(picture.block_half_depth), f(picture.block_bottom));
    glUniform2f(dimple_, f(picture.dimple_depth), f(picture.dimple_radius));
    glUniform1f(tilt_, f(kTilt));
    glUniform3fv(colour_, 1, glm::value_ptr(to_vec3(colours::kTissue)));
    glBindVertexArray(array_);
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace thimble
