// Radiance of the environment in a direction bin: that of a cone of its solid angle around its centre.
#include "common/constants.glsl"
#include "common/environment.glsl"

vec3 environmentOfBin(vec3 constant, uint bin) {
  return environmentAlong(constant, directions[bin].xyz, sqrt(directions[bin].w / kPi));
}
