#include <lumivox/base/error.h>
#include <lumivox/base/file.h>
#include <lumivox/shader/pack.h>

#include <set>

#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using namespace lumivox::shader;
using lumivox::test::Tells;

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
  const std::vector<std::uint32_t> a{0x07230203u, 1, 2, 3}, b{4, 5};
  pack.codes = compressed({{hashOf("a"), a}, {hashOf("b"), b}});
  return pack;
}

std::string wholePack() {
  const test::TemporaryDirectory directory;
  writeShaderPack(directory.path() / "whole.shaderpack", smallPack());
  return readFile(directory.path() / "whole.shaderpack");
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

TEST_CASE("codes come out of their blocks, whether they are larger than a block, small, or many") {
  std::vector<std::vector<std::uint32_t>> plain;
  std::uint32_t word = 1;
  for (const std::size_t words : {3u, 500000u, 7u, 200000u, 200000u, 1u}) {
    std::vector<std::uint32_t>& code = plain.emplace_back(words);
    for (std::uint32_t& value : code) value = word = word * 1664525u + 1013904223u;
  }
  ShaderPack pack = smallPack();
  std::vector<PlainCode> codes;
  for (const std::vector<std::uint32_t>& code : plain) codes.push_back({Hasher().add(code).finish(), code});
  pack.codes = compressed(codes);
  const test::TemporaryDirectory directory;
  writeShaderPack(directory.path() / "large.shaderpack", pack);
  const ShaderPack read = readShaderPack(directory.path() / "large.shaderpack");
  REQUIRE(read.codes.size() == plain.size());
  std::set<const Compressed*> blocks;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    CHECK(read.codes[i].hash == codes[i].hash);
    CHECK(read.codes[i].spirv() == plain[i]);
    blocks.insert(read.codes[i].block.get());
  }
  CHECK(blocks.size() > 2);
  CHECK(blocks.size() < plain.size());
}

TEST_CASE("the seed that the fuzzer of packs begins with is a pack of this version") {
  constexpr std::size_t kHeader = 8 + 4 + 8 + 16;
  CHECK(readFile(test::sourceDirectory() / "tests/fuzz/seeds/shader_pack/small") ==
        "%%CONTENT\n" + wholePack().substr(kHeader));
}

TEST_CASE("a pack that is cut anywhere, or has any byte changed, is refused") {
  const test::TemporaryDirectory directory;
  const std::string whole = wholePack();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    const auto cut = directory.write("cut.shaderpack", whole.substr(0, at));
    REQUIRE_THROWS_MATCHES(readShaderPack(cut), Error, Tells("cut.shaderpack"));
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 0x41);
    REQUIRE_THROWS_AS(readShaderPack(directory.write("changed.shaderpack", changed)), Error);
  }
}

TEST_CASE("a missing, foreign, older or overlong pack says so") {
  const test::TemporaryDirectory directory;
  std::string older = wholePack();
  older[8] = 0;  // the version follows the eight bytes of magic
  CHECK_THROWS_MATCHES(readShaderPack(directory.path() / "absent.shaderpack"), Error,
                       Tells("absent.shaderpack"));
  for (const auto& [content, told] :
       {std::pair(std::string("PK\3\4 this is something else, and long enough to hold a header"),
                  Tells("not a shader pack")),
        {older, Tells("version 0")},
        {wholePack() + "x", Tells("followed")}})
    CHECK_THROWS_MATCHES(readShaderPack(directory.write("bad.shaderpack", content)), Error, told);
}

TEST_CASE("a program that a pack lacks is an error that lists those it has") {
  const ShaderPack pack = smallPack();
  CHECK_THROWS_MATCHES(pack.program("conservativ"), Error,
                       Tells("voxelization", "conservativ", "conservative"));
}
