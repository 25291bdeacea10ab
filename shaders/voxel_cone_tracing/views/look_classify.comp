#version 450
// A transfer function: what each voxel of a field emits and how opaque it is (thesis 004 Sec. 2.3). Emission is multiplied by the opacity.
layout(local_size_x = 4, local_size_y = 4, local_size_z = 4) in;

const int kColours = 0, kRamp = 1;
const int kField = 0, kAbsorption = 1, kSolid = 2;
layout(constant_id = 0) const int emission = kColours;
layout(constant_id = 1) const int opacityRule = kSolid;

layout(std140, binding = 0) uniform Classify {
  ivec3 resolution;
  int channels;      // of a value: 1 or 3
  ivec3 components;  // of the textures of the channels
  int level;         // of all textures
  float unit;        // that the number 1 stands for
  float low, high;   // ends of the ramp
  float absorption;  // 1/m at the value 1
  float voxelSize;   // m
  int opacityComponent;
  int opacityLevel;
  int multiplied;    // 1: the values are multiplied by the opacity already
  int direction;     // 1: the values are directions: -1..1 are shown as 0..1
};
layout(binding = 0) uniform sampler3D value0;
layout(binding = 1) uniform sampler3D value1;
layout(binding = 2) uniform sampler3D value2;
layout(binding = 3) uniform sampler3D opacityOf;
layout(binding = 0, rgba32f) uniform writeonly image3D classified;

// Black, blue, green, yellow, white: brightness rises along it.
vec3 rampOf(float share) {
  const vec3 kStops[5] = vec3[](vec3(0.0), vec3(0.05, 0.1, 0.7), vec3(0.0, 0.6, 0.3), vec3(0.95, 0.85, 0.1), vec3(1.0));
  float place = clamp(share, 0.0, 1.0) * 4.0;
  int stop = min(int(place), 3);
  return mix(kStops[stop], kStops[stop + 1], place - float(stop));
}

void main() {
  ivec3 voxel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(voxel, resolution))) return;
  vec3 value = vec3(texelFetch(value0, voxel, level)[components.x]);
  if (channels == 3) value.yz = vec2(texelFetch(value1, voxel, level)[components.y], texelFetch(value2, voxel, level)[components.z]);
  value *= unit;
  float size = channels == 3 ? length(value) : value.x;
  float opacity = 0.0;
  if (opacityRule == kField) opacity = clamp(texelFetch(opacityOf, voxel, opacityLevel)[opacityComponent], 0.0, 1.0);
  if (opacityRule == kAbsorption) opacity = 1.0 - exp(-absorption * abs(size) * voxelSize);
  if (opacityRule == kSolid) opacity = size != 0.0 ? 1.0 : 0.0;
  vec3 colour = direction != 0 ? 0.5 + 0.5 * value : max(value, 0.0);
  if (emission == kRamp) colour = rampOf((size - low) / (high - low));
  bool isMultiplied = multiplied != 0 && emission == kColours;
  imageStore(classified, voxel, vec4(colour * (isMultiplied ? 1.0 : opacity), opacity));
}
