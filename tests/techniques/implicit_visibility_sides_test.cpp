// Which side of a surface is its front is a matter of how it was drawn: light does not ask.
#include <algorithm>
#include <cmath>

#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

double meanOf(const ImageBuffer& image) {
  double sum = 0.0;
  for (const float value : image.values()) sum += static_cast<double>(value);
  return sum / static_cast<double>(image.values().size());
}

double rmsDifference(const ImageBuffer& a, const ImageBuffer& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.values().size(); ++i)
    sum += std::pow(static_cast<double>(a.values()[i]) - static_cast<double>(b.values()[i]), 2.0);
  return std::sqrt(sum / static_cast<double>(a.values().size()));
}

}  // namespace

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
      RenderOptions options;
      options.parameters =
          text.settings({"elements=1024", "bounces=2", published ? "as_published=on" : "as_published=off"});
      const FrameResult drawn = renderOnce(room, text, options), other = renderOnce(turned, text, options);
      for (const auto& [output, image] : drawn.outputs) {
        const ImageBuffer& otherImage = other.outputs.at(output);
        const double mean = meanOf(image);
        CAPTURE(name, published, output, mean, meanOf(otherImage), rmsDifference(image, otherImage));
        REQUIRE(mean > 0.0);
        CHECK(meanOf(otherImage) == Approx(mean).epsilon(published ? 1e-4 : 0.02));
        CHECK(rmsDifference(image, otherImage) < (published ? 1e-3 : 0.17) * mean);
      }
    }
}
