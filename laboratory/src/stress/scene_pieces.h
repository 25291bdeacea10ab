// Scenes for cases, and changes to scenes with a known effect on the image.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "lumivox/scene/builder.h"
#include "lumivox/scene/scene.h"

namespace lumivox::stress {

/// p -> scale * rotation * p + translation.
struct Similarity {
  double scale = 1.0;
  glm::dmat3 rotation{1.0};
  glm::dvec3 translation{0.0};
};
/// Rotation about Y, radians.
glm::dmat3 turnAboutY(double angle);

/// A scene with everything in it moved, so that its image stays the same: objects by their placements,
/// motions, lights, cameras and media. Radiances and irradiances stay; intensities scale with the square,
/// extinctions with the inverse of the scale. Error for a medium in a box under any rotation but quarter
/// turns, for a volume under any rotation, and for particles that no longer rise along Y.
Scene moved(const Scene& scene, const Similarity& by);

/// Multiplies all lights, emission of surfaces and the environment by a factor.
Scene brighter(const Scene& scene, float factor);

/// Duplicates every object without emission in place.
Scene doubled(const Scene& scene);

/// Corners, three per triangle, of a parallelogram in `columns` x `rows` cells of two triangles; the front
/// side is that of cross(edge1, edge2).
std::vector<glm::vec3> gridOfTriangles(const glm::vec3& corner, const glm::vec3& edge1,
                                       const glm::vec3& edge2, int columns, int rows);

/// A closed box of size 1 seen from inside, white walls of one albedo, with a point light of 1 W/sr near its
/// middle; the camera looks at a corner, so that floor and two walls fill the image.
SceneBuilder closedRoom(float albedo);

/// A closed, axis-aligned cubic room.
struct WallRoom {
  glm::dvec3 low{0.0};
  double size = 1.0;  ///< m
};
/// closedRoom() of albedo 0.7 with light and camera at such a place. Two specks outside it give the scene the
/// bounds of a cube of 1.5 m around the origin, wherever the room is.
Scene roomInBounds(const WallRoom& room);

/// A closed tunnel along z, 1 m wide and high and 15 m long, with three lights; the camera looks along it
/// from one end.
Scene tunnel();

/// Two closed rooms of 1 m, adjacent along x, with a wall between them, `wall` m thick (0: one sheet). A
/// point light shines in the middle of the room at lower x. Cameras "lit" and "dark" look at the same corner
/// of each, mirrored in the wall.
Scene twoRooms(float wall);

/// A floor of 2 m with a box on it under the open sky, seen from above at a slant; no light.
SceneBuilder openFloor();

/// All light in the view comes from one lit square of 4 mm in mid-air, in `cells` x `cells` cells of two
/// triangles, in a closed room of 1 m. It lies within one voxel of grids of 16, 32 and 64 around the scene.
Scene glowingSpeck(int cells);

}  // namespace lumivox::stress
