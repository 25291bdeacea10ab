// The interface between the framework and a technique library. The library's file has a version record in an
// ELF section of its own. The library is opened, and its one entry point called, only if that record agrees
// to the byte.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/technique_source.h"
#include "lumivox/plugin/headers_hash.h"

namespace lumivox {

inline constexpr std::uint32_t kTechniqueApiVersion = 6;

/// Plain data, C layout, compared member by member. The first two members stay what they are in every
/// version.
struct TechniqueVersionRecord {
  std::uint32_t recordSize;  ///< sizeof this struct
  std::uint32_t apiVersion;
  char compiler[64];         ///< e.g. "gcc 12"
  char standardLibrary[32];  ///< "libstdc++ cxx11-abi 1"
  char buildType[32];        ///< "release", "debug", "sanitized": what changes the layout or the runtime
  char headers[40];          ///< hash of the public headers that it was compiled with
  std::uint32_t passSize, passContextSize, sceneSize, snapshotSize, deviceSize, portsSize;
};

/// The record of the code that includes this header. Evaluated by the compiler: the record is read from a
/// file that is not opened.
consteval TechniqueVersionRecord techniqueVersionHere() {
  TechniqueVersionRecord record{};
  record.recordSize = sizeof(TechniqueVersionRecord);
  record.apiVersion = kTechniqueApiVersion;
  const auto write = [](auto& target, const char* text, int number) {
    std::size_t at = 0;
    for (; *text != '\0'; ++text) target[at++] = *text;
    if (number >= 10) target[at++] = static_cast<char>('0' + number / 10 % 10);
    if (number >= 0) target[at++] = static_cast<char>('0' + number % 10);
  };
#if defined(__clang__)
  write(record.compiler, "clang ", __clang_major__);
#else
  write(record.compiler, "gcc ", __GNUC__);
#endif
#if defined(_LIBCPP_VERSION)
  write(record.standardLibrary, "libc++ abi ", _LIBCPP_ABI_VERSION);
#else
  write(record.standardLibrary, "libstdc++ cxx11-abi ", _GLIBCXX_USE_CXX11_ABI);
#endif
#if defined(__SANITIZE_ADDRESS__)
  write(record.buildType, "sanitized", -1);
#elif defined(_GLIBCXX_DEBUG)
  write(record.buildType, "debug", -1);
#else
  write(record.buildType, "release", -1);
#endif
  write(record.headers, kHeadersHash, -1);
  record.passSize = sizeof(Pass);
  record.passContextSize = sizeof(PassContext);
  record.sceneSize = sizeof(Scene);
  record.snapshotSize = sizeof(SceneSnapshot);
  record.deviceSize = sizeof(gpu::Device);
  record.portsSize = FrameworkPorts::bytes();
  return record;
}

/// What differs first between a version record and the framework's own: "the API version is 7, expected 6";
/// empty when nothing does. The record is given as its bytes, which may be too few or too many, and whose
/// strings may lack their end.
std::string versionDifference(std::string_view theirs);

/// For the start of a program: Error when it was compiled with other headers than the library that it runs
/// with, as after building the library alone. Its numbers would be wrong without a word.
void requireLibraryOf(const TechniqueVersionRecord& program);

/// Filled by the technique: which passes it has.
class TechniqueRegistry {
 public:
  virtual ~TechniqueRegistry() = default;
  virtual void describe(std::string meaning, std::string paper) = 0;
  virtual void add(PassEntry entry) = 0;
  template <class PassType>
  void add(std::string name, std::string meaning) {
    add(PassEntry{std::move(name), std::move(meaning), [] { return std::make_unique<PassType>(); }});
  }
};

}  // namespace lumivox

/// The ELF section of a technique library that holds its version record and nothing else.
#define LUMIVOX_VERSION_SECTION ".lumivox_version"

// A linker that leaves out unused sections keeps this one.
#if defined(__has_attribute) && __has_attribute(retain)
#define LUMIVOX_KEPT used, retain
#else
#define LUMIVOX_KEPT used
#endif

/// In a technique's one source file, at namespace scope:
///   LUMIVOX_TECHNIQUE(registry) { registry.describe("...", "..."); registry.add<Gather>("gather", "..."); }
#define LUMIVOX_TECHNIQUE(registry)                                                                          \
  static void lumivoxRegisterTechnique(::lumivox::TechniqueRegistry&(registry));                             \
  __attribute__((section(LUMIVOX_VERSION_SECTION),                                                           \
                 LUMIVOX_KEPT)) static constexpr ::lumivox::TechniqueVersionRecord lumivoxTechniqueVersion = \
      ::lumivox::techniqueVersionHere();                                                                     \
  extern "C" __attribute__((visibility("default"))) void lumivox_technique_register(                         \
      ::lumivox::TechniqueRegistry* target) {                                                                \
    lumivoxRegisterTechnique(*target);                                                                       \
  }                                                                                                          \
  static void lumivoxRegisterTechnique(::lumivox::TechniqueRegistry&(registry))
