// Measures the unit of a constant depth bias. OpenGL leaves it to the driver (4.5, 14.6.5), and the units of
// two drivers on one rasteriser differ by a factor of 2: a point at the edge of a shadow would be lit with
// one of them alone.
#include <cassert>
#include <cmath>

#include "gpu/state.h"

namespace lumivox::gpu {
namespace {

constexpr float kDepth = 0.5f;
constexpr double kUnit = 0x1p-24;       // the smallest difference of 32-bit depths from kDepth on
constexpr float kUnitsAsked = 4096.0f;  // exact in the depth that comes out, whatever the driver's unit

constexpr const char* kWholeTarget = R"(#version 450 core
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.5, 1.0); }
)";
constexpr const char* kNothing = R"(#version 450 core
void main() {}
)";

/// The depth of one pixel at kDepth with that bias.
float biasedDepth(GLuint framebuffer, GLuint target, GLuint program) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, 1, 1);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_ALWAYS);
  glDepthMask(GL_TRUE);
  glDisable(GL_DEPTH_CLAMP);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(0.0f, kUnitsAsked);
  glUseProgram(program);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  float depth = 0.0f;
  glGetTextureImage(target, 0, GL_DEPTH_COMPONENT, GL_FLOAT, sizeof(depth), &depth);
  return depth;
}

}  // namespace

float DeviceState::depthBiasScale() {
  if (foundDepthBiasScale) return *foundDepthBiasScale;
  assert(!drawing);
  GLuint target = 0, framebuffer = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &target);
  glTextureStorage2D(target, 1, GL_DEPTH_COMPONENT32F, 1, 1);
  glCreateFramebuffers(1, &framebuffer);
  glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, target, 0);
  glNamedFramebufferDrawBuffer(framebuffer, GL_NONE);
  const GLuint program = linkProgram({{GL_VERTEX_SHADER, {kWholeTarget}}, {GL_FRAGMENT_SHADER, {kNothing}}});
  const float depth = biasedDepth(framebuffer, target, program);
  glUseProgram(0);
  glDeleteProgram(program);
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteTextures(1, &target);
  forgetBindings();
  check("finding the unit of the depth bias");
  const double unit = (static_cast<double>(depth) - kDepth) / kUnitsAsked;
  foundDepthBiasScale = unit > 0.0 && std::isfinite(unit) ? static_cast<float>(kUnit / unit) : 1.0f;
  return *foundDepthBiasScale;
}

}  // namespace lumivox::gpu
