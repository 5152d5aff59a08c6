#include "viewer/window/texture_blit.h"

#include <glad/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/base/error.h"

namespace mdk {
namespace {

// One triangle that covers the viewport; the corners come from the vertex number alone.
constexpr const char* kVertexShader = R"(#version 330 core
out vec2 texcoord;
void main() {
  vec2 corner = vec2(float((gl_VertexID & 1) << 2), float((gl_VertexID & 2) << 1));
  texcoord = vec2(corner.x * 0.5, 1.0 - corner.y * 0.5);
  gl_Position = vec4(corner - 1.0, 0.0, 1.0);
})";

constexpr const char* kFragmentShader = R"(#version 330 core
in vec2 texcoord;
out vec4 color;
uniform sampler2D picture;
void main() { color = vec4(texture(picture, texcoord).rgb, 1.0); })";

unsigned compile(unsigned kind, const char* source) {
  const unsigned shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  int compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (!compiled) {
    std::array<char, 1024> log{};
    glGetShaderInfoLog(shader, static_cast<int>(log.size()), nullptr, log.data());
    throw Error(ErrorCode::kInternal,
                std::string("OpenGL does not compile the viewer's shader: ") + log.data());
  }
  return shader;
}

}  // namespace

PixelRect letterbox(const PixelRect& space, std::uint32_t picture_width,
                    std::uint32_t picture_height) {
  if (picture_width == 0 || picture_height == 0 || space.width <= 0 || space.height <= 0) return {};
  const double scale = std::min(static_cast<double>(space.width) / picture_width,
                                static_cast<double>(space.height) / picture_height);
  const int width = static_cast<int>(std::lround(picture_width * scale));
  const int height = static_cast<int>(std::lround(picture_height * scale));
  return {space.x + (space.width - width) / 2, space.y + (space.height - height) / 2, width,
          height};
}

TextureBlit::TextureBlit() {
  const unsigned vertex = compile(GL_VERTEX_SHADER, kVertexShader);
  const unsigned fragment = compile(GL_FRAGMENT_SHADER, kFragmentShader);
  program_ = glCreateProgram();
  glAttachShader(program_, vertex);
  glAttachShader(program_, fragment);
  glLinkProgram(program_);
  glDeleteShader(vertex);
  glDeleteShader(fragment);

  glGenVertexArrays(1, &vertex_array_);
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

TextureBlit::~TextureBlit() {
  glDeleteTextures(1, &texture_);
  glDeleteVertexArrays(1, &vertex_array_);
  glDeleteProgram(program_);
}

void TextureBlit::upload(std::span<const std::uint32_t> pixels, std::uint32_t width,
                         std::uint32_t height) {
  if (pixels.size() != static_cast<std::size_t>(width) * height)
    throw Error(ErrorCode::kInternal, "a picture does not have the size it was asked for");
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  const auto w = static_cast<int>(width), h = static_cast<int>(height);
  if (width == width_ && height == height_)
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, w, h, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  else
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, w, h, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  width_ = width;
  height_ = height;
}

void TextureBlit::draw(const PixelRect& space, int framebuffer_height) const {
  if (width_ == 0) return;
  const PixelRect to = letterbox(space, width_, height_);
  glViewport(to.x, framebuffer_height - to.y - to.height, to.width, to.height);
  glDisable(GL_BLEND);
  glUseProgram(program_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glBindVertexArray(vertex_array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glUseProgram(0);
}

}  // namespace mdk
