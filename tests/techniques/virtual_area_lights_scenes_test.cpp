// Committed scenes against the path tracer.
#include <cstdio>

#include "support/against_reference.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

Scene committed(const std::string& name) {
  return loadScene(sourceDirectory() / ("scenes/" + name + ".scene"));
}

struct Errors {
  Against diffuse, glossy;
};

Errors errorsOn(const std::string& name, const std::vector<std::string>& settings,
                const Picture& picture = {64, 64, 128}) {
  const Scene scene = committed(name);
  const LayeredImage reference = referenceOf(scene, picture);
  const FrameResult frame = pictured(scene, picture, pipeline("virtual_area_lights"), settings);
  return {lightAgainst(reference, frame.outputs.at("indirect_diffuse")),
          against(reference, frame.outputs.at("indirect_glossy"), "one_bounce_glossy", 0.0f)};
}

}  // namespace

TEST_CASE("table: errors by occlusion and its variants", "[.]") {
  for (const char* name : {"cornell", "corridor", "cornell_glossy", "spinning_box", "arcade"})
    for (const char* occlusion :
         {"occlusion=off", "combine=product", "combine=sum", "combine=nearest", "combine=mask"}) {
      const Errors errors = errorsOn(name, {occlusion});
      std::printf("%-15s %-16s diffuse %.3f ratio %.3f  glossy %.3f ratio %.3f\n", name, occlusion,
                  errors.diffuse.rmse, errors.diffuse.ratio, errors.glossy.rmse, errors.glossy.ratio);
      std::fflush(stdout);
      CHECK(errors.diffuse.rmse < 9.0);
    }
}
