// Images of the six faces of voxels, of any float format, named by the outward normals of the faces.
#ifndef LUMIVOX_FACE_IMAGES
#define LUMIVOX_FACE_IMAGES
layout(binding = 0) uniform writeonly image3D positiveXImage;
layout(binding = 1) uniform writeonly image3D negativeXImage;
layout(binding = 2) uniform writeonly image3D positiveYImage;
layout(binding = 3) uniform writeonly image3D negativeYImage;
layout(binding = 4) uniform writeonly image3D positiveZImage;
layout(binding = 5) uniform writeonly image3D negativeZImage;

void storeFaces(ivec3 texel, vec4 faces[6]) {
  imageStore(positiveXImage, texel, faces[0]);
  imageStore(negativeXImage, texel, faces[1]);
  imageStore(positiveYImage, texel, faces[2]);
  imageStore(negativeYImage, texel, faces[3]);
  imageStore(positiveZImage, texel, faces[4]);
  imageStore(negativeZImage, texel, faces[5]);
}

#endif
