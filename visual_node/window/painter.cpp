#include "visual_node/window/painter.hpp"

#include <array>
#include <vector>

namespace thimble {
namespace {

// depth(): the surface of an elastic half-space under a rigid flat punch of radius a, u = u0 (2 / pi) arcsin(a / r) (Johnson,
// Contact Mechanics, 1985, eq. 3.38). The radius is ten times a needle's, so that it is seen: a drawing, no measurement.
// A vertex is (u, v, w): u from -1, left, to 1; v from -1, near, to 1, far; w = 1 beneath the near edge, at the bottom.
constexpr const char* kVertexSource = R"(layout(location = 0) in vec3 place;
uniform vec2 pixel;    // in clip coordinates, y upwards
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
    vec2 shown_at = vec2(surface.x + at.x, mix(y, max(y, block.z), down));
    gl_Position = vec4(shown_at * pixel + vec2(-1.0, 1.0), 0.0, 1.0);
}
)";

constexpr const char* kFragmentSource = R"(in vec3 normal;
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

using Place = std::array<float, 3>;

constexpr int kColumns = 96;  // even: a vertex lies on the needle's axis
constexpr int kRows = 40;

// Finer towards the middle, where the dimple is; -1 to 1.
float spread(int i, int count) {
    const float t = 2.0F * static_cast<float>(i) / static_cast<float>(count) - 1.0F;
    return 0.35F * t + 0.65F * t * t * t;
}

std::vector<Place> places() {
    std::vector<Place> all;
    for (int row = kRows; row >= 0; --row) {  // from afar, so that what is nearer is painted over it
        for (int i = 0; i <= kColumns; ++i) all.push_back({spread(i, kColumns), spread(row, kRows), -1});
    }
    for (int edge = 0; edge < 2; ++edge) {
        for (int i = 0; i <= kColumns; ++i)
            all.push_back({spread(i, kColumns), -1, static_cast<float>(edge)});
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

Painter::Painter() : program_(build_program("tissue", kVertexSource, kFragmentSource)) {
    const auto vertices = places();
    const auto indices = cells();
    index_count_ = static_cast<GLsizei>(indices.size());
    glGenVertexArrays(1, &array_);
    glBindVertexArray(array_);
    glGenBuffers(1, &vertices_);
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Place)), vertices.data(),
                 GL_STATIC_DRAW);
    glGenBuffers(1, &indices_);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(GLuint)),
                 indices.data(), GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Place), nullptr);
}

Painter::~Painter() {
    glDeleteBuffers(1, &vertices_);
    glDeleteBuffers(1, &indices_);
    glDeleteVertexArrays(1, &array_);
    glDeleteProgram(program_);
}

void Painter::paint(const Picture& picture) const {
    const auto f = [](double value) { return static_cast<float>(value); };
    const PictureSize& size = picture.size;
    glViewport(0, 0, size.width, size.height);
    glDisable(GL_DEPTH_TEST);  // from back to front
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    glUseProgram(program_);
    glUniform2f(find("pixel"), 2 / f(size.width), -2 / f(size.height));
    glUniform2f(find("surface"), f(picture.needle_x), f(picture.surface_y));
    glUniform3f(find("block"), f(picture.block_half_width), f(picture.block_half_depth),
                f(picture.block_bottom));
    glUniform2f(find("dimple"), f(picture.dimple_depth), f(picture.dimple_radius));
    glUniform1f(find("tilt"), f(kTilt));
    const Colour& tissue = colours::kTissue;
    glUniform3f(find("colour"), f(tissue[0] / 255.0), f(tissue[1] / 255.0), f(tissue[2] / 255.0));
    glBindVertexArray(array_);
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace thimble
