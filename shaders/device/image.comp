#version 450
// Loads, stores and atomics of images: on separate, adjacent texels, or on one texel for all invocations.
#pragma lumivox axis KIND d2 d3
#pragma lumivox axis FORMAT rgba16f rgba32f r32ui
#pragma lumivox axis ACCESS write read add contend
#pragma lumivox require !(ACCESS == add || ACCESS == contend) || FORMAT == r32ui

layout(local_size_x = 512) in;

layout(std140, binding = 0) uniform Parameters {
  uint rounds;
  ivec3 size;         // texels, powers of two
};
#if KIND == KIND_D3 && FORMAT == FORMAT_R32UI
layout(binding = 0, r32ui) uniform uimage3D volumeWords;
#define target volumeWords
#elif KIND == KIND_D3 && FORMAT == FORMAT_RGBA32F
layout(binding = 1, rgba32f) uniform image3D volume;
#define target volume
#elif KIND == KIND_D3
layout(binding = 1, rgba16f) uniform image3D volume;
#define target volume
#elif FORMAT == FORMAT_R32UI
layout(binding = 2, r32ui) uniform uimage2D imageWords;
#define target imageWords
#elif FORMAT == FORMAT_RGBA32F
layout(binding = 3, rgba32f) uniform image2D image;
#define target image
#else
layout(binding = 3, rgba16f) uniform image2D image;
#define target image
#endif
#if ACCESS == ACCESS_READ
layout(std430, binding = 0) writeonly buffer Results { vec4 results[]; };
#endif

const uint kAccessesPerRound = 8u;

void main() {
  uint i = gl_GlobalInvocationID.x;
  // Neighbouring invocations use adjacent texels. Each visits eight rows (slices of a volume), an eighth of the size apart, so that all
  // together reach every texel. The final value of a texel is its row or slice.
#if KIND == KIND_D3
  ivec3 at = ivec3(i, i / uint(size.x), i / uint(size.x * size.y)) & (size - 1);
#define along z
#else
  ivec2 at = ivec2(i, i / uint(size.x)) & (size.xy - 1);
#define along y
#endif
#if KIND == KIND_D3
  ivec3 one = ivec3(0);
#else
  ivec2 one = ivec2(0);
#endif
  int apart = size.along / int(kAccessesPerRound), most = size.along - 1;
  vec4 sum = vec4(0.0);
  for (uint round = 0u; round < rounds; ++round)
    for (uint k = 0u; k < kAccessesPerRound; ++k) {
      at.along = at.along + apart & most;
#if ACCESS == ACCESS_WRITE
#if FORMAT == FORMAT_R32UI
      imageStore(target, at, uvec4(at.along));
#else
      imageStore(target, at, vec4(at.along));
#endif
#elif ACCESS == ACCESS_READ
      sum += vec4(imageLoad(target, at));
#elif ACCESS == ACCESS_ADD
      imageAtomicAdd(target, at, 1u);
#else
      imageAtomicAdd(target, one, 1u);
#endif
    }
#if ACCESS == ACCESS_READ
  results[i] = sum;
#endif
}
