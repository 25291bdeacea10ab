// References are kept by the content of everything that they depend on.
#include "lumivox/reference/reference_cache.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <tuple>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/hash.h"
#include "lumivox/base/log.h"
#include "lumivox/reference/path_tracer.h"
#include "support/facts.h"
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

bool sameBits(const LayeredImage& a, const LayeredImage& b) {
  if (a.layers.size() != b.layers.size()) return false;
  for (const auto& [name, layer] : a.layers) {
    const auto other = b.layers.find(name);
    if (other == b.layers.end() || !layer.sameShape(other->second) ||
        layer.values() != other->second.values())
      return false;
  }
  return true;
}

/// A forged entry, by one who knows how it is made: every statement of it is theirs, and its hash is right.
void writeHostileEntry(const std::filesystem::path& file, LayeredImage image) {
  Hasher hasher;
  for (const auto& [name, layer] : image.layers) {
    hasher.add(name).add(layer.width()).add(layer.height()).add(layer.channels()).add(layer.values());
  }
  for (const auto& [name, value] : image.attributes) hasher.add(name).add(value);
  image.attributes["content"] = hasher.finish().text();
  writeExr(file, image);
}

}  // namespace

TEST_CASE("a kept reference has the bits and the provenance of the rendered one") {
  const OwnCache cache;
  const Scene scene = litRoom(12, 10);
  const LayeredImage rendered = renderReference(scene, cached());
  const LayeredImage first = cachedReference(scene, cached());
  REQUIRE(cache.entries().size() == 1);
  const auto fileNumber = [&] {
    struct stat status {};
    REQUIRE(stat(cache.entries()[0].c_str(), &status) == 0);
    return status.st_ino;
  };
  const auto written = fileNumber();  // a file that is written anew is another one
  const LayeredImage second = cachedReference(scene, cached());
  CHECK(fileNumber() == written);
  CHECK(sameBits(rendered, first));
  CHECK(sameBits(rendered, second));
  for (const char* name :
       {"scene", "hash", "samples", "bounces", "seed", "time", "camera", "tracer_version"}) {
    CAPTURE(name);
    REQUIRE(second.attributes.count(name) == 1);
    CHECK(second.attributes.at(name) == rendered.attributes.at(name));
  }
}

TEST_CASE("the cache tells apart everything that changes the image, and nothing else") {
  const OwnCache cache;
  Scene scene = litRoom(6, 6);
  using Options = ReferenceOptions;
  const std::vector<std::tuple<const char*, bool, std::function<void(Options&)>>> changes{
      {"first", true, [](Options&) {}},
      {"threads", false, [](Options& o) { o.threads = 1; }},
      {"the camera's own width, stated", false, [](Options& o) { o.width = 6; }},
      {"width", true, [](Options& o) { o.width = 7; }},
      {"seed", true, [](Options& o) { o.seed = 9; }},
      {"samples", true, [](Options& o) { o.samplesPerPixel = 5; }},
      {"bounces", true, [](Options& o) { o.bounces = 3; }},
      {"occlusion", true, [](Options& o) { o.occlusionDistance = 0.2; }},
      {"layers of numbers of bounces", true,
       [](Options& o) {
         o.bounceLayers = {2, 1};
       }},
      {"the same layers in another order", false,
       [](Options& o) {
         o.bounceLayers = {1, 2, 2};
       }},
      {"fewer layers", true, [](Options& o) { o.bounceLayers = {1}; }},
      {"a material", true, [&](Options&) { scene.materials[0].diffuse.x = 0.5f; }},
      {"a vertex", true, [&](Options&) { scene.positions[0].x += 0.01f; }},
      {"the hash of the scene's files", true,
       [&](Options&) {
         scene.hash = {1, 2};
       }},
      {"the cache switched off", false, [](Options& o) { o.useCache = false, o.seed = 77; }}};
  std::size_t expected = 0;
  for (const auto& [what, isAnother, change] : changes) {
    CAPTURE(what);
    ReferenceOptions options = cached();
    change(options);
    const LayeredImage image = cachedReference(scene, options);
    expected += isAnother ? 1 : 0;
    CHECK(cache.entries().size() == expected);
    if (options.bounceLayers.size() > 1) CHECK(image.layers.count("bounces_2_glossy.variance") == 1);
  }
}

