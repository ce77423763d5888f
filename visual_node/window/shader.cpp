#include <array>

#include "common/error.hpp"
#include "visual_node/window/painter.hpp"

namespace thimble {
namespace {

constexpr const char* kDesktop = "#version 330 core\n";
constexpr const char* kEmbedded = "#version 300 es\nprecision highp float;\n";

// Words of the driver about a shader, or about a program.
using Log = void (*)(GLuint, GLsizei, GLsizei*, GLchar*);

void require(GLint good, GLuint object, const char* name, Log log) {
    if (good == GL_TRUE) return;
    std::array<char, 1024> words{};
    log(object, words.size(), nullptr, words.data());
    throw Error(
        ExitCode::kRunFailed,
        "OpenGL rejects the shader '{}': {}; try another driver (LIBGL_ALWAYS_SOFTWARE=1 draws in software)",
        name, words.data());
}

void attach(GLuint program, GLenum kind, const char* name, const char* source) {
    const GLuint shader = glCreateShader(kind);
    const std::array<const char*, 2> parts{epoxy_is_desktop_gl() ? kDesktop : kEmbedded, source};
    glShaderSource(shader, static_cast<GLsizei>(parts.size()), parts.data(), nullptr);
    glCompileShader(shader);
    GLint good = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    require(good, shader, name, glGetShaderInfoLog);
    glAttachShader(program, shader);
    glDeleteShader(shader);  // with the program
}

}  // namespace

GLuint build_program(const char* name, const char* vertex_source, const char* fragment_source) {
    const GLuint program = glCreateProgram();
    attach(program, GL_VERTEX_SHADER, name, vertex_source);
    attach(program, GL_FRAGMENT_SHADER, name, fragment_source);
    glLinkProgram(program);
    GLint good = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &good);
    require(good, program, name, glGetProgramInfoLog);
    return program;
}

}  // namespace thimble
