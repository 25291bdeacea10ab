#version 450
// Reflection of a Lambert surface under the same radiance L from all sides: the irradiance is pi L, of which albedo / pi is reflected.

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  float radiance;  // L, W/(sr m^2)
};

layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gDiffuse;
layout(binding = 0, rgba32f) uniform writeonly image2D diffuseImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(diffuseImage)))) return;
  vec3 reflected = vec3(0.0);
  bool isSurface = texelFetch(gPosition, pixel, 0).w != 0.0;
  if (isSurface) reflected = texelFetch(gDiffuse, pixel, 0).rgb * radiance;
  imageStore(diffuseImage, pixel, vec4(reflected, 1.0));
}