TEST_CASE("a damaged reference in the cache is made anew and said so") {
  const OwnCache cache;
  const Scene scene = litRoom(12, 10);
  const LayeredImage good = cachedReference(scene, cached());
  REQUIRE(cache.entries().size() == 1);
  const std::filesystem::path entry = cache.entries()[0];
  const std::string bytes = readFile(entry);

  std::string flipped = bytes;
  flipped[bytes.size() / 2] = static_cast<char>(flipped[bytes.size() / 2] ^ 0x10);
  LayeredImage other = good;
  other.layers.at("full").at(3, 3, 1) += 1.0f;
  writeExr(cache.directory.path() / "other.exr", other);
  const std::string altered = readFile(cache.directory.path() / "other.exr");
  std::filesystem::remove(cache.directory.path() / "other.exr");

  for (const std::string& damaged :
       {std::string(), std::string("no image"), bytes.substr(0, bytes.size() / 2), flipped, altered}) {
    CAPTURE(damaged.size());
    std::ofstream(entry, std::ios::binary) << damaged;
    const LogCapture log;
    CHECK(sameBits(good, cachedReference(scene, cached())));
    CHECK_THAT(log.text(), Tells("damaged"));
    CHECK(readFile(entry) == bytes);
  }
}

TEST_CASE("an entry of the cache that lies about itself is refused and made anew") {
  const OwnCache cache;
  const Scene scene = litRoom(12, 10);
  ReferenceOptions options = cached();
  options.progress = true;  // so that what it says of its bounces would be read
  const LogCapture quiet;
  const LayeredImage good = cachedReference(scene, options);
  REQUIRE(cache.entries().size() == 1);
  const std::filesystem::path entry = cache.entries()[0];
  const std::string bytes = readFile(entry);
  using Change = std::pair<std::string, std::function<void(LayeredImage&)>>;
  const std::vector<Change> changes{
      {"no bounces", [](LayeredImage& p) { p.attributes.erase("bounces"); }},
      {"bounces that are no number", [](LayeredImage& p) { p.attributes["bounces"] = "many"; }},
      {"bounces beyond an int", [](LayeredImage& p) { p.attributes["bounces"] = "99999999999999999999"; }},
      {"no scene", [](LayeredImage& p) { p.attributes.erase("scene"); }},
      {"another scene", [](LayeredImage& p) { p.attributes["hash"] = "00"; }},
      {"an absurd cut-off", [](LayeredImage& p) { p.attributes["cut_off"] = "1e300 -4"; }},
      {"a cut-off of words", [](LayeredImage& p) { p.attributes["cut_off"] = "much more"; }},
      {"no cut-off", [](LayeredImage& p) { p.attributes.erase("cut_off"); }},
      {"no full transport", [](LayeredImage& p) { p.layers.erase("full"); }},
      {"a layer too many", [](LayeredImage& p) { p.layers["x"] = p.layers["full"]; }},
      {"another layer", [](LayeredImage& p) { p.layers["x"] = p.layers["full"], p.layers.erase("full"); }},
      {"one channel", [](LayeredImage& p) { p.layers["full"] = ImageBuffer(12, 10, 1); }},
      {"another size",
       [](LayeredImage& p) {
         for (auto& [name, layer] : p.layers) layer = ImageBuffer(3, 2, layer.channels());
       }},
  };
  for (const auto& [what, change] : changes) {
    CAPTURE(what);
    LayeredImage changed = good;
    change(changed);
    writeHostileEntry(entry, changed);
    const LogCapture log;
    CHECK(sameBits(good, cachedReference(scene, options)));
    CHECK_THAT(log.text(), Tells("damaged", "rendered again"));
    CHECK(readFile(entry) == bytes);
  }
  // The same door lets the unchanged one through.
  writeHostileEntry(entry, good);
  const LogCapture log;
  CHECK(sameBits(good, cachedReference(scene, options)));
  CHECK_THAT(log.text(), !Catch::Contains("damaged"));
}

