// Which side of a surface is its front is a matter of how it was drawn: light does not ask.
#include <algorithm>
#include <cmath>

#include "support/passes.h"

using namespace lumivox;
using namespace lumivox::test;

// Elements that are texels of the atlas lie elsewhere on a chart that is turned over; vertices stay.
TEST_CASE("a room whose walls and boxes are drawn inside out has the same light") {
  Scene room = litRoom(48, 48);
  Light point;
  point.name = "point";
  point.kind = LightKind::point;
  point.power = glm::vec3(0.3f);
  point.position = {0.3, 0.8, 0.8};
  room.lights.push_back(point);
  const Scene turned = turnedOver(room);
  for (const char* name : {"implicit_visibility", "implicit_visibility_lights"})
    for (const bool published : {false, true}) {
      const Pipeline text = pipeline(name);
      const std::vector<std::string> settings{"elements=1024", "bounces=2",
                                              published ? "as_published=on" : "as_published=off"};
      const FrameResult drawn = rendered(room, text, settings), other = rendered(turned, text, settings);
      for (const auto& [output, image] : drawn.outputs) {
        const ImageBuffer& otherImage = other.outputs.at(output);
        const double mean = meanOf(image);
        CAPTURE(name, published, output, mean, meanOf(otherImage), rmsBetween(image, otherImage));
        REQUIRE(mean > 0.0);
        CHECK(meanOf(otherImage) == Approx(mean).epsilon(published ? 1e-4 : 0.02));
        CHECK(rmsBetween(image, otherImage) < (published ? 1e-3 : 0.17) * mean);
      }
    }
}
