// Joint bilateral filters (Kopf, Cohen, Lischinski & Uyttendaele 2007): samples `every` pixels apart are blended with weights that decrease
// with the distance in the image and with the dissimilarity of the surfaces.
#ifndef LUMIVOX_JOINT_BILATERAL
#define LUMIVOX_JOINT_BILATERAL

// The first of the four samples around a pixel along each axis.
ivec2 firstOfFour(ivec2 pixel, ivec2 every) { return ivec2(floor((vec2(pixel) + 0.5) / vec2(every) - 0.5)) - 1; }

// Falls linearly from 1, towards 0 at `reach`, but not below `least`.
float tent(float away, float reach, float least) { return max(1.0 - away / reach, least); }

// A weighted mean with the weights exp(-unlike) times a given weight. `unlike` counts relative to its least value so far: if no sample is
// similar, the most similar sample has nearly all of the weight.
struct Blend {
  vec3 sum;
  float weights, least;
};
const Blend kNoBlend = Blend(vec3(0.0), 0.0, 1e30);

void add(inout Blend blend, vec3 value, float weight, float unlike) {
  if (!(weight > 0.0)) return;
  if (unlike < blend.least) {
    float kept = blend.weights > 0.0 ? exp(unlike - blend.least) : 0.0;
    blend.sum *= kept;
    blend.weights *= kept;
    blend.least = unlike;
  }
  weight *= exp(blend.least - unlike);
  blend.sum += weight * value;
  blend.weights += weight;
}

// Dissimilarity of another surface to the surface at a position: its squared distance from the plane there, in units of `tolerance`, minus
// `power` times the logarithm of the cosine between the normals.
float unlikeSurface(vec3 otherPosition, vec3 otherNormal, vec3 position, vec3 normal, float tolerance, float power) {
  const float kLeastCosine = 1e-4;  // for normals that face away from each other
  float off = dot(otherPosition - position, normal) / tolerance;
  return off * off - power * log(clamp(dot(normal, otherNormal), kLeastCosine, 1.0));
}

#endif
