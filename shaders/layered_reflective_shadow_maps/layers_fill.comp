#version 450
// Fills the finest level of each layer: radiance, normals and depths of its texels; 0 for the texels of other layers.
layout(local_size_x = 8, local_size_y = 8) in;
#include "layer.glsl"
#include "slots.glsl"

layout(std430, binding = 7) readonly buffer Layers { Layer layers[]; };
layout(binding = 3) uniform usampler2DArray slotOfTexel;
layout(binding = 0) uniform writeonly image2DArray radianceImage;  // half floats or floats; normalImage the same
layout(binding = 1) uniform writeonly image2DArray normalImage;
layout(binding = 2, rg32f) uniform writeonly image2DArray depthImage;

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(at, imageSize(radianceImage)))) return;
  Layer layer = layers[at.z];
  ivec3 texel = ivec3(at.xy, layer.view);
  vec4 radiance = vec4(0.0), normal = vec4(0.0);
  vec2 depth = vec2(0.0);
  if (texelFetch(slotOfTexel, texel, 0).r == uint(layer.slot)) {
    MapTexel seen = texelOf(texel);
    // The radiance is the same in all directions: exitance, the flux over the area of the texel, divided by pi.
    radiance = vec4(min(texelFetch(rsmFlux, texel, 0).rgb / (kPi * seen.area * unit), most), 1.0);
    normal = vec4(seen.normal, 0.0);
    // Depths are relative to the interval: with squares of absolute depths, the variance far from the light is lost in rounding.
    float off = clamp((depthOf(lights[seen.light], layer.view, seen.posWorld) - layer.middle) / layer.halfWidth, -1.0, 1.0);
    depth = vec2(off, off * off);
  }
  imageStore(radianceImage, at, radiance);
  imageStore(normalImage, at, normal);
  imageStore(depthImage, at, vec4(depth, 0.0, 0.0));
}
