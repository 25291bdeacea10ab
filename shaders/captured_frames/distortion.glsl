// OpenCV's model of lens distortion: the ray (x, y, 1) arrives where the undistorted camera would see the result.
#ifndef LUMIVOX_DISTORTION
#define LUMIVOX_DISTORTION

// radial: k1, k2, k3; tangential: p1, p2.
vec2 distortedRay(vec2 ray, vec4 radial, vec2 tangential) {
  float r2 = dot(ray, ray), xy = ray.x * ray.y;
  float scale = 1.0 + r2 * (radial.x + r2 * (radial.y + r2 * radial.z));
  return ray * scale + vec2(2.0 * tangential.x * xy + tangential.y * (r2 + 2.0 * ray.x * ray.x),
                            tangential.x * (r2 + 2.0 * ray.y * ray.y) + 2.0 * tangential.y * xy);
}

#endif
