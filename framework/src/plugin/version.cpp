#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"

namespace lumivox {

namespace {

/// A printable text: a damaged record may contain anything.
template <std::size_t Size>
std::string shown(const char (&text)[Size]) {
  std::string word(text, strnlen(text, Size));
  std::replace_if(
      word.begin(), word.end(), [](unsigned char c) { return c < 0x20 || c > 0x7e; }, '?');
  return word;
}

}  // namespace

std::string versionDifference(std::string_view bytes) {
  static constexpr TechniqueVersionRecord ours = techniqueVersionHere();
  constexpr std::size_t kFixed = offsetof(TechniqueVersionRecord, compiler);  // the same in every version
  if (bytes.size() < kFixed)
    return fmt::format("the version record has {} bytes, expected {}", bytes.size(), sizeof(ours));
  TechniqueVersionRecord theirs{};
  std::memcpy(&theirs, bytes.data(), std::min(bytes.size(), sizeof(theirs)));
  if (theirs.recordSize != bytes.size())
    return fmt::format("the version record says that it has {} bytes, but {} are there", theirs.recordSize,
                       bytes.size());
  std::string difference;
  const auto number = [&](const char* what, std::uint32_t their, std::uint32_t our) {
    if (difference.empty() && their != our)
      difference = fmt::format("{} is {}, expected {}", what, their, our);
  };
  const auto word = [&](const char* what, const auto& their, const auto& our) {
    if (difference.empty() && std::strncmp(their, our, sizeof(our)) != 0)
      difference = fmt::format("{} is '{}', expected '{}'", what, shown(their), our);
  };
  // A record of another version or size says nothing reliable beyond that. The hash of the headers comes
  // last, since it explains least.
  number("the API version", theirs.apiVersion, ours.apiVersion);
  number("the size of the version record", theirs.recordSize, ours.recordSize);
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
  const std::string_view bytes(reinterpret_cast<const char*>(&program), sizeof(program));
  if (const std::string difference = versionDifference(bytes); !difference.empty())
    throw Error("the program and its library liblumivox were built from different sources: " + difference +
                "; expected both from one build, such as that of the target 'laboratory'");
}

}  // namespace lumivox