TEST_CASE("neither a FIFO nor a link in the cache is waited for, followed or kept") {
  const OwnCache cache;
  const Scene scene = litRoom(6, 6);
  const LayeredImage good = cachedReference(scene, cached());
  const std::filesystem::path entry = cache.entries().at(0);
  const TemporaryDirectory elsewhere;
  const std::filesystem::path victim = elsewhere.write("victim", "precious");
  for (const bool fifo : {true, false}) {
    CAPTURE(fifo);
    std::filesystem::remove(entry);
    if (fifo) {
      REQUIRE(mkfifo(entry.c_str(), 0600) == 0);
    } else {
      std::filesystem::create_symlink(victim, entry);
    }
    const LogCapture log;
    CHECK(sameBits(good, cachedReference(scene, cached())));
    CHECK_THAT(log.text(), Tells("rendered again"));
    CHECK(std::filesystem::is_regular_file(std::filesystem::symlink_status(entry)));
    CHECK(readFile(victim) == "precious");
  }
}

TEST_CASE("the cache keeps to its limit: what was not used for longest gives way") {
  const OwnCache cache;
  const Scene scene = litRoom(16, 16);
  const auto withSeed = [](std::uint64_t seed) {
    ReferenceOptions options = cached();
    options.seed = seed;
    return options;
  };
  const auto age = [&](const std::string& seed, std::time_t seconds) {  // how long ago it was used
    for (const KeptReference& one : keptReferences()) {
      if (one.attributes.at("seed") != seed) continue;
      const timespec times[2] = {{std::time(nullptr) - seconds, 0}, {std::time(nullptr) - seconds, 0}};
      REQUIRE(utimensat(AT_FDCWD, one.file.c_str(), times, 0) == 0);
    }
  };
  const auto seeds = [] {
    std::string all;
    for (const KeptReference& one : keptReferences()) all += one.attributes.at("seed") + " ";
    return all;
  };
  for (const std::uint64_t seed : {1, 2, 3}) cachedReference(scene, withSeed(seed));
  age("1", 3000), age("2", 2000), age("3", 1000);
  CHECK(seeds() == "3 2 1 ");
  CHECK(keptReferences().front().attributes.at("scene") == scene.name);
  cachedReference(scene, withSeed(1));  // taken: now the last used
  CHECK(seeds() == "1 3 2 ");
  age("1", 100);
  const std::uint64_t each = keptReferences().front().sizeBytes;
  setenv("LUMIVOX_CACHE_LIMIT", fmt::format("{}", 3 * each + each / 2).c_str(), 1);
  const LogCapture log;
  cachedReference(scene, withSeed(4));
  CHECK(seeds() == "4 1 3 ");
  CHECK_THAT(log.text(), Tells("least recently used"));
  setenv("LUMIVOX_CACHE_LIMIT", "a lot", 1);
  CHECK_THROWS_MATCHES(referenceCacheLimit(), Error, Tells("a lot"));
  unsetenv("LUMIVOX_CACHE_LIMIT");

  CHECK(pruneReferences(2 * each + each / 2, std::nullopt, /*dryRun=*/true).removed == 1);
  CHECK(seeds() == "4 1 3 ");
  CHECK(pruneReferences(~std::uint64_t{0}, std::chrono::seconds(500)).removed == 1);
  CHECK(seeds() == "4 1 ");
  const std::filesystem::path other = cache.directory.write("results.sqlite", "not a reference");
  CHECK(pruneReferences(0).removed == 2);
  CHECK(seeds().empty());
  CHECK(std::filesystem::exists(other));
  setenv("LUMIVOX_CACHE_LIMIT", "10", 1);  // too small for any: the image is made, and none is kept
  CHECK(cachedReference(scene, withSeed(5)).layers.count("full") == 1);
  CHECK(seeds().empty());
  unsetenv("LUMIVOX_CACHE_LIMIT");
}

TEST_CASE("sizes are read with their units") {
  CHECK(parseBytes("1048576") == std::uint64_t{1} << 20);
  CHECK(parseBytes("4GiB") == std::uint64_t{4} << 30);
  CHECK(parseBytes("1.5 MiB") == std::uint64_t{3} << 19);
  CHECK(parseBytes("500MB") == std::uint64_t{500'000'000});
  CHECK(parseBytes("7k") == std::uint64_t{7 * 1024});
  for (const char* bad : {"", "much", "-1", "4 PiB", "1e400", "5 GiBs", "nan"}) CHECK_FALSE(parseBytes(bad));
}
