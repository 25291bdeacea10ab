// Further bounces by light that cones gather for every fragment.
#include <cmath>
#include <cstdio>

#include "support/cones.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::cones;

TEST_CASE("scratch bounces") {
  for (const int resolution : {16, 32})
    for (const float albedo : {0.5f, 0.9f}) {
      SceneBuilder builder;
      builder.box({-1, -1, -1}, {1, 1, 1}, builder.lambert(albedo), true);
      for (const char* pass : {"inject", "inject_directional"}) {
      InjectSettings settings;
      settings.lights = false;
      settings.ambient = kPi;
      for (int bounces : {2, 64}) {
      if (bounces==64 && resolution==64) bounces = 24;
      settings.bounces = bounces;
      double sum = 0, n = 0, lo = 1e9, hi = 0;
      const auto add = [&](const gpu::TextureRef& t) {
        const std::vector<float> texels = t->downloadFloats(0);
        for (std::size_t i = 0; i < texels.size(); i += 4)
          if (texels[i + 3] > 0.5f && texels[i] > 0.0f) { double v = texels[i]/texels[i+3]; sum += v; n += 1; lo = std::min(lo, v); hi = std::max(hi,v);}
      };
      if (std::string(pass) == "inject") add(injectedAs<RadianceGrid>(pass, builder.scene, resolution, settings).radiance);
      else { const auto g = injectedAs<DirectionalRadianceGrid>(pass, builder.scene, resolution, settings); 
        // inner faces only
        for (int f = 0; f < 6; ++f) { const std::vector<float> texels = g.faces[f]->downloadFloats(0); const glm::ivec3 s = g.grid.resolution;
          for (int z = 0; z < s.z; ++z) for (int y = 0; y < s.y; ++y) for (int x = 0; x < s.x; ++x) { const size_t i = 4*size_t((z*s.y+y)*s.x+x); if (texels[i+3] < 0.5f) continue; glm::ivec3 at(x,y,z); glm::vec3 p = g.grid.low + (glm::vec3(at)+0.5f)*g.grid.voxelSize; int axis = f/2; bool inner = (f%2==0) ? p[axis] < 0 : p[axis] > 0; if (!inner) continue; double v = texels[i]; sum += v; n+=1; lo=std::min(lo,v); hi=std::max(hi,v);} } }
      double expected = 0; for (int k = 0; k < bounces; ++k) expected += std::pow(albedo, k + 1);
      printf("scratch %s res %d albedo %.1f bounces %d: mean %.4f of %.4f = %.4f  (%.3f..%.3f) n %.0f\n", pass, resolution, albedo, bounces, sum / n, expected, sum / n / expected, lo/expected, hi/expected, n);
      }
      }
    }
}
