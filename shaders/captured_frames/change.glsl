// The change of irradiance on real surfaces by virtual content.
#ifndef LUMIVOX_CAPTURED_CHANGE
#define LUMIVOX_CAPTURED_CHANGE

// Irradiance with virtual content over that without it. Where none was known, nothing changes.
vec3 changeOf(vec3 before, vec3 after) {
  const float kMost = 8.0;
  vec3 change = vec3(1.0);
  for (int c = 0; c < 3; ++c)
    if (before[c] > 0.0) change[c] = min(after[c] / before[c], kMost);
  return change;
}

#endif
