#include <lumivox/base/error.h>
#include <lumivox/base/file.h>
#include <lumivox/shader/pack.h>

#include "support/support.h"

using namespace lumivox;
using namespace lumivox::shader;

namespace {

ShaderPack smallPack() {
  ShaderPack pack;
  pack.technique = "voxelization";
  PackedProgram program;
  program.name = "conservative";
  program.axes = {
      {"MASKS", {"0", "1"}, false}, {"SAMPLES", {"1", "4"}, false}, {"LIGHT", {"sun", "spot"}, true}};
  program.bindings = {
      {"counts", BindingKind::image, 2, "uimage3D r32ui", gpu::TextureKind::d3, false, gpu::Format::r32ui, 0},
      {"Camera", BindingKind::uniform, 0, "Camera", gpu::TextureKind::d2, false, std::nullopt, 64}};
  program.constants = {{"scale", 3, ConstantType::real, 0x3f800000u}};
  program.variants = {{{0, 4, 1}, {{gpu::Stage::vertex, 0}, {gpu::Stage::fragment, 1}}, {1}},
                      {{1, 1, 0}, {{gpu::Stage::compute, 1}}, {0, 1}}};
  program.possible = 8;
  pack.programs = {program};
  pack.codes = {PackedCode::of(hashOf("a"), std::vector<std::uint32_t>{0x07230203u, 1, 2, 3}),
                PackedCode::of(hashOf("b"), std::vector<std::uint32_t>{4, 5})};
  return pack;
}

}  // namespace

TEST_CASE("a pack comes back as it was written") {
  const test::TemporaryDirectory directory;
  const auto file = directory.path() / "voxelization.shaderpack";
  writeShaderPack(file, smallPack());
  const ShaderPack pack = readShaderPack(file), expected = smallPack();
  CHECK(pack.technique == "voxelization");
  REQUIRE(pack.programs.size() == 1);
  const PackedProgram& program = pack.program("conservative");
  CHECK(program.possible == 8);
  REQUIRE(program.axes.size() == 3);
  CHECK(program.axes[2].named);
  CHECK(program.axes[1].values == std::vector<std::string>{"1", "4"});
  REQUIRE(program.bindings.size() == 2);
  CHECK(program.bindings[0].name == "counts");
  CHECK(program.bindings[0].kind == BindingKind::image);
  CHECK(program.bindings[0].binding == 2);
  CHECK(program.bindings[0].textureKind == gpu::TextureKind::d3);
  CHECK(program.bindings[0].format == gpu::Format::r32ui);
  CHECK_FALSE(program.bindings[1].format.has_value());
  CHECK(program.bindings[1].minimumBytes == 64);
  REQUIRE(program.constants.size() == 1);
  CHECK(program.constants[0].defaultBits == 0x3f800000u);
  REQUIRE(program.variants.size() == 2);
  CHECK(program.variants[0].stages[1].code == 1);
  CHECK(program.variants[0].stages[1].stage == gpu::Stage::fragment);
  CHECK(program.variants[1].bindingsUsed == std::vector<std::uint32_t>{0, 1});
  CHECK(program.find({{1, 1, 0}}) == &program.variants[1]);
  CHECK(program.find({{1, 4, 0}}) == nullptr);
  CHECK(program.text({0, 4, 1}) == "MASKS=0 SAMPLES=4 LIGHT=spot");
  REQUIRE(pack.codes.size() == 2);
  CHECK(pack.codes[0].hash == expected.codes[0].hash);
  CHECK(pack.codes[0].spirv() == expected.codes[0].spirv());
  // The same content is the same file and the same hash.
  writeShaderPack(directory.path() / "again.shaderpack", smallPack());
  CHECK(readFile(directory.path() / "again.shaderpack") == readFile(file));
  CHECK(readShaderPack(directory.path() / "again.shaderpack").hash == pack.hash);
}

TEST_CASE("a pack cut off anywhere is refused by name") {
  const test::TemporaryDirectory directory;
  const auto file = directory.path() / "whole.shaderpack";
  writeShaderPack(file, smallPack());
  const std::string whole = readFile(file);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto cut = directory.write("cut.shaderpack", whole.substr(0, length));
    REQUIRE_THAT(test::messageOf<Error>([&] { readShaderPack(cut); }), Catch::Contains("cut.shaderpack"));
  }
}

TEST_CASE("a pack with any byte changed is refused") {
  const test::TemporaryDirectory directory;
  const auto file = directory.path() / "whole.shaderpack";
  writeShaderPack(file, smallPack());
  const std::string whole = readFile(file);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x41);
    REQUIRE_THROWS_AS(readShaderPack(directory.write("changed.shaderpack", changed)), Error);
  }
}

TEST_CASE("a missing, foreign, older or overlong pack says so") {
  const test::TemporaryDirectory directory;
  const auto file = directory.path() / "whole.shaderpack";
  writeShaderPack(file, smallPack());
  const std::string whole = readFile(file);
  const auto message = [&](const std::string& content) {
    return test::messageOf<Error>([&] { readShaderPack(directory.write("bad.shaderpack", content)); });
  };
  CHECK_THAT(test::messageOf<Error>([&] { readShaderPack(directory.path() / "absent.shaderpack"); }),
             Catch::Contains("absent.shaderpack"));
  CHECK_THAT(message("PK\3\4 this is something else, and long enough to hold a header"),
             Catch::Contains("not a shader pack"));
  std::string older = whole;
  older[8] = 0;  // the version follows the eight bytes of magic
  CHECK_THAT(message(older), Catch::Contains("version 0"));
  CHECK_THAT(message(whole + "x"), Catch::Contains("followed by other data"));
}

TEST_CASE("a program that a pack lacks is an error that lists those it has") {
  const ShaderPack pack = smallPack();
  CHECK_THAT(
      test::messageOf<Error>([&] { pack.program("conservativ"); }),
      Catch::Contains("'conservativ'") && Catch::Contains("conservative") && Catch::Contains("voxelization"));
}
