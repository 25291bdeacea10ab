#version 450
// A coarser mip level of all layers: means over the finer texels, weighted by their overlap with the coarse texel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Mip {
  ivec2 coarse;  // texels of the level that is written
  ivec2 fine;    // of the level that is read
  int fineLevel;
};
layout(binding = 0) uniform sampler2DArray radianceLayers;
layout(binding = 1) uniform sampler2DArray normalLayers;
layout(binding = 2) uniform sampler2DArray depthLayers;
layout(binding = 0) uniform writeonly image2DArray radianceImage;
layout(binding = 1) uniform writeonly image2DArray normalImage;
layout(binding = 2, rg32f) uniform writeonly image2DArray depthImage;

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(at, imageSize(radianceImage)))) return;
  vec2 ratio = vec2(fine) / vec2(coarse), low = vec2(at.xy) * ratio, high = low + ratio;
  ivec2 first = ivec2(floor(low)), last = min(ivec2(ceil(high)) - 1, fine - 1);
  vec4 radiance = vec4(0.0), normal = vec4(0.0);
  vec2 depth = vec2(0.0);
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) {
      vec2 parts = clamp(min(high, vec2(x + 1, y + 1)) - max(low, vec2(x, y)), 0.0, 1.0) / ratio;
      float part = parts.x * parts.y;
      ivec3 finer = ivec3(x, y, at.z);
      radiance += part * texelFetch(radianceLayers, finer, fineLevel);
      normal += part * texelFetch(normalLayers, finer, fineLevel);
      depth += part * texelFetch(depthLayers, finer, fineLevel).xy;
    }
  imageStore(radianceImage, at, radiance);
  imageStore(normalImage, at, normal);
  imageStore(depthImage, at, vec4(depth, 0.0, 0.0));
}
