// Truths are kept by the content of everything that they depend on.
#include <cstdlib>
#include <fstream>

#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/reference/path_tracer.h"
#include "support/scene_builder.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// The cache in a directory of its own.
struct OwnCache {
  OwnCache() { setenv("LUMIVOX_CACHE", directory.path().c_str(), 1); }
  ~OwnCache() { unsetenv("LUMIVOX_CACHE"); }
  std::vector<std::filesystem::path> entries() const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(directory.path()))
      files.push_back(entry.path());
    return files;
  }
  TemporaryDirectory directory;
};

ReferenceOptions cached() {
  ReferenceOptions options = quietly(4, 2);
  options.useCache = true;
  return options;
}

bool sameBits(const LayeredPicture& a, const LayeredPicture& b) {
  if (a.layers.size() != b.layers.size()) return false;
  for (const auto& [name, layer] : a.layers) {
    const auto other = b.layers.find(name);
    if (other == b.layers.end() || !layer.sameShape(other->second) ||
        layer.values() != other->second.values())
      return false;
  }
  return true;
}

}  // namespace

TEST_CASE("a kept truth has the bits and the provenance of the rendered one") {
  const OwnCache cache;
  const Scene scene = litRoom(12, 10);
  const LayeredPicture rendered = renderReference(scene, cached());
  const LayeredPicture first = cachedReference(scene, cached());
  REQUIRE(cache.entries().size() == 1);
  const auto written = std::filesystem::last_write_time(cache.entries()[0]);
  const LayeredPicture second = cachedReference(scene, cached());
  CHECK(std::filesystem::last_write_time(cache.entries()[0]) == written);
  CHECK(sameBits(rendered, first));
  CHECK(sameBits(rendered, second));
  for (const char* name :
       {"scene", "hash", "samples", "bounces", "seed", "time", "camera", "tracer_version"}) {
    CAPTURE(name);
    REQUIRE(second.attributes.count(name) == 1);
    CHECK(second.attributes.at(name) == rendered.attributes.at(name));
  }
}

TEST_CASE("the cache tells apart everything that changes the picture, and nothing else") {
  const OwnCache cache;
  Scene scene = litRoom(6, 6);
  std::size_t expected = 0;
  const auto another = [&](const char* what, const ReferenceOptions& options) {
    CAPTURE(what);
    cachedReference(scene, options);
    CHECK(cache.entries().size() == ++expected);
  };
  const auto same = [&](const char* what, const ReferenceOptions& options) {
    CAPTURE(what);
    cachedReference(scene, options);
    CHECK(cache.entries().size() == expected);
  };
  ReferenceOptions options = cached();
  another("first", options);
  options.threads = 1;
  same("threads", options);
  options.width = 6;
  same("the camera's own width, stated", options);
  options.width = 7;
  another("width", options);
  options = cached();
  options.seed = 9;
  another("seed", options);
  options = cached();
  options.samplesPerPixel = 5;
  another("samples", options);
  options = cached();
  options.bounces = 3;
  another("bounces", options);
  options = cached();
  options.occlusionDistance = 0.2;
  another("occlusion", options);
  scene.materials[0].diffuse.x = 0.5f;
  another("a material", cached());
  scene.positions[0].x += 0.01f;
  another("a vertex", cached());
  scene.hash = {1, 2};
  another("the hash of the scene's files", cached());
  options = cached();
  options.useCache = false;
  options.seed = 77;
  same("the cache switched off", options);
}

TEST_CASE("a damaged truth in the cache is made anew and said so") {
  const OwnCache cache;
  const Scene scene = litRoom(12, 10);
  const LayeredPicture good = cachedReference(scene, cached());
  REQUIRE(cache.entries().size() == 1);
  const std::filesystem::path entry = cache.entries()[0];
  const std::string bytes = readFile(entry);

  std::string flipped = bytes;
  flipped[bytes.size() / 2] = static_cast<char>(flipped[bytes.size() / 2] ^ 0x10);
  LayeredPicture other = good;
  other.layers.at("full").at(3, 3, 1) += 1.0f;
  writeExr(cache.directory.path() / "other.exr", other);
  const std::string altered = readFile(cache.directory.path() / "other.exr");
  std::filesystem::remove(cache.directory.path() / "other.exr");

  for (const std::string& damaged :
       {std::string(), std::string("no picture"), bytes.substr(0, bytes.size() / 2), flipped, altered}) {
    CAPTURE(damaged.size());
    std::ofstream(entry, std::ios::binary) << damaged;
    const LogCapture log;
    CHECK(sameBits(good, cachedReference(scene, cached())));
    CHECK_THAT(log.text(), Catch::Contains("damaged"));
    CHECK(readFile(entry) == bytes);
  }
}
