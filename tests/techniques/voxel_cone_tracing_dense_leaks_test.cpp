// What lets light through walls: their thickness, by the store; voxels that the edge of a shadow lies in.
#include <cmath>

#include "support/cones.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kResolution = 32;  // voxels along both rooms, which are 2 m long

/// Mean indirect light on the walls of the dark room, of that in the lit one; the wall is so many voxels
/// thick, 0: one sheet.
double leaked(const Pipeline& text, double thickness) {
  const float half = static_cast<float>(0.5 * thickness * 2.0 / kResolution);
  const auto lightSeen = [&](float side) {
    SceneBuilder builder;
    const int grey = builder.lambert(0.7f);
    builder.box({-1, 0, 0}, {1, 1, 1}, grey, true);
    if (thickness > 0)
      builder.box({0.01f - half, 0, 0}, {0.01f + half, 1, 1}, grey, false);
    else
      builder.quad({0.01f, 0, 0}, {0, 1, 0}, {0, 0, 1}, grey);
    builder.light(LightKind::point, glm::vec3(1.0f), {-0.5, 0.6, 0.45});
    builder.look({0.9 * side, 0.8, 0.9}, {0.2 * side, 0.2, 0.15}, {0, 1, 0}, 1.0, 32, 32);
    RenderOptions options;
    options.parameters = text.settings({"resolution=" + std::to_string(kResolution)});
    const ImageBuffer image = renderOnce(builder.scene, text, options).outputs.at("indirect_diffuse");
    double sum = 0.0;
    for (const float value : image.values()) sum += value;
    return sum;
  };
  return lightSeen(1.0f) / lightSeen(-1.0f);
}

}  // namespace

TEST_CASE("of the light of a room less comes through a thin wall by six directional grids than by one") {
  struct Row {
    double thickness;                              // voxels
    double isotropic, lobes, coarse, directional;  // as the card says
  };
  for (const Row& row : {Row{0, 0.185, 0.0637, 0.174, 0.0184}, Row{0.5, 0.0301, 0.0073, 0.0085, 0.00123},
                         Row{1, 0.0269, 0.0063, 0.0048, 0.00102}, Row{2, 0.0209, 0.0052, 0.0081, 0.0005},
                         Row{4, 0.0221, 0.0043, 0.0109, 0.00023}}) {
    const double isotropic = leaked(pipeline("voxel_cone_tracing"), row.thickness),
                 lobes = leaked(pipeline("voxel_cone_tracing_lobes"), row.thickness),
                 coarse = leaked(pipeline("voxel_cone_tracing_coarse_directional"), row.thickness),
                 directional = leaked(pipeline("voxel_cone_tracing_directional"), row.thickness),
                 octree = leaked(pipeline("voxel_cone_tracing_octree"), row.thickness),
                 sides = leaked(pipeline("voxel_cone_tracing_octree_directional"), row.thickness);
    INFO("a wall of " << row.thickness << " voxels: " << isotropic << ", " << lobes << ", " << coarse << ", "
                      << directional << ", octree " << octree << ", of six faces " << sides);
    // A tenth for other drivers.
    CHECK(isotropic == Approx(row.isotropic).epsilon(0.1));
    CHECK(lobes == Approx(row.lobes).epsilon(0.1));
    CHECK(coarse == Approx(row.coarse).epsilon(0.1));
    CHECK(directional == Approx(row.directional).epsilon(0.1));
    CHECK(octree == Approx(isotropic).epsilon(0.1));
    CHECK(sides == Approx(directional).epsilon(0.1));
  }
}

TEST_CASE("what keeps light from leaking through walls is worth what the card says, taken away one by one") {
  struct Row {
    const char *pass, *line;
    double sheet, half, one;  // leaked, by the wall's thickness in voxels
  };
  for (const Row& row : {Row{"inject_directional", "back_weight 1", 0.0184, 0.00115, 0.00093},
                         Row{"inject_directional", "back_weight 0", 0.0129, 0.00123, 0.00102},
                         Row{"inject_directional", "opaque_along all", 0.0097, 0.00077, 0.00070},
                         Row{"inject_directional", "light_samples 16", 0.0199, 0.00124, 0.00099},
                         Row{"gather", "offset 0", 0.291, 0.00083, 0.00060},
                         Row{"gather", "start 0", 0.0178, 0.00120, 0.00102},
                         Row{"gather", "clearance 1000", 0.0393, 0.00200, 0.00174},
                         Row{"gather", "refinement 1", 0.0281, 0.00156, 0.00139},
                         Row{"gather", "reading interpolated", 0.0724, 0.0332, 0.0288}}) {
    const Pipeline text = cones::pipelineWith("voxel_cone_tracing_directional",
                                              {{std::string("voxel_cone_tracing.") + row.pass, row.line}});
    CAPTURE(row.line);
    CHECK(leaked(text, 0.0) == Approx(row.sheet).epsilon(0.1));
    CHECK(leaked(text, 0.5) == Approx(row.half).epsilon(0.1));
    CHECK(leaked(text, 1.0) == Approx(row.one).epsilon(0.1));
  }
}

TEST_CASE("a voxel that the edge of a shadow lies in is lit as far as it lies outside, by several samples") {
  // The sun stands over a floor whose part below -0.37 along x lies in the shadow of a sheet.
  constexpr float kEdge = -0.37f;
  SceneBuilder builder;
  const int grey = builder.lambert(0.7f);
  builder.quad({-1, -0.5f, -1}, {2, 0, 0}, {0, 0, 2}, grey);
  builder.quad({-1, 0.5f, -1}, {kEdge + 1, 0, 0}, {0, 0, 2}, grey);
  builder.light(LightKind::directional, glm::vec3(2.0f), {}, {0, -1, 0});
  builder.look({0, 2, 2}, {0, 0, 0}, {0, 1, 0}, 0.7, 8, 8);
  const double full = 2.0 * 0.7 / M_PI;
  for (const int samples : {1, 256}) {
    cones::InjectSettings settings;
    settings.lightSamples = samples;
    const RadianceGrid grid = cones::injectedGrid(builder.scene, 9, settings);
    const std::vector<float> texels = grid.radiance->downloadFloats(0);
    const glm::ivec3 size = grid.grid.resolution;
    const float voxel = grid.grid.voxelSize;
    const int y = static_cast<int>((-0.5f - grid.grid.low.y) / voxel), z = 4;
    int partly = 0;
    for (int x = 2; x < 7; ++x) {
      const float low = grid.grid.low.x + static_cast<float>(x) * voxel;
      const double outside = std::clamp((low + voxel - kEdge) / voxel, 0.0f, 1.0f);
      const double share = texels[static_cast<std::size_t>(4 * ((z * size.y + y) * size.x + x))] / full;
      CAPTURE(samples, x, outside);
      if (samples > 1)
        CHECK(share == Approx(outside).margin(0.04));  // of a texel of the shadow map, 0.01 of a voxel
      else
        CHECK(std::min(std::abs(share), std::abs(share - 1.0)) < 0.01);
      partly += outside > 0.2 && outside < 0.8;
    }
    CHECK(partly == 1);
  }
}
