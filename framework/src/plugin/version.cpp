#include <fmt/format.h>

#include <cstring>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"

namespace lumivox {

std::string versionDifference(const TechniqueVersionRecord& theirs) {
  static constexpr TechniqueVersionRecord ours = techniqueVersionHere();
  std::string difference;
  const auto number = [&](const char* what, std::uint32_t their, std::uint32_t our) {
    if (difference.empty() && their != our)
      difference = fmt::format("{} is {}, expected {}", what, their, our);
  };
  const auto word = [&](const char* what, const auto& their, const auto& our) {
    if (difference.empty() && std::strncmp(their, our, sizeof(our)) != 0)
      difference = fmt::format("{} is '{}', expected '{}'", what,
                               std::string_view(their, strnlen(their, sizeof(our))), our);
  };
  // The size first: with another one, nothing behind it can be trusted. The hash of the headers behind what
  // tells more.
  number("the size of the version record", theirs.recordSize, ours.recordSize);
  number("the API version", theirs.apiVersion, ours.apiVersion);
  word("the compiler", theirs.compiler, ours.compiler);
  word("the standard library", theirs.standardLibrary, ours.standardLibrary);
  word("the build type", theirs.buildType, ours.buildType);
  word("the hash of the public headers", theirs.headers, ours.headers);
  number("the size of Pass", theirs.passSize, ours.passSize);
  number("the size of PassContext", theirs.passContextSize, ours.passContextSize);
  number("the size of Scene", theirs.sceneSize, ours.sceneSize);
  number("the size of SceneSnapshot", theirs.snapshotSize, ours.snapshotSize);
  number("the size of Device", theirs.deviceSize, ours.deviceSize);
  number("the size of the ports", theirs.portsSize, ours.portsSize);
  return difference;
}

void requireLibraryOf(const TechniqueVersionRecord& program) {
  if (const std::string difference = versionDifference(program); !difference.empty())
    throw Error("the program and its library liblumivox were built from different sources: " + difference +
                "; expected both from one build, such as that of the target 'laboratory'");
}

}  // namespace lumivox
