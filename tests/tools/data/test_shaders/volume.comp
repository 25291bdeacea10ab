// Reads a volume and an image, counts in a volume; the format of `summed` follows an axis.
#pragma lumivox axis WIDE 0 1
#pragma lumivox axis TEXTURED 0 1
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;
layout(binding = 0) uniform sampler3D radiance;
#if TEXTURED
layout(binding = 1) uniform sampler2D albedo;
#endif
layout(r32ui, binding = 0) uniform uimage3D counts;
#if WIDE
layout(rgba32f, binding = 1) uniform writeonly image3D summed;
#else
layout(rgba16f, binding = 1) uniform writeonly image3D summed;
#endif
void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  vec4 value = texelFetch(radiance, voxel, 0);
#if TEXTURED
  value *= textureLod(albedo, vec2(0.5), 0.0);
#endif
  imageAtomicAdd(counts, ivec3(0), 1u);
  imageStore(summed, voxel, value);
}
