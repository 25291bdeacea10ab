// Sums over all paths of a pixel, of this and the earlier frames. Layers of `sums`: arriving light, and light that the Phong lobe reflects,
// each followed by the compensation of its rounding error, so that the error does not grow with the number of paths (Kahan 1965).
const int kArriving = 0, kReflected = 2;

layout(binding = 0, rgba32f) uniform image2DArray sums;

void addTo(int sum, ivec2 at, vec3 value) {
  ivec3 whole = ivec3(at, sum), lost = ivec3(at, sum + 1);
  precise vec3 before = imageLoad(sums, whole).rgb;
  precise vec3 added = value - imageLoad(sums, lost).rgb;
  precise vec3 after = before + added;
  precise vec3 rest = (after - before) - added;
  imageStore(sums, whole, vec4(after, 1.0));
  imageStore(sums, lost, vec4(rest, 0.0));
}
