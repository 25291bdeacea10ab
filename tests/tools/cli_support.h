// Texts and helpers that the tests of the command line share.
#pragma once

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "lumivox/base/file.h"
#include "support/facts.h"
#include "support/support.h"

namespace lumivox::test {

// ---- what is typed -------------------------------------------------------------------------------------

/// Words of a command line that are typed as they stand.
struct Raw {
  std::string words;
};

/// A part of a command line. Literals stand as they are typed, so that one may hold several words; strings
/// and files are one word each, and numbers are written out.
class Typed {
 public:
  Typed(const char* words) : text_(words) {}
  Typed(const std::string& word) : text_("'" + word + "'") {}
  Typed(const std::filesystem::path& file) : Typed(file.string()) {}
  template <class Number, std::enable_if_t<std::is_arithmetic_v<Number>, int> = 0>
  Typed(Number number) : text_(std::to_string(number)) {}
  Typed(const Raw& raw) : text_(raw.words) {}
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// What stands before the program's name: `COLUMNS=80`, or `cd FOLDER &&`.
struct Before {
  std::string text;
};
inline Before in(const std::filesystem::path& folder) {
  return {"cd '" + folder.string() + "' &&"};
}
inline Before columns(int count) {
  return {"COLUMNS=" + std::to_string(count)};
}

/// A program of the build with these words.
template <class... Words>
std::string lineOf(const char* program, const Before& before, const Words&... words) {
  std::string line = before.text + " '" + (binaryDirectory() / "bin" / program).string() + "'";
  for (const Typed& word : {Typed(words)...}) line += " " + word.text();
  return line;
}

/// What a command of lumivox says: typed("render", place.scene(), "-q -o", place.file("a.exr")).
template <class... Words>
CommandResult typed(const Before& before, const Words&... words) {
  return runCommand(lineOf("lumivox", before, words...));
}
template <class First, class... Words>
CommandResult typed(const First& first, const Words&... words) {
  return typed(Before{}, first, words...);
}

/// The same of a command that must end well.
template <class... Words>
CommandResult ran(const Words&... words) {
  CommandResult result = typed(words...);
  INFO(result.output << result.errors);
  REQUIRE(result.exitCode == 0);
  return result;
}

/// What it answers in JSON.
template <class... Words>
nlohmann::json answered(const Words&... words) {
  return nlohmann::json::parse(ran(words...).output);
}

inline std::string committedPipeline(const std::string& name) {
  return (sourceDirectory() / "scenes/pipelines" / (name + ".pipeline")).string();
}

// ---- where it is typed ---------------------------------------------------------------------------------

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
  std::filesystem::path operator/(const std::string& name) const { return path() / name; }
  /// The room through a committed pipeline, quietly; `rendered` must end well.
  template <class... Words>
  CommandResult render(const char* pipeline, const Words&... words) const {
    return typed("render -q", scene(), committedPipeline(pipeline), words...);
  }
  template <class... Words>
  CommandResult rendered(const char* pipeline, const Words&... words) const {
    return ran("render -q", scene(), committedPipeline(pipeline), words...);
  }
  /// Names of everything in the folder, to see that nothing half-written stays behind.
  std::size_t fileCount() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(path())) ++count;
    return count;
  }
};

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Remarks as they were before they were broken to fit the terminal.
inline std::string unwrapped(std::string text) {
  for (std::size_t at = text.find("\n  "); at != std::string::npos; at = text.find("\n  ", at))
    text.replace(at, 3, " ");
  return text;
}

/// Bad input: exit code 2, nothing on stdout, and a message that tells these facts, in their order.
template <class... Facts>
void checkRefused(const CommandResult& result, const Facts&... facts) {
  INFO("stdout: " << result.output << "\nstderr: " << result.errors);
  CHECK(result.exitCode == 2);
  CHECK(result.output.empty());
  CHECK_THAT(result.errors, Tells(facts...));
}

/// A finding in a text: its file, line and column, and its facts.
struct Finding {
  std::string place;
  Tells facts;
};
inline void checkFindings(const CommandResult& result, const std::vector<Finding>& findings) {
  checkRefused(result);
  for (const Finding& finding : findings) {
    std::string own;
    std::istringstream lines(result.errors);
    for (std::string line; std::getline(lines, line);)
      if (contains(line, "/" + finding.place + ": ")) own += line + "\n";
    CAPTURE(finding.place, own);
    CHECK_THAT(own, finding.facts);
  }
}

}  // namespace lumivox::test
