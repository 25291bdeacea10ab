#version 450
// Thesis 004, Sec. 4.5: bilateral upsampling (Kopf, Cohen, Lischinski & Uyttendaele 2007, "Joint bilateral upsampling"). Blends 4 x 4
// samples of the march, one period of the dither pattern, with weights that favour rays that end at a similar distance.
#include "common/joint_bilateral.glsl"
#include "range.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Parameters {
  float similarity;  // relative difference of the ends of two rays at which they are no longer similar
};
layout(binding = 1) uniform sampler2D scatteredSamples;
layout(binding = 2) uniform sampler2D transmittanceSamples;
layout(binding = 0, rgba32f) uniform writeonly image2D scatteredImage;
layout(binding = 1, rgba32f) uniform writeonly image2D transmittanceImage;

const float kLeast = 0.02;  // weight, along an axis, of a sample at the filter's radius

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, textureSize(gPosition, 0)))) return;
  float reach;
  vec3 direction = rayOf(pixel, reach);
  vec2 range = insideMedia(eyeWorld, direction, reach);
  vec3 scattered = vec3(0.0), transmittance = vec3(1.0);
  if (range.x < range.y) {
    ivec2 samples = textureSize(scatteredSamples, 0);
    float radius = 2.0 * float(pixelsPerSample);
    ivec2 first = firstOfFour(pixel, ivec2(pixelsPerSample));
    vec3 sum = vec3(0.0), through = vec3(0.0);
    float weights = 0.0;
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) {
        ivec2 texel = first + ivec2(x, y);
        if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, samples))) continue;
        vec4 value = texelFetch(scatteredSamples, texel, 0);
        vec2 away = abs(vec2(pixelOf(texel) - pixel));
        float difference = (value.w - range.y) / (similarity * range.y);
        // If no sample is similar, the nearest in depth wins, because the weight never vanishes.
        float alike = 1.0 / (1.0 + difference * difference);
        float weight = tent(away.x, radius, kLeast) * tent(away.y, radius, kLeast) * max(alike * alike * alike * alike, 1e-20);
        sum += weight * value.rgb;
        through += weight * texelFetch(transmittanceSamples, texel, 0).rgb;
        weights += weight;
      }
    scattered = sum / weights;
    transmittance = through / weights;
  }
  imageStore(scatteredImage, pixel, vec4(scattered, 1.0));
  imageStore(transmittanceImage, pixel, vec4(transmittance, 1.0));
}
