// Criteria by which voxels group their surfaces (thesis 004 Sec. 4.3.1): normals by the nearest face of a tetrahedron, albedos by contrast.
#ifndef LUMIVOX_TETRAHEDRON
#define LUMIVOX_TETRAHEDRON

// Listing 4.28: directions of the faces of a regular tetrahedron.
const vec3 kTetrahedron[4] = vec3[4](vec3(0.0, -0.57735026, 0.81649661), vec3(0.0, -0.57735026, -0.81649661),
                                     vec3(-0.81649661, 0.57735026, 0.0), vec3(0.81649661, 0.57735026, 0.0));

int groupOf(vec3 normal) {
  int best = 0;
  for (int i = 1; i < 4; ++i)
    if (dot(normal, kTetrahedron[i]) > dot(normal, kTetrahedron[best])) best = i;
  return best;
}

// Listing 4.27: contrast of a colour, 0 to 0.59, from its display values. The exponent is not printed; here 2.2.
float contrastOf(vec3 albedo) {
  vec3 displayed = pow(clamp(albedo, 0.0, 1.0), vec3(1.0 / 2.2));
  return length(displayed.rrg - displayed.gbb) / (sqrt(2.0) + displayed.r + displayed.g + displayed.b);
}
#endif
