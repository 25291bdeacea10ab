// Builds one technique: programs and variants from its entry files, checks, and the pack.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lumivox/shader/pack.h"
#include "stage.h"

namespace lumivox::shaderpack {

struct BuildOptions {
  std::string technique;
  std::filesystem::path source;  ///< folder of the entry files, which may lie in subfolders
  std::vector<std::filesystem::path> includes;
  std::filesystem::path cache;
  unsigned threads = 0;  ///< 0: one per core
};

/// Data of a program that the generated header needs beyond the pack.
struct ProgramInterface {
  std::vector<StructLayout> structs;                  ///< nested ones first
  std::map<std::string, std::uint32_t> elementBytes;  ///< stride of a storage block's unsized last array
  std::vector<std::uint32_t> groupSize;  ///< empty: no compute shader, or not the same in every variant
};

struct BuildResult {
  shader::ShaderPack pack;
  std::map<std::string, ProgramInterface> interfaces;
  std::set<std::filesystem::path> files;  ///< all sources read
  std::size_t compiled = 0, reused = 0;   ///< stages
  std::string warnings;
};

/// Throws Error with all findings, each as "file:line: error: ...".
BuildResult buildPack(const BuildOptions& options);

/// The text of the C++ header for the shader interfaces.
std::string generateHeader(const BuildResult& result);

}  // namespace lumivox::shaderpack
