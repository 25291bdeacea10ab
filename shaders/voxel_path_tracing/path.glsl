// Light paths through binary voxels: Thiedemann, Henrich, Grosch & Mueller 2011; thesis Gomes 2015, Sec. 3.2.4. The bits give the hit point
// of a ray. Reflective shadow maps give the direct light and the material there; in shadow, the
// averaged attributes of the voxels give the material.
#pragma lumivox axis MAP 0 1
#pragma lumivox axis GLOSSY 0 1      // surfaces have a Phong lobe
#pragma lumivox axis ATTRIBUTES 0 1  // paths go on from surfaces in shadow
// With PLANES 1, included after common/voxel_planes.glsl: rays end at planes within voxels.
#include "common/bit_rays.glsl"
#include "common/brdf.glsl"
#include "common/cones.glsl"
#include "common/environment.glsl"
#include "common/random.glsl"
#if MAP
#include "common/back_projection.glsl"
#endif

layout(constant_id = 2) const int normalOfVoxels = 0;  // 1: lit surfaces too use the voxel's normal for new directions, as printed
layout(constant_id = 3) const int pushes = 1;          // 1: the origin of a ray in a set voxel moves out of it along the normal
layout(constant_id = 4) const int roulette = 0;        // 1: Russian roulette ends dim paths

layout(std140, binding = 1) uniform Path {
  vec3 environment;  // W/(sr m^2)
  float offset;      // of a ray's origin along the normal, in units of reachOfPlane()
  vec3 eye;          // posWorld
  float reach;       // of a ray, voxels
  uvec2 seed;
  uint number;       // index of the path of each pixel, counted over all accumulated frames
  int bounce;        // number of surfaces that the path has left: 1 for the ray from the visible surface
  int bounces;       // limit of `bounce`
  int raysAtOnce;    // number of rays that trace.comp follows from that surface on
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 1) uniform sampler2D gNormal;
layout(binding = 2) uniform sampler2D gGeometricNormal;
#if GLOSSY
layout(binding = 6) uniform sampler2D gDiffuse;
layout(binding = 7) uniform sampler2D gSpecular;
#endif
#if MAP
layout(binding = 10) uniform sampler2DArray rsmAlbedo;
#if GLOSSY
layout(binding = 11) uniform sampler2DArray rsmSpecular;
#endif
#endif
#if ATTRIBUTES
layout(binding = 12) uniform sampler3D voxelAlbedo;
layout(binding = 13) uniform sampler3D voxelNormal;
#endif

struct Surface {
  vec3 place;     // voxels
  vec3 normal;    // unit, on the side of the path
  vec3 outwards;  // unit: direction in which the origins of leaving rays are offset
  vec3 toViewer;  // unit: back along the path
  vec3 diffuse;   // albedo
  vec4 specular;  // Phong albedo, exponent in w
};

// The next direction of a path. Both weights are divided by the density of the direction.
struct Choice {
  vec3 direction;
  float diffuse;  // cosine / pi
  float glossy;   // Phong lobe of albedo 1, times the cosine
};

vec3 reflectedBy(Surface surface, Choice choice) { return surface.diffuse * choice.diffuse + surface.specular.rgb * choice.glossy; }

// Probability of sampling the Phong lobe. It is at most 0.75, which limits the diffuse weight to 4,
// because filters may blend it among pixels.
float shareOfLobe(Surface surface) {
  const vec3 kOne = vec3(1.0);
  float diffuse = dot(surface.diffuse, kOne), glossy = dot(surface.specular.rgb, kOne);
  return glossy > 0.0 ? min(glossy / (diffuse + glossy), 0.75) : 0.0;
}

// A direction about the mirror direction, with the density (n + 1) / (2 pi) cos^n.
vec3 lobeDirection(vec2 point, float exponent, vec3 mirror) {
  float cosMirror = pow(1.0 - point.x, 1.0 / (exponent + 1.0)), angle = 2.0 * kPi * point.y;
  float sine = sqrt(max(1.0 - cosMirror * cosMirror, 0.0));
  vec3 tangent = tangentTo(mirror);
  return normalize(sine * (cos(angle) * tangent + sin(angle) * cross(mirror, tangent)) + cosMirror * mirror);
}

