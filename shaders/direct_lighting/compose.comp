#version 450
// The image is the sum of its components, with the surfaces attenuated by the media. An absent input has no effect.
#pragma lumivox axis DIFFUSE 0 1
#pragma lumivox axis GLOSSY 0 1
#pragma lumivox axis TRANSMITTANCE 0 1
#pragma lumivox axis SCATTERED 0 1

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D directRadiance;
#if DIFFUSE
layout(binding = 1) uniform sampler2D diffuseRadiance;
#endif
#if GLOSSY
layout(binding = 2) uniform sampler2D glossyRadiance;
#endif
#if TRANSMITTANCE
layout(binding = 3) uniform sampler2D mediaTransmittance;
#endif
#if SCATTERED
layout(binding = 4) uniform sampler2D scatteredRadiance;
#endif
layout(binding = 0, rgba32f) uniform writeonly image2D radianceImage;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(radianceImage)))) return;
  vec3 radiance = texelFetch(directRadiance, pixel, 0).rgb;
#if DIFFUSE
  radiance += texelFetch(diffuseRadiance, pixel, 0).rgb;
#endif
#if GLOSSY
  radiance += texelFetch(glossyRadiance, pixel, 0).rgb;
#endif
#if TRANSMITTANCE
  radiance *= texelFetch(mediaTransmittance, pixel, 0).rgb;
#endif
#if SCATTERED
  radiance += texelFetch(scatteredRadiance, pixel, 0).rgb;
#endif
  imageStore(radianceImage, pixel, vec4(radiance, 1.0));
}
