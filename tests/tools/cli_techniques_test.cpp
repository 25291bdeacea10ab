// A technique library that does not fit, before the right one on the search path.
#include <cstddef>
#include <cstring>

#include "lumivox/base/image.h"
#include "lumivox/plugin/technique.h"
#include "support/elf.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;
using Json = nlohmann::json;

namespace {

namespace fs = std::filesystem;

/// The little room, a pipeline of cone tracing, and a folder with a library of voxelization that was compiled
/// with other headers: slots of 24 bytes an element have 4 there.
class Spoiled : public Workplace {
 public:
  Spoiled() {
    const fs::path built = binaryDirectory() / "lib/techniques";
    std::string library = readFile(built / "libvoxelization.so", kLargestLibraryFile);
    const auto record = partOf<Elf64_Shdr>(library, headerOfSection(library, LUMIVOX_VERSION_SECTION));
    std::memcpy(library.data() + record.sh_offset + offsetof(TechniqueVersionRecord, headers),
                "0123456789abcdef", 16);
    const auto constants = partOf<Elf64_Shdr>(library, headerOfSection(library, ".data.rel.ro"));
    int changed = 0;
    for (std::size_t at = 0; at + 8 <= constants.sh_size; at += 8)
      if (partOf<std::uint64_t>(library, constants.sh_offset + at) == 24) {
        setPart(library, constants.sh_offset + at, std::uint64_t{4});
        ++changed;
      }
    CHECK(changed > 0);
    write("other/libvoxelization.so", library);
    fs::copy_file(built / "voxelization.shaderpack", path() / "other/voxelization.shaderpack");
    write("cones.pipeline", readFile(committedPipeline("voxel_cone_tracing")));
  }
  std::string texts() const { return quoted(scene()) + " " + quoted(file("cones.pipeline")); }
  std::string before() const { return "--techniques " + quoted(file("other")) + " "; }
  static std::string quoted(const std::string& text) { return "'" + text + "'"; }
};

}  // namespace

TEST_CASE("a library that is skipped changes no bit of the picture that the one behind it makes") {
  const Spoiled place;
  const std::string render = "lumivox render " + place.texts() + " --resolution 16x12 --set resolution=16 ";
  const CommandResult alone = runCommand(render + "-o " + Spoiled::quoted(place.file("alone.exr")));
  INFO(alone.errors);
  REQUIRE(alone.exitCode == 0);
  const CommandResult both =
      runCommand(render + place.before() + "-o " + Spoiled::quoted(place.file("both.exr")));
  INFO(both.errors);
  REQUIRE(both.exitCode == 0);
  CHECK(contains(both.errors, "warning: skipped " + place.file("other/libvoxelization.so") +
                                  ": built for another Lumivox: the hash of the public headers is "
                                  "'0123456789abcdef'"));
  const LayeredImage first = readExr(place.file("alone.exr")), second = readExr(place.file("both.exr"));
  REQUIRE(first.layers.size() == second.layers.size());
  for (const auto& [name, image] : first.layers) {
    INFO(name);
    REQUIRE(second.layers.count(name) == 1);
    CHECK(image.values() == second.layers.at(name).values());
  }
}

TEST_CASE("strict refuses a technique library that would be skipped, whatever is done with it") {
  const Spoiled place;
  const std::string image = Spoiled::quoted(place.file("a.exr")), strict = " --strict " + place.before();
  for (const std::string& command :
       {"render " + place.texts() + " --resolution 8x8 -o " + image + strict,
        "check " + Spoiled::quoted(place.file("cones.pipeline")) + strict,
        "sweep " + Spoiled::quoted(place.scene()) + " --pipeline " +
            Spoiled::quoted(place.file("cones.pipeline")) + " --resolution 8x8 --store " +
            Spoiled::quoted(place.file("runs.sqlite")) + strict}) {
    INFO(command);
    const CommandResult refused = typed("-q", Raw{command});
    checkRefused(refused, place.file("other/libvoxelization.so") + ": built for another Lumivox");
    CHECK(contains(refused.errors, "refused under --strict"));
  }
  CHECK_FALSE(place.has("a.exr"));
}

TEST_CASE("a store keeps under a library's hash what that library measured, whatever was skipped before it") {
  const Spoiled place;
  const auto sweep = [&](const std::string& store, const std::string& more) {
    const CommandResult done = runCommand(
        "lumivox -q sweep " + Spoiled::quoted(place.scene()) + " --pipeline " +
        Spoiled::quoted(place.file("cones.pipeline")) + " --store " + Spoiled::quoted(place.file(store)) +
        " --set resolution=16 --resolution 8x8 --spp 4 --subpixels 1 --repeats 2 --seeds 1 --json " + more);
    INFO(done.errors);
    REQUIRE(done.exitCode == 0);
    return Json::parse(done.output);
  };
  const Json spoiled = sweep("both.sqlite", place.before()), sound = sweep("alone.sqlite", "");
  REQUIRE(spoiled["measured"] == 1);
  REQUIRE(sound["measured"] == 1);
  CHECK(spoiled["runs"][0]["errors"] == sound["runs"][0]["errors"]);
  // One identity: without the other library the point is held.
  const Json again = sweep("both.sqlite", "");
  CHECK(again["measured"] == 0);
  CHECK(again["held"] == 1);
}