// Independent random words: `use` 0 for a direction, 1 for Russian roulette.
uvec4 noiseOf(ivec2 at, int fromSurface, int use) {
  return hash4(uvec4(uint(at.x) | uint(at.y) << 16u, number, uint(2 * fromSurface + use), seed.x ^ (seed.y * 2654435769u)));
}

// Samples a direction from both lobes, weighted by the density of their mixture (Veach 1997, Sec. 9.2.4). The first direction follows R2,
// as do the rays of a single bounce. Further directions are independent: otherwise paths would only
// have pairs of directions from the sequence.
Choice chosen(ivec2 at, Surface surface, int fromSurface) {
  uvec4 noise = noiseOf(at, fromSurface, 0);
  if (fromSurface == 0) {
    // The choice of the lobe follows multiples of the golden ratio, so that each lobe gets its share even of few paths.
    uvec4 turn = hash4(uvec4(at, seed));
    noise = uvec4(wordsOfR2(number, turn.xy), number * 2654435769u + turn.z, 0u);
  }
  vec2 point = unitInterval(noise.xy);
  vec3 tangent = tangentTo(surface.normal), bitangent = cross(surface.normal, tangent);
  Choice result = Choice(cosineDirection(point, 1.0, tangent, bitangent, surface.normal), 1.0, 0.0);
#if GLOSSY
  float share = shareOfLobe(surface);
  if (share == 0.0) return result;
  vec3 mirror = reflect(-surface.toViewer, surface.normal);
  float exponent = surface.specular.w;
  if (unitInterval(noise.zw).x < share) result.direction = lobeDirection(point, exponent, mirror);
  float cosTheta = dot(surface.normal, result.direction), cosMirror = max(dot(mirror, result.direction), 0.0);
  // Directions below the horizon carry no light, as in the reference.
  if (cosTheta <= 0.0) return Choice(result.direction, 0.0, 0.0);
  float lobe = exponent > 0.0 ? pow(cosMirror, exponent) : (cosMirror > 0.0 ? 1.0 : 0.0);
  lobe /= 2.0 * kPi;
  float density = (1.0 - share) * cosTheta / kPi + share * (exponent + 1.0) * lobe;
  result.diffuse = cosTheta / (kPi * density);
  result.glossy = (exponent + 2.0) * lobe * cosTheta / density;
#endif
  return result;
}

// Whether a ray that begins at a place ends at once at the box of its voxel.
bool isStuck(vec3 place) {
  ivec3 voxel = ivec3(floor(place));
  if (any(lessThan(voxel, ivec3(0))) || any(greaterThanEqual(voxel, resolution))) return false;
#if PLANES
  if (planesOf(voxel) != 0u) return false;
#endif
  uvec4 stack = texelFetch(bitStacks, ivec3(voxel.xy, voxel.z / kStackBits), 0);
  return (stack[voxel.z >> 5 & 3] >> (voxel.z & 31) & 1u) != 0u;
}

// The origin of rays that leave a surface, in voxels.
vec3 startOf(Surface surface, bool mayPush) {
  const float kStep = 0.25;  // voxels; at most eight steps, two voxels
  vec3 start = surface.place + surface.outwards * (offset * reachOfPlane(surface.outwards));
  if (!mayPush || pushes == 0 || !isStuck(start)) return start;
  for (int i = 1; i <= 8; ++i) {
    vec3 further = start + float(i) * kStep * surface.outwards;
    if (!isStuck(further)) return further;
  }
  return start;
}

// The visible surface of a pixel; false: there is none.
bool visibleSurface(ivec2 at, out Surface surface) {
  vec4 position = texelFetch(gPosition, at, 0);
  surface = Surface((position.xyz - gridLow) / voxelSize, texelFetch(gNormal, at, 0).xyz, texelFetch(gGeometricNormal, at, 0).xyz,
                    normalize(eye - position.xyz), vec3(1.0), vec4(0.0));
#if GLOSSY
  surface.diffuse = texelFetch(gDiffuse, at, 0).rgb;
  surface.specular = texelFetch(gSpecular, at, 0);
#endif
  return position.w > 0.0;
}

