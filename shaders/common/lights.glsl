// Direct light: an array of point samples with shadow views. C++ side: framework/include/lumivox/toolkit/light_samples.h, port ShadowMap.
#ifndef LUMIVOX_LIGHTS
#define LUMIVOX_LIGHTS
#include "common/constants.glsl"

const int kLightDirectional = 0;
const int kLightPoint = 1;
const int kLightSpot = 2;
const int kLightArea = 3;  // one sample of an emissive triangle

struct LightSample {
  vec3 position;             // posWorld
  int kind;
  vec3 direction;            // the way the light travels; area: normal of the front side
  int firstView;             // its first shadow layer, -1 without shadow
  vec3 power;                // directional: irradiance W/m^2; point, spot: intensity W/sr; area: radiance times area W/sr
  int viewCount;             // shadow layers: 1, or the 6 faces of a cube
  float cosInner, cosOuter;  // of a spot; for an area sample, cosInner holds partOfLight()
  float texelWidth;          // of a shadow texel: m (directional), or m per metre of distance
  float patchRadiusSquared;  // of the patch that an area sample represents, m^2
};

// 1 over the number of samples of the same area light that light the same surfaces; 1 for other lights.
float partOfLight(LightSample light) { return light.kind == kLightArea ? light.cosInner : 1.0; }

layout(std430, binding = 5) readonly buffer Lights { LightSample lights[]; };
#ifdef SHADOW_VIEWS
layout(std430, binding = 6) readonly buffer Views { mat4 views[]; };
layout(binding = 7) uniform sampler2DArrayShadow shadowDepth;
#endif

// Irradiance on a plane perpendicular to the arriving light, W/m^2, without visibility; toLight has unit length. At the light's own
// position there is no direction to the light: irradiance and toLight are 0.
vec3 arrivingIrradiance(LightSample light, vec3 posWorld, out vec3 toLight) {
  int kind = light.kind;
  if (kind == kLightDirectional) {
    toLight = -light.direction;
    return light.power;
  }
  vec3 path = light.position - posWorld;
  if (dot(path, path) == 0.0) {
    toLight = vec3(0.0);
    return vec3(0.0);
  }
  toLight = normalize(path);
  // A disc of radius r seen from its axis at distance d gives pi r^2 L / (d^2 + r^2); for a point r is 0.
  float distanceSquared = dot(path, path) + light.patchRadiusSquared;
  float cosLight = dot(-toLight, light.direction);
  float shape = 1.0;
  if (kind == kLightSpot) shape = smoothstep(light.cosOuter, light.cosInner, cosLight);
  if (kind == kLightArea) shape = max(0.0, cosLight);
  return light.power * (shape / distanceSquared);
}

// Number of the cube map face that holds a direction, in the order +x -x +y -y +z -z.
int cubeFace(vec3 direction) {
  vec3 size = abs(direction);
  if (size.x >= size.y && size.x >= size.z) return direction.x >= 0.0 ? 0 : 1;
  if (size.y >= size.z) return direction.y >= 0.0 ? 2 : 3;
  return direction.z >= 0.0 ? 4 : 5;
}

#ifdef SHADOW_VIEWS
// Visible fraction in [0,1]. The point is moved along its normal by 0.5 to 2 texels of the shadow view, by the light's angle, so that a
// surface does not shadow itself (normal offset); geometricNormal faces the lit side.
float visibility(LightSample light, vec3 posWorld, vec3 geometricNormal, vec3 toLight) {
  int layer = light.firstView;
  if (layer < 0) return 1.0;
  int kind = light.kind;
  vec3 path = posWorld - light.position;
  float texel = light.texelWidth * (kind == kLightDirectional ? 1.0 : length(path));
  float sine = sqrt(max(0.0, 1.0 - dot(geometricNormal, toLight) * dot(geometricNormal, toLight)));
  vec3 lookup = posWorld + geometricNormal * (texel * (0.5 + 1.5 * sine));
  if (light.viewCount > 1) layer += cubeFace(lookup - light.position);
  vec4 clip = views[layer] * vec4(lookup, 1.0);
  if (clip.w <= 0.0) return 1.0;
  vec3 projected = clip.xyz / clip.w;
  // Row 0 of a shadow layer is its top, as in every render target.
  vec2 texcoord = vec2(0.5 + 0.5 * projected.x, 0.5 - 0.5 * projected.y);
  if (any(lessThan(texcoord, vec2(0.0))) || any(greaterThan(texcoord, vec2(1.0)))) return 1.0;
  return texture(shadowDepth, vec4(texcoord, float(layer), min(projected.z, 1.0)));
}
#endif

#endif
