// Texts and helpers that the tests of the command line share.
#pragma once

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "lumivox/base/file.h"
#include "support/support.h"

namespace lumivox::test {

/// A closed little room of six quads with a light in the middle of it: direct and indirect light, nothing
/// glossy.
inline constexpr const char* kRoomObj =
    "mtllib room.mtl\n"
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "o walls\nusemtl grey\n"
    "f 1 2 3 4\nf 6 5 8 7\nf 5 1 4 8\nf 2 6 7 3\nf 5 6 2 1\nf 4 3 7 8\n";
inline constexpr const char* kRoomMtl = "newmtl grey\nKd 0.6 0.5 0.4\n";
inline constexpr const char* kRoomScene =
    "scene \"Little room\" {\n"
    "  camera main { eye 0 0 0.9  target 0 0 -1  fov 70 deg  resolution 24 16 }\n"
    "  mesh room { file \"room.obj\" }\n"
    "  light bulb point { position 0.2 0.5 0  intensity 1 1 1 }\n"
    "}\n";

/// Its own reference cache and its own folder with the little room, and no asset path of the machine.
class Workplace : public TemporaryDirectory {
 public:
  Workplace() {
    setenv("LUMIVOX_CACHE", (path() / "cache").c_str(), 1);
    write("room.obj", kRoomObj);
    write("room.mtl", kRoomMtl);
    write("room.scene", kRoomScene);
  }
  std::string file(const std::string& name) const { return (path() / name).string(); }
  std::string scene() const { return file("room.scene"); }
  std::string read(const std::string& name) const { return readFile(path() / name); }
  bool has(const std::string& name) const { return std::filesystem::exists(path() / name); }
  /// Names of everything in the folder, to see that nothing half-written stays behind.
  std::size_t fileCount() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(path())) ++count;
    return count;
  }
};

inline std::string committedPipeline(const std::string& name) {
  return (sourceDirectory() / "scenes/pipelines" / (name + ".pipeline")).string();
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Remarks as they were before they were broken to fit the terminal.
inline std::string unwrapped(std::string text) {
  for (std::size_t at = text.find("\n  "); at != std::string::npos; at = text.find("\n  ", at))
    text.replace(at, 3, " ");
  return text;
}

/// Bad input: exit code 2, nothing on stdout, and a message that names what it is about.
inline void checkRefused(const CommandResult& result, const std::string& named) {
  INFO("stdout: " << result.output << "\nstderr: " << result.errors);
  CHECK(result.exitCode == 2);
  CHECK(result.output.empty());
  CHECK(contains(result.errors, named));
}

}  // namespace lumivox::test
