// Programs that compare depths must make the same depths of the same triangle.
#include <fstream>
#include <set>
#include <sstream>

#include "lumivox/shader/pack.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Whether SPIR-V decorates an output with BuiltIn Position, or the member of a block that is it, as
/// Invariant (SPIR-V 1.6, Sec. 3.20: BuiltIn 11, Invariant 18; Position 0; OpDecorate 71, OpMemberDecorate
/// 72).
bool hasInvariantPosition(const std::vector<std::uint32_t>& spirv) {
  using Target = std::pair<std::uint32_t, std::uint32_t>;
  constexpr std::uint32_t kWhole = ~0u;
  std::set<Target> positions, invariants;
  for (std::size_t at = 5; at < spirv.size(); at += spirv[at] >> 16) {
    const std::uint32_t operation = spirv[at] & 0xffffu;
    REQUIRE(spirv[at] >> 16 != 0);
    if (operation != 71 && operation != 72) continue;
    const bool member = operation == 72;
    const Target target{spirv[at + 1], member ? spirv[at + 2] : kWhole};
    const std::size_t decoration = at + (member ? 3 : 2);
    if (spirv[decoration] == 11 && spirv[decoration + 1] == 0) positions.insert(target);
    if (spirv[decoration] == 18) invariants.insert(target);
  }
  REQUIRE(!positions.empty());
  for (const Target& one : positions)
    if (invariants.count(one) == 0 && invariants.count({one.first, kWhole}) == 0) return false;
  return true;
}

std::string textOf(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("every program that compares its depth with that of another has a position that is invariant") {
  // A fragment stage that reads its own depth compares it with something that was drawn before; in this tree
  // depth peeling does, whose layers are drawn by programs for textures, masks and the first layer.
  std::size_t variants = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(sourceDirectory() / "shaders")) {
    if (entry.path().extension() != ".frag" ||
        textOf(entry.path()).find("gl_FragCoord.z") == std::string::npos)
      continue;
    const std::string technique = entry.path().parent_path().filename().string(),
                      program = entry.path().stem().string();
    INFO(technique << "/" << program);
    std::optional<shader::ShaderPack> pack;
    for (const std::filesystem::path& folder : TechniqueSet::defaultDirectories({}))
      if (!pack && std::filesystem::exists(folder / (technique + ".shaderpack")))
        pack = shader::readShaderPack(folder / (technique + ".shaderpack"));
    REQUIRE(pack);
    for (const shader::PackedVariant& variant : pack->program(program).variants)
      for (const shader::PackedStage& stage : variant.stages) {
        if (stage.stage != gpu::Stage::vertex) continue;
        ++variants;
        CHECK(hasInvariantPosition(pack->codes[stage.code].spirv()));
        // For drivers that take text.
        CHECK(pack->codes[stage.code].glsl().find("invariant gl_Position") != std::string::npos);
      }
  }
  CHECK(variants >= 8);  // of depth peeling: textures, masks, first layer
}
