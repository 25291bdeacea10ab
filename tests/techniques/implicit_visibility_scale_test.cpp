// That no threshold is a length: what is smaller by a power of two is the same to the bit.
#include <fmt/format.h>

#include "support/against_reference.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE("light between elements of a scene 1024 times as small is the same to the bit") {
  const TemporaryDirectory folder;
  const auto light = [&](double scale) {
    folder.write("scaled.scene",
                 fmt::format(R"(scene "Scaled" {{
  camera main {{ eye {} {} {}  target {} {} 0  fov 39.3 deg  resolution 48 48 }}
  mesh room {{ file "{}"  scale {} }}
  light lamp area {{ mesh room/ceiling_lamp  radiance 17 12 4 }}
}}
)",
                             0.25 * scale, 0.25 * scale, -0.75 * scale, 0.25 * scale, 0.25 * scale,
                             (sourceDirectory() / "scenes/models/cornell.obj").string(), scale));
    const Scene scene = loadScene(folder.path() / "scaled.scene");
    return pictured(scene, {48, 48}, pipeline("implicit_visibility_lights"), {"elements=1024"}).outputs;
  };
  const auto whole = light(1.0), small = light(1.0 / 1024.0);
  for (const char* output : {"direct", "indirect_diffuse"}) {
    INFO(output);
    CHECK(whole.at(output).values() == small.at(output).values());
  }
}
