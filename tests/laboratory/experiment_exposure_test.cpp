// The exposure and tone curve that scenes are shown at by themselves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/experiment/report.h"
#include "lumivox/reference/emission.h"
#include "lumivox/scene/text.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// The share of the pixels that show nothing that shines whose colour reaches white in a channel.
double clippedShare(const ImageBuffer& image, const std::vector<unsigned char>& emits,
                    const Display& display) {
  const std::vector<unsigned char> bytes = displayBytes(image, display);
  std::size_t counted = 0, clipped = 0;
  for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel) {
    if (!emits.empty() && emits[pixel] != 0) continue;
    counted += 1;
    const unsigned char* colour = bytes.data() + 3 * pixel;
    clipped += *std::max_element(colour, colour + 3) == 255 ? 1 : 0;
  }
  return counted == 0 ? 0.0 : static_cast<double>(clipped) / static_cast<double>(counted);
}

}  // namespace

TEST_CASE("of every committed scene at most one pixel in a hundred that does not emit is shown as white") {
  std::string absent;
  int looked = 0, burnt = 0;  // scenes; those that clip more than that without the curve
  for (const auto& entry : std::filesystem::directory_iterator(sourceDirectory() / "scenes")) {
    if (entry.path().extension() != ".scene") continue;
    CAPTURE(entry.path().filename().string());
    Scene scene;
    try {
      scene = loadScene(entry.path());
    } catch (const AbsentError&) {
      absent += " " + entry.path().stem().string();
      continue;
    }
    ReferenceOptions view;
    view.samplesPerPixel = 64;
    view.width = view.height = 48;
    view.progress = false;
    const ImageBuffer image = cachedReference(scene, view).layers.at("full");
    const auto emits =
        emittingPixels(scene, snapshotOf(scene, view.time, view.camera, view.width, view.height));
    const double exposure = viewExposure(scene, view);
    const double share = clippedShare(image, emits, {exposure, kShownTone});
    CHECK(share <= 0.01);
    looked += 1;
    burnt += clippedShare(image, emits, {exposure, Tone::srgb}) > 0.01 ? 1 : 0;
  }
  CHECK(looked >= 15);
  CHECK(3 * burnt > looked);
  if (!absent.empty()) WARN("not looked at, for want of their models:" << absent);
}