// The end of a ray: radiance from there, W/(sr m^2), and the surface.
struct Meeting {
  vec3 light;
  bool isSurface;
  Surface surface;
};

#if MAP
// Radiance along the path from the surface at a texel of a light's view, due to this light.
vec3 sentBy(LightSample light, ivec3 texel, vec3 toViewer) {
  vec3 sent = diffuseOfTexel(texel);
#if GLOSSY
  vec4 specular = texelFetch(rsmSpecular, texel, 0);
  vec3 normal = texelFetch(rsmNormal, texel, 0).xyz, toLight;
  vec3 perpendicular = arrivingIrradiance(light, texelFetch(rsmPosition, texel, 0).xyz, toLight);
  sent += phongLobe(specular.rgb, specular.w, normal, toViewer, toLight) * perpendicular * max(dot(normal, toLight), 0.0);
#endif
  return sent;
}
#endif

Meeting meetingOf(BitHit hit) {
  vec3 toViewer = -bitDirection;
#if PLANES
  vec3 place = bitOrigin + hit.t * bitDirection;
#else
  vec3 place = bitOrigin + 0.5 * (hit.t + max(leavesVoxel(hit.voxel), hit.t)) * bitDirection;
#endif
  Meeting result = Meeting(vec3(0.0), true, Surface(place, toViewer, toViewer, toViewer, vec3(0.0), vec4(0.0)));
  vec3 voxelsNormal = toViewer;
#if ATTRIBUTES
  vec3 mean = texelFetch(voxelNormal, hit.voxel, 0).xyz;
  if (dot(mean, mean) > 0.0) voxelsNormal = dot(mean, toViewer) < 0.0 ? -normalize(mean) : normalize(mean);
#if PLANES
  vec3 planesNormal = normalOfStop(hit.voxel);
  if (planesNormal != vec3(0.0)) voxelsNormal = planesNormal;
#endif
  result.surface.normal = voxelsNormal;
  result.surface.diffuse = texelFetch(voxelAlbedo, hit.voxel, 0).rgb;
#endif
#if MAP
  vec3 point = gridLow + voxelSize * place;
  bool isLit = false;
  for (int i = firstLight; i < firstLight + lightsAtOnce; ++i) {
    int layer;
    vec2 inView;
    float depth;
    if (!placeInView(lights[i], point, layer, inView, depth)) continue;
    ivec3 texel = texelAt(inView, layer);
    if (!showsPoint(lights[i], texel, depth, point, toViewer)) continue;
    result.light += sentBy(lights[i], texel, toViewer);
    if (isLit) continue;
    isLit = true;
    result.surface.diffuse = texelFetch(rsmAlbedo, texel, 0).rgb;
#if GLOSSY
    result.surface.specular = texelFetch(rsmSpecular, texel, 0);
#endif
    vec3 normal = texelFetch(rsmNormal, texel, 0).xyz;
    if (normalOfVoxels == 0) result.surface.normal = dot(normal, toViewer) < 0.0 ? -normal : normal;
  }
#endif
  result.surface.outwards = result.surface.normal;
  return result;
}

// The surface that a ray hits, or the environment.
Meeting followed(vec3 start, vec3 direction) {
  BitHit hit = firstBit(start, direction, reach, resolution);
  if (hit.found && hit.t <= reach) return meetingOf(hit);
  Surface none = Surface(start, direction, direction, -direction, vec3(0.0), vec4(0.0));
  return Meeting(!hit.found && leavesGrid() <= reach ? environmentAlong(environment, direction, 0.0) : vec3(0.0), false, none);
}

// The throughput of a path after Russian roulette; zero: the path ends.
vec3 survived(ivec2 at, vec3 throughput, int fromSurface) {
  if (roulette == 0) return throughput;
  float chance = min(max(throughput.r, max(throughput.g, throughput.b)), 1.0);
  return unitInterval(noiseOf(at, fromSurface, 1).xy).x < chance ? throughput / chance : vec3(0.0);
}
