#include "visual_node/window/shader.hpp"

#include <array>

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

}  // namespace thimble
