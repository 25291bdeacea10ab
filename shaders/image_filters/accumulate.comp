#version 450
// Blends a frame's light with its history, and estimates the variance of the result (Schied et al. 2017, Sec. 4.1 and 4.2).
#include "common/joint_bilateral.glsl"
#include "luminance.glsl"

layout(constant_id = 0) const int exponential = 0;     // 1: a fixed weight once the history is long enough; 0: the mean of the frames
layout(constant_id = 1) const int varianceOfSample = 0;  // 1: of one frame; 0: of the accumulated light

layout(local_size_x = 8, local_size_y = 8) in;

layout(std140, binding = 0) uniform Accumulation {
  vec3 eye;
  float pixelAngle;  // width of a pixel at a distance of 1
  float alpha;       // least weight of a frame, `exponential`
  float frames;      // most frames in a mean
  float change;      // standard errors by which the local mean of the history may differ; 0: any
  int hasPast;
};
layout(binding = 0) uniform sampler2D gPosition;
layout(binding = 2) uniform sampler2D gGeometricNormal;
layout(binding = 4) uniform sampler2D lightNow;
layout(binding = 5) uniform sampler2D pastLight;    // rgb, frames in it; 0: none
layout(binding = 6) uniform sampler2D pastMoments;  // mean of the luminance and of its square; the sum of the frames' squared weights
layout(binding = 0, rgba32f) uniform writeonly image2D lightHistory;
layout(binding = 1, rgba32f) uniform writeonly image2D momentsHistory;
layout(binding = 2, rgba32f) uniform writeonly image2D accumulatedImage;
layout(binding = 3, rgba32f) uniform writeonly image2D varianceImage;

const int kRadius = 3;           // 7 x 7 pixels
const float kFewFrames = 4.0;    // below which variance comes from the window
const float kAlike = 2.0;        // largest dissimilarity of a surface in the window
const float kRounding = 1e-4;    // share of the mean that is no change

bool isFinite(vec3 light) { return !(any(isnan(light)) || any(isinf(light))); }

struct Window {
  float count, mean, variance;  // of this frame's luminance; variance without bias
  float pastCount, past;
};

Window windowAt(ivec2 at, vec3 position, vec3 normal) {
  Window window = Window(0.0, 0.0, 0.0, 0.0, 0.0);
  float width = pixelAngle * distance(position, eye), squares = 0.0;
  ivec2 end = textureSize(gPosition, 0) - 1;
  for (int y = max(at.y - kRadius, 0); y <= min(at.y + kRadius, end.y); ++y)
    for (int x = max(at.x - kRadius, 0); x <= min(at.x + kRadius, end.x); ++x) {
      ivec2 texel = ivec2(x, y);
      vec4 other = texelFetch(gPosition, texel, 0);
      vec3 light = texelFetch(lightNow, texel, 0).rgb;
      if (!(other.w > 0.0) || !isFinite(light)) continue;
      if (unlikeSurface(other.xyz, texelFetch(gGeometricNormal, texel, 0).xyz, position, normal, width, 16.0) > kAlike) continue;
      float value = luminanceOf(light), off = value - window.mean;
      window.count += 1.0;  // Welford 1962: no difference of large squares
      window.mean += off / window.count;
      squares += off * (value - window.mean);
      vec4 past = hasPast != 0 ? texelFetch(pastLight, texel, 0) : vec4(0.0);
      if (past.w > 0.0) {
        window.pastCount += 1.0;
        window.past += (luminanceOf(past.rgb) - window.past) / window.pastCount;
      }
    }
  window.variance = window.count > 1.0 ? max(squares, 0.0) / (window.count - 1.0) : 0.0;
  return window;
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(lightHistory)))) return;
  vec4 position = texelFetch(gPosition, at, 0), light = vec4(0.0), moments = vec4(0.0);
  float variance = 0.0;
  if (position.w > 0.0) {
    vec3 now = texelFetch(lightNow, at, 0).rgb;
    light = hasPast != 0 ? texelFetch(pastLight, at, 0) : vec4(0.0);
    moments = hasPast != 0 ? texelFetch(pastMoments, at, 0) : vec4(0.0);
    bool looks = change > 0.0 || light.w + 1.0 < kFewFrames;
    Window window = Window(0.0, 0.0, 0.0, 0.0, 0.0);
    if (looks) window = windowAt(at, position.xyz, texelFetch(gGeometricNormal, at, 0).xyz);
    if (change > 0.0 && light.w > 0.0 && window.count > 1.0 && window.pastCount > 1.0) {
      // The history may be wrong by as much as its local mean differs from this frame's. It is shortened so that what stays of the
      // difference is within the allowed one: (1 - a) d = t with the frame's weight a = 1 / (n + 1).
      float off = abs(window.mean - window.past);
      float allowed = change * sqrt(window.variance * (1.0 + moments.z) / window.count) + kRounding * window.past;
      if (off > allowed) light.w = min(light.w, allowed / (off - allowed));
    }
    if (isFinite(now)) {
      float count = light.w + 1.0, weight = 1.0 / count;
      if (exponential != 0) weight = max(weight, alpha);
      float value = luminanceOf(now);
      light.rgb = light.w > 0.0 ? mix(light.rgb, now, weight) : now;
      moments.xy = light.w > 0.0 ? mix(moments.xy, vec2(value, value * value), weight) : vec2(value, value * value);
      moments.z = (1.0 - weight) * (1.0 - weight) * moments.z + weight * weight;
      light.w = min(count, frames);
    }
    // E[m2 - m1^2] = v (1 - e) for weights whose squares sum to e.
    float ofFrame = light.w < kFewFrames ? window.variance : max(moments.y - moments.x * moments.x, 0.0);
    if (varianceOfSample == 0 && !(light.w < kFewFrames)) ofFrame /= max(1.0 - moments.z, 0.5);
    variance = varianceOfSample != 0 ? ofFrame : ofFrame * moments.z;
  }
  imageStore(lightHistory, at, light);
  imageStore(momentsHistory, at, moments);
  imageStore(accumulatedImage, at, vec4(light.rgb, position.w > 0.0 ? 1.0 : 0.0));
  imageStore(varianceImage, at, vec4(vec3(variance), 1.0));
}
