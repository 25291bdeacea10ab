// Finds in advance the sparse points that each vertex refers to (Lensing and Broll 2013, Sec. 3.2 step 3).
#include <algorithm>
#include <vector>

#include "../passes.h"
#include "vertex_neighbours.h"
#include "vertex_points.h"

namespace lumivox::virtual_area_lights {
namespace {

class VerticesPass : public Pass {
  In<SurfacePoints> points{this, "points", "where light is gathered"};
  Out<VertexPoints> result{this, "vertices", Contributes::nothing, Needs::triangles,
                           "the nearest points of each vertex of the meshes, found once, at rest"};

  Reads readsFrom() const override { return Reads::geometry | Reads::materials; }
  bool worksOnHost() const override { return true; }

  void run(PassContext& frame) override {
    result = frame.kept("neighbours of vertices", points->set, [&] {
      const Scene& scene = frame.sceneDescription();
      const VertexNeighbours found = neighboursOfVertices(scene, *points->set, points->neighbours);
      std::vector<std::uint32_t> objects(scene.positions.size());
      for (std::size_t o = 0; o < scene.objects.size(); ++o)
        std::fill_n(objects.begin() + scene.objects[o].firstVertex, scene.objects[o].vertexCount,
                    static_cast<std::uint32_t>(o));
      return VertexPoints{.any = frame.uploaded(found.any, "points of vertices"),
                          .glossy = frame.uploaded(found.glossy, "glossy points of vertices"),
                          .objects = frame.uploaded(objects, "objects of vertices"),
                          .sides = found.sides,
                          .neighbours = points->neighbours,
                          .set = points->set};
    });
  }
};

}  // namespace

void addVertices(TechniqueRegistry& registry) {
  registry.add<VerticesPass>(
      "vertices", "The points that vertices refer to, found once (Lensing & Broll 2013, Sec. 3.2 step 3)");
}

}  // namespace lumivox::virtual_area_lights
