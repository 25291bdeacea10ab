// A store for cones with opacities in voxels and light in layers of reflective shadow maps: thesis 004, Sec. 3.3 (Sugihara,
// Rauwendaal & Salvi 2014), Fig. 43 b. The functions are those of shaders/voxel_cone_tracing/cones/store.glsl.
#pragma lumivox axis LIGHTS 0 1
#include "common/cones.glsl"
#include "common/lights.glsl"
#include "layer.glsl"

struct StoreSample {
  vec4 value;     // a opacity of voxels; rgb is filled in by the march
  float opacity;  // of the step
};

layout(std140, binding = 1) uniform Store {
  vec3 storeLow;                  // m
  float storeVoxel;               // size of the finest voxels, m
  vec3 storeExtent;               // m
  float storeCoarsest;            // coarsest level
  float storeUnit;                // radiance of the value 1, W/(sr m^2)
  int storeOpacityOfFinestVoxel;  // opacities are per 1: length of a finest voxel; 0: width of the voxel itself
  float slab;                     // thickness of the depth range that belongs to a step, in voxels of the size read
  int firstLight, lightsAtOnce;   // of this dispatch
  int firstLayer, layersAtOnce;   // of each view
};
layout(binding = 4) uniform sampler3D opacityGrid;
#if LIGHTS
layout(binding = 6) uniform sampler2DArray radianceLayers;
layout(binding = 7) uniform sampler2DArray normalLayers;
layout(binding = 8) uniform sampler2DArray depthLayers;
layout(std430, binding = 6) readonly buffer Views { mat4 views[]; };
layout(std430, binding = 7) readonly buffer Layers { Layer layers[]; };
layout(std430, binding = 8) readonly buffer ViewLayers { uvec2 viewLayers[]; };  // first layer, number of layers

layout(constant_id = 2) const int shareRule = 0;   // kNormal, kChebyshev
layout(constant_id = 4) const int facingRule = 1;  // 1: layers facing away are skipped; 0: normals are ignored
layout(constant_id = 5) const int slantRule = 1;   // the thickness of the slab is measured 1: along the surface's normal; 0: along the view
const int kNormal = 0, kChebyshev = 1;
const float kLeastSlant = 0.2;  // smallest cosine: more grazing views sample the surface too sparsely

// The cumulative normal distribution at x standard deviations (Page 1977), accurate to 3e-4.
float belowNormal(float x) { return 0.5 + 0.5 * tanh(clamp(0.79788456 * (x + 0.044715 * x * x * x), -20.0, 20.0)); }

// Chebyshev's inequality (Donnelly & Lauritzen 2006): upper bound of the share beyond a depth.
float mostBeyond(float depth, float mean, float variance) {
  float off = depth - mean;
  return off <= 0.0 ? 1.0 : variance / (variance + off * off);
}

// The share of a layer's depths between two depths.
float shareBetween(vec2 ends, float mean, float variance) {
  const float kLeast = 1e-6;  // for a plane across the view, whose variance is only rounding error
  variance = max(variance, kLeast);
  if (shareRule == kChebyshev) return max(mostBeyond(ends.x, mean, variance) - mostBeyond(ends.y, mean, variance), 0.0);
  vec2 off = (ends - mean) * inversesqrt(variance);
  return max(belowNormal(off.y) - belowNormal(off.x), 0.0);
}

// Radiance from the layers of a view at a point, opposite to a direction, over the unit. `size`: size of the voxels read, m.
vec3 shoneByView(LightSample light, int view, vec3 at, vec3 direction, float size) {
  uvec2 own = viewLayers[view];
  vec4 clip = views[view] * vec4(at, 1.0);
  if (own.y == 0u || !(clip.w > 0.0)) return vec3(0.0);
  vec2 place = vec2(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
  if (any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(1.0)))) return vec3(0.0);
  bool parallel = light.kind == kLightDirectional;
  float depth = parallel ? dot(at, light.direction) : clip.w;
  // The level whose texels are as wide as the voxels: the filter kernels of both are then equally wide.
  float level = log2(max(size / (light.texelWidth * (parallel ? 1.0 : depth)), 1.0));
  float thickness = slab * size, most = slantRule != 0 ? thickness / kLeastSlant : thickness;
  vec3 sum = vec3(0.0), toView = parallel ? light.direction : normalize(at - light.position);
  float depthOfRay = parallel ? 1.0 : min(depth / max(distance(at, light.position), 1e-12), 1.0);
  for (uint i = uint(firstLayer); i < min(own.y, uint(firstLayer + layersAtOnce)); ++i) {
    Layer layer = layers[own.x + i];
    float off = depth - layer.middle;
    if (abs(off) > layer.halfWidth + 0.5 * most) continue;
    vec3 texcoord = vec3(place, float(own.x + i));
    vec4 radiance = textureLod(radianceLayers, texcoord, level);
    if (!(radiance.a > 0.0)) continue;
    vec3 normal = textureLod(normalLayers, texcoord, level).xyz;
    if (facingRule != 0 && dot(normal, direction) >= 0.0) continue;
    float slant = abs(dot(normal, toView)) * inversesqrt(max(dot(normal, normal), 1e-12));
    // Extent of a slab of this thickness in depth: along the ray to the point thickness / slant, along
    // the view's axis less by the ray's cosine.
    float along = slantRule != 0 ? thickness * depthOfRay / max(slant, kLeastSlant) : thickness;
    vec2 moments = textureLod(depthLayers, texcoord, level).xy / radiance.a;
    vec2 ends = (off + vec2(-0.5, 0.5) * along) / layer.halfWidth;
    sum += shareBetween(ends, moments.x, moments.y - moments.x * moments.x) * radiance.rgb;
  }
  return sum;
}

vec3 shoneFrom(vec3 at, vec3 direction, float size) {
  vec3 sum = vec3(0.0);
  for (int i = firstLight; i < firstLight + lightsAtOnce; ++i) {
    LightSample light = lights[i];
    if (light.firstView < 0) continue;
    int view = light.firstView + (light.viewCount > 1 ? cubeFace(at - light.position) : 0);
    sum += shoneByView(light, view, at, direction, size);
  }
  return sum;
}
#endif

// The cone that is being traced.
vec3 coneApex;      // m
float coneTangent;  // tangent of its half angle

vec2 insideStore(vec3 origin, vec3 direction) { return insideVolume(storeLow, storeExtent, origin, direction); }

float finestVoxel(vec3 at) { return storeVoxel; }

float longestStep(float size) { return 1e30; }

StoreSample readStore(vec3 at, vec3 direction, float size, float stride) {
  float blend, level = levelOf(max(size / storeVoxel, 1.0), storeCoarsest, blend);
  float opacity = textureLod(opacityGrid, (at - storeLow) / storeExtent, level + blend).r;
  if (opacity <= 0.0) return StoreSample(vec4(0.0), 0.0);
  float through = max(1.0 - opacity, 0.0);
  float ofStep = storeOpacityOfFinestVoxel != 0
                     ? stepOpacityOf(through, stride / storeVoxel)
                     : stepOpacityOf(throughVoxel(through, blend), stride / (exp2(level) * storeVoxel));
  return StoreSample(vec4(0.0, 0.0, 0.0, opacity), ofStep);
}

#if LIGHTS
#define LIGHT_OF_STEP
vec3 lightOfStep(vec3 at, vec3 direction, float size) { return shoneFrom(at, direction, max(size, storeVoxel)); }
#endif
