// The border between the framework and a technique library. One C entry point hands over a version record first; only when that
// agrees to the byte is anything of C++ exchanged.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/technique_source.h"

namespace lumivox {

inline constexpr std::uint32_t kTechniqueApiVersion = 1;

/// Plain data, C layout: compared member by member before anything else is called.
struct TechniqueVersionRecord {
  std::uint32_t recordSize;        ///< sizeof this struct
  std::uint32_t apiVersion;
  char compiler[64];               ///< e.g. "gcc 12"
  char standardLibrary[32];        ///< "libstdc++ cxx11-abi 1"
  char buildType[32];              ///< "release", "debug", "sanitized": what changes the layout or the runtime
  std::uint32_t passSize, passContextSize, sceneSize, snapshotSize, deviceSize;
};

/// The record of the code that includes this header.
TechniqueVersionRecord techniqueVersionHere();

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

/// In a technique's one source file, at namespace scope:
///   LUMIVOX_TECHNIQUE(registry) { registry.describe("...", "..."); registry.add<Gather>("gather", "..."); }
#define LUMIVOX_TECHNIQUE(registry)                                                                                        \
  static void lumivoxRegisterTechnique(::lumivox::TechniqueRegistry&(registry));                                             \
  extern "C" __attribute__((visibility("default"))) const ::lumivox::TechniqueVersionRecord* lumivox_technique_version() {  \
    static const ::lumivox::TechniqueVersionRecord record = ::lumivox::techniqueVersionHere();                              \
    return &record;                                                                                                         \
  }                                                                                                                         \
  extern "C" __attribute__((visibility("default"))) void lumivox_technique_register(::lumivox::TechniqueRegistry* target) { \
    lumivoxRegisterTechnique(*target);                                                                                      \
  }                                                                                                                         \
  static void lumivoxRegisterTechnique(::lumivox::TechniqueRegistry&(registry))
