// Where textures hold the values of a point.
#ifndef LUMIVOX_POINT_TEXEL
#define LUMIVOX_POINT_TEXEL
const uint kPointsInRow = 1024u;  // SurfacePoints::kWidth

ivec2 pointTexel(uint point) { return ivec2(point % kPointsInRow, point / kPointsInRow); }
#endif
