// An interrupted command leaves the earlier result readable and no half file.
#include "lumivox/base/image.h"
#include "tools/cli_support.h"
#include "tools/started.h"

using namespace lumivox;
using namespace lumivox::test;

TEST_CASE(
    "a reference that is killed or interrupted leaves the earlier image readable and nothing "
    "half-written") {
  using namespace std::chrono_literals;
  const Workplace place;
  const std::string output = place.file("reference.exr");
  LayeredImage earlier;
  earlier.layers["full"] = ImageBuffer(4, 4, 3, 0.25f);
  writeExr(output, earlier);
  const std::size_t files = place.fileCount();

  for (const int signal : {SIGINT, SIGKILL}) {
    INFO("signal " << signal);
    // Many samples, so that it cannot be done before the signal comes.
    Started command({"reference", place.scene(), "--resolution", "256x256", "--spp", "1000000", "--no-cache",
                     "-o", output});
    command.signalAfter(700ms, signal);
    const int status = command.wait();
    CHECK_FALSE((WIFEXITED(status) && WEXITSTATUS(status) == 0));
    CHECK(readExr(output).layers.at("full").at(1, 2, 0) == 0.25f);
    CHECK(place.fileCount() == files);
  }
}

TEST_CASE("an animation that is killed leaves only whole images") {
  using namespace std::chrono_literals;
  const Workplace place;
  Started command({"render", place.scene(), committedPipeline("direct_lighting"), "--resolution", "16x16",
                   "--frames", "0..99999", "-o", place.file("frame.exr")});
  // Not before the first image is there; a minute is far more than the device needs to start.
  for (int i = 0; i < 600 && !place.has("frame_0000.exr"); ++i) std::this_thread::sleep_for(100ms);
  REQUIRE(place.has("frame_0000.exr"));
  command.signalAfter(150ms, SIGKILL);
  command.wait();
  std::size_t images = 0;
  for (const auto& entry : std::filesystem::directory_iterator(place.path())) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() != ".exr") continue;
    INFO(name);
    CHECK(name[0] != '.');
    CHECK(readExr(entry.path()).layers.at("direct").width() == 16);
    ++images;
  }
  CHECK(images >= 1);
}
