#version 450
// Every stride-th pixel of a g-buffer as a point that stands for the surface around it.
layout(local_size_x = 64) in;
#include "common/constants.glsl"
#include "common/list.glsl"
#include "pixel_points.glsl"

layout(std140, binding = 0) uniform Parameters {
  vec3 eyeWorld;
  float pixelWidth;  // at distance 1 along the view axis, m
  vec3 forward;
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 0, rgba32f) uniform writeonly image2D positionImage;
layout(binding = 1, rgba32f) uniform writeonly image2D normalImage;
layout(binding = 2, rgba32f) uniform writeonly image2D radiusImage;

void main() {
  uint index = listIndex();
  if (index >= uint(pixelPoints.x * pixelPoints.y)) return;
  ivec2 pixel = pixelOfPoint(ivec2(int(index) % pixelPoints.x, int(index) / pixelPoints.x), textureSize(gPosition, 0));
  vec4 position = texelFetch(gPosition, pixel, 0);
  vec3 normal = texelFetch(gNormal, pixel, 0).xyz;
  float area = 0.0;
  if (position.w > 0.0) {
    vec3 path = position.xyz - eyeWorld;
    float depth = dot(path, forward), facing = -dot(path, normal);
    const float kMostGrazing = 0.05;  // of the depth: a more grazing patch would be wider than what is seen of it
    // The stride's square at depth 1 widens by depth^2, and by depth / facing on a slanted surface.
    float width = float(stride) * pixelWidth * depth;
    area = depth > 0.0 ? width * width * depth / max(facing, kMostGrazing * depth) : 0.0;
  }
  ivec2 texel = pointTexel(index);
  imageStore(positionImage, texel, vec4(position.xyz, area));
  imageStore(normalImage, texel, vec4(area > 0.0 ? normal : vec3(0.0), 0.0));
  imageStore(radiusImage, texel, vec4(sqrt(area / kPi), 0.0, 0.0, 1.0));
}
