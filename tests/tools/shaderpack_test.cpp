#include <lumivox/base/error.h>
#include <lumivox/base/file.h>
#include <lumivox/shader/pack.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "support/support.h"

using namespace lumivox;
namespace fs = std::filesystem;

namespace {

/// A folder of shaders and what shaderpack makes of it.
class Project {
 public:
  fs::path write(const std::string& name, const std::string& text) {
    return directory_.write("shaders/demo/" + name, text);
  }
  fs::path writeCommon(const std::string& name, const std::string& text) {
    return directory_.write("shaders/common/" + name, text);
  }

  test::CommandResult run() const {
    return test::runCommand("'" + (test::binaryDirectory() / "bin/shaderpack").string() +
                            "' --technique demo --source '" + (directory_.path() / "shaders/demo").string() +
                            "' --include '" + (directory_.path() / "shaders").string() + "' --cache '" +
                            cache().string() + "' --pack '" + packFile().string() + "' --header '" +
                            headerFile().string() + "' --depfile '" + depfile().string() + "'");
  }
  /// The errors of a run that must fail.
  std::string errors() const {
    const auto result = run();
    CAPTURE(result.output);
    CHECK(result.exitCode == 2);
    CHECK(result.output.empty());
    return result.errors;
  }
  shader::ShaderPack pack() const {
    const auto result = run();
    INFO(result.errors);
    REQUIRE(result.exitCode == 0);
    return shader::readShaderPack(packFile());
  }
  fs::path packFile() const { return directory_.path() / "demo.shaderpack"; }
  fs::path headerFile() const { return directory_.path() / "demo_shaders.h"; }
  fs::path depfile() const { return directory_.path() / "demo.d"; }
  fs::path cache() const { return directory_.path() / "cache"; }

 private:
  test::TemporaryDirectory directory_;
};

const std::string kCompute =
    "layout(local_size_x = 1) in;\nlayout(std430, binding = 0) buffer Values { float values[]; };\n";

std::set<std::vector<int>> combinations(const shader::PackedProgram& program) {
  std::set<std::vector<int>> values;
  for (const auto& variant : program.variants) values.insert(variant.values);
  return values;
}

/// The combinations of two axes that a constraint leaves; each of them must also compile.
std::set<std::vector<int>> allowed(const std::string& constraint) {
  Project project;
  project.write(
      "a.comp",
      "#pragma lumivox axis MASKS 0 1\n#pragma lumivox axis LIGHT sun spot point\n#pragma lumivox require " +
          constraint + "\n" + kCompute + "void main() { values[0] = float(MASKS * 10 + LIGHT); }\n");
  return combinations(project.pack().program("a"));
}

}  // namespace

TEST_CASE("an error is reported at its line of the entry file, after an include too") {
  Project project;
  project.writeCommon("three.glsl", "float three() {\n  return 3.0;\n}\n");
  const auto file = project.write("a.comp", "// a comment\n#include \"common/three.glsl\"\n" + kCompute +
                                                "void main() {\n  values[0] = undeclared;\n}\n");
  const std::string errors = project.errors();
  CHECK_THAT(errors, Catch::StartsWith(file.string() + ":6: error: 'undeclared'"));
}

TEST_CASE("an error in an included file is reported there, once for all variants") {
  Project project;
  const auto file =
      project.writeCommon("wrong.glsl", "#if MASKS\nfloat wrong() {\n\n  return vec2(1.0);\n}\n#endif\n");
  project.write(
      "a.comp",
      "#pragma lumivox axis MASKS 0 1\n#pragma lumivox axis OTHER 0 1\n#include \"common/wrong.glsl\"\n" +
          kCompute + "void main() { values[0] = float(OTHER); }\n");
  const std::string errors = project.errors();
  CHECK_THAT(errors, Catch::StartsWith(file.string() + ":4: error: "));
  std::istringstream lines(errors);
  std::set<std::string> distinct;
  for (std::string line; std::getline(lines, line);) CHECK(distinct.insert(line).second);
}

TEST_CASE("the text of the line stands once below the errors that the compiler finds in it") {
  Project project;
  const auto included = project.writeCommon("wrong.glsl", "float wrong() {\r\n\treturn first;\r\n}\r\n");
  project.write("a.comp", "#include \"common/wrong.glsl\"\n" + kCompute + "void main() {}\n");
  project.write("b.comp", kCompute + "void main() {\n  values[0] = second;\n}\n");
  const std::string errors = project.errors();
  INFO(errors);
  CHECK_THAT(errors, Catch::Contains(included.string() + ":2: error: 'first'"));
  for (const std::string line : {"\n  \treturn first;\n", "\n    values[0] = second;\n"}) {
    const std::size_t shown = errors.find(line);
    REQUIRE(shown != std::string::npos);
    CHECK(errors.find(line, shown + 1) == std::string::npos);
  }
}

TEST_CASE("all programs' errors are reported together") {
  Project project;
  project.write("a.comp", kCompute + "void main() { first(); }\n");
  project.write("b.comp", kCompute + "void main() {\n second(); }\n");
  CHECK_THAT(project.errors(), Catch::Contains("a.comp:3: error") && Catch::Contains("b.comp:4: error"));
}

TEST_CASE("files include each other without guards, from beside themselves or from the include folder") {
  Project project;
  project.writeCommon("a.glsl", "#include \"b.glsl\"\nfloat a() { return b() + 1.0; }\n");
  project.writeCommon("b.glsl", "#include \"a.glsl\"\nfloat b() { return 2.0; }\n");
  project.writeCommon(
      "guarded.glsl",
      "#ifndef GUARDED\n#define GUARDED\n#include \"b.glsl\"\nfloat guarded() { return b(); }\n#endif\n");
  project.write("beside.glsl", "#include \"common/a.glsl\"\nfloat beside() { return a(); }\n");
  project.write("entry.comp",
                "#if 0\n#include \"common/b.glsl\"\n#endif\n#include \"beside.glsl\"\n#include "
                "\"common/guarded.glsl\"\n/*\n#include "
                "\"absent.glsl\"\n*/\n" +
                    kCompute + "void main() { values[0] = beside() + a() + guarded(); }\n");
  const auto pack = project.pack();
  CHECK(pack.codes.size() == 1);
  const std::string dependencies = readFile(project.depfile());
  for (const char* name : {"a.glsl", "b.glsl", "guarded.glsl", "beside.glsl", "entry.comp"})
    CHECK_THAT(dependencies, Catch::Contains(name));
}

TEST_CASE("programs in folders below are named by their files alone, and stand in one folder each") {
  Project project;
  const std::string main = "void main() { values[0] = value(); }\n";
  project.write("b.comp", "#include \"part/value.glsl\"\n" + kCompute + main);
  project.write("part/value.glsl", "float value() { return 1.0; }\n");
  project.write("part/a.comp", "#include \"value.glsl\"\n" + kCompute + main);
  project.write("other/c.comp", "#include \"../part/value.glsl\"\n" + kCompute + main);
  std::vector<std::string> names;
  for (const shader::PackedProgram& program : project.pack().programs) names.push_back(program.name);
  CHECK(names == std::vector<std::string>{"a", "b", "c"});
  CHECK(project.pack().codes.size() == 1);
  CHECK_THAT(readFile(project.depfile()),
             Catch::Contains("part/a.comp") && Catch::Contains("part/value.glsl"));

  const fs::path twin = project.write("other/a.comp", kCompute + "void main() {}\n");
  CHECK_THAT(project.errors(),
             Catch::Contains("the program a has a file in another folder, " + twin.string()));
}

TEST_CASE("a missing include says where it was sought") {
  Project project;
  const auto file =
      project.write("a.comp", "\n#include \"common/absent.glsl\"\n" + kCompute + "void main() {}\n");
  CHECK_THAT(project.errors(), Catch::StartsWith(file.string() + ":2: error: ") &&
                                   Catch::Contains("shaders/common/absent.glsl") &&
                                   Catch::Contains("shaders/demo/common/absent.glsl"));
}

TEST_CASE("variants are the product of the axes without what the constraints exclude") {
  CHECK(allowed("1 || 0").size() == 6);
  CHECK(allowed("!MASKS || LIGHT == spot") == std::set<std::vector<int>>{{0, 0}, {0, 1}, {0, 2}, {1, 1}});
  CHECK(allowed("LIGHT != LIGHT_POINT && MASKS == 1") == std::set<std::vector<int>>{{1, 0}, {1, 1}});
  // && binds tighter than ||, ! tightest; parentheses override.
  CHECK(allowed("MASKS && LIGHT == sun || LIGHT == point") ==
        std::set<std::vector<int>>{{1, 0}, {0, 2}, {1, 2}});
  CHECK(allowed("MASKS && (LIGHT == sun || LIGHT == point)") == std::set<std::vector<int>>{{1, 0}, {1, 2}});
  CHECK(allowed("!(MASKS || LIGHT == 1)") == std::set<std::vector<int>>{{0, 0}, {0, 2}});
}

TEST_CASE("a malformed constraint is an error at its line") {
  const auto message = [](const std::string& constraint) {
    Project project;
    project.write("a.comp", "#pragma lumivox axis MASKS 0 1\n\n#pragma lumivox require " + constraint + "\n" +
                                kCompute + "void main() {}\n");
    const std::string errors = project.errors();
    CHECK_THAT(errors, Catch::Contains("a.comp:3: error: "));
    return errors;
  };
  CHECK_THAT(message("MASK"),
             Catch::Contains("'MASK' is not an axis") && Catch::Contains("did you mean 'MASKS'"));
  CHECK_THAT(message("(MASKS"), Catch::Contains("expected ')'"));
  CHECK_THAT(message("MASKS ||"), Catch::Contains("at the end"));
  CHECK_THAT(message("MASKS MASKS"), Catch::Contains("expected an operator"));
  CHECK_THAT(message("MASKS == spot"), Catch::Contains("nor a value of MASKS"));
}

TEST_CASE("wrong declarations are errors at their line") {
  const auto message = [](const std::string& line) {
    Project project;
    project.write("a.comp", kCompute + line + "\nvoid main() {}\n");
    const std::string errors = project.errors();
    CHECK_THAT(errors, Catch::Contains("a.comp:3: error: "));
    return errors;
  };
  CHECK_THAT(message("#pragma lumivox axes MASKS 0 1"), Catch::Contains("expected axis or require"));
  CHECK_THAT(message("#pragma lumivox axis masks 0 1"), Catch::Contains("expected capitals"));
  CHECK_THAT(message("#pragma lumivox axis MASKS 0"), Catch::Contains("at least two values"));
  CHECK_THAT(message("#pragma lumivox axis MASKS 0 0"), Catch::Contains("twice"));
  CHECK_THAT(message("#pragma lumivox axis MASKS 0 one"), Catch::Contains("all integers or all words"));
  CHECK_THAT(message("#version 330"), Catch::Contains("#version 450"));
  std::string many = "#pragma lumivox axis A 0 1 2 3 4 5 6 7 8 9";
  Project project;
  for (const char* axis : {"B", "C", "D"})
    many += std::string("\n#pragma lumivox axis ") + axis + " 0 1 2 3 4 5 6 7 8 9";
  project.write("a.comp", many + "\n" + kCompute + "void main() {}\n");
  CHECK_THAT(project.errors(), Catch::Contains("a.comp:4: error: ") && Catch::Contains("more than 4096"));
}

TEST_CASE("axis values are numbers or words, and C++ gets them with the first as default") {
  Project project;
  project.write(
      "a.comp",
      "#version 450 core\n#pragma lumivox axis SAMPLE_COUNT 4 1\n#pragma lumivox axis LIGHT sun spot\n" +
          kCompute +
          "void main() { values[0] = float(SAMPLE_COUNT * 10 + (LIGHT == LIGHT_SPOT ? 1 : 0)); }\n");
  CHECK(combinations(project.pack().program("a")) ==
        std::set<std::vector<int>>{{4, 0}, {4, 1}, {1, 0}, {1, 1}});
  const std::string header = readFile(project.headerFile());
  CHECK_THAT(header, Catch::Contains("int sampleCount = 4;") &&
                         Catch::Contains("enum : int { lightSun, lightSpot }"));
}

TEST_CASE("a stage that does not mention an axis is compiled once, and equal code is kept once") {
  Project project;
  project.write("a.vert",
                "layout(location = 0) out float x;\nvoid main() { x = 1.0; gl_Position = vec4(0.0); }\n");
  project.write("a.frag",
                "#pragma lumivox axis BRIGHT 0 1\n#pragma lumivox axis UNUSED 0 1\nlayout(location = 0) in "
                "float x;\nlayout(location = 0) "
                "out float radiance;\nvoid main() { radiance = BRIGHT == 1 ? x : 2.0 * x; if (UNUSED == 2) "
                "radiance = 0.0; }\n");
  const auto result = project.run();
  INFO(result.errors);
  REQUIRE(result.exitCode == 0);
  // One vertex stage and four fragment stages; UNUSED changes nothing, so that two codes are left of the
  // four.
  CHECK_THAT(result.output,
             Catch::Contains("compiled 5, reused 0 stages; 4 of 4 variants of 1 programs, 3 distinct codes"));
  const auto pack = shader::readShaderPack(project.packFile());
  std::set<std::size_t> vertexCodes;
  for (const auto& variant : pack.program("a").variants) vertexCodes.insert(variant.stages[0].code);
  CHECK(vertexCodes.size() == 1);
}

TEST_CASE("an unchanged shader is never compiled again; a changed include reaches those that use it") {
  Project project;
  project.writeCommon("gain.glsl", "const float gain = 2.0;\n");
  project.write("a.comp",
                "#include \"common/gain.glsl\"\n" + kCompute + "void main() { values[0] = gain; }\n");
  project.write("b.comp", kCompute + "void main() { values[0] = 1.0; }\n");
  CHECK_THAT(project.run().output, Catch::Contains("compiled 2, reused 0"));
  const std::string pack = readFile(project.packFile());
  const auto headerTime = fs::last_write_time(project.headerFile());
  CHECK_THAT(project.run().output, Catch::Contains("compiled 0, reused 2"));
  CHECK(readFile(project.packFile()) == pack);
  project.writeCommon("gain.glsl", "const float gain = 3.0;\n");
  CHECK_THAT(project.run().output, Catch::Contains("compiled 1, reused 1"));
  CHECK(readFile(project.packFile()) != pack);
  // The interface is the same: the C++ side is not touched.
  CHECK(fs::last_write_time(project.headerFile()) == headerTime);
  project.writeCommon("gain.glsl", "const float gain = 2.0;\n");
  CHECK_THAT(project.run().output, Catch::Contains("compiled 0, reused 2"));
  CHECK(readFile(project.packFile()) == pack);
}

TEST_CASE("a damaged cache is compiled anew") {
  Project project;
  project.write("a.comp", kCompute + "void main() { values[0] = 1.0; }\n");
  REQUIRE(project.run().exitCode == 0);
  const std::string pack = readFile(project.packFile());
  int damaged = 0;
  for (const auto& file : fs::directory_iterator(project.cache() / "demo")) {
    const std::string artifact = readFile(file.path());
    writeFileAtomically(file.path(), artifact.substr(0, artifact.size() / 2));
    ++damaged;
  }
  CHECK(damaged == 1);
  CHECK_THAT(project.run().output, Catch::Contains("compiled 1, reused 0"));
  CHECK(readFile(project.packFile()) == pack);
}

TEST_CASE("a failing run leaves the earlier pack and header as they were") {
  Project project;
  project.write("a.comp", kCompute + "void main() { values[0] = 1.0; }\n");
  REQUIRE(project.run().exitCode == 0);
  const std::string pack = readFile(project.packFile()), header = readFile(project.headerFile());
  project.write("b.comp", "layout(local_size_x = 1) in;\nvoid main() { nonsense }\n");
  project.errors();
  CHECK(readFile(project.packFile()) == pack);
  CHECK(readFile(project.headerFile()) == header);
}

TEST_CASE("a binding that C++ could not serve is an error at its declaration") {
  const auto message = [](const std::string& declaration, const std::string& use) {
    Project project;
    project.write("a.comp", kCompute + declaration + "\nvoid main() { values[0] = " + use + "; }\n");
    const std::string errors = project.errors();
    CHECK_THAT(errors, Catch::Contains("a.comp:3: error: "));
    return errors;
  };
  CHECK_THAT(message("uniform sampler2D albedo;", "texture(albedo, vec2(0)).r"),
             Catch::Contains("'albedo' has no layout(binding"));
  CHECK_THAT(message("layout(location = 0) uniform float gain;", "gain"),
             Catch::Contains("'gain' is in no block"));
  CHECK_THAT(message("layout(binding = 0) uniform sampler2D maps[2];", "texture(maps[1], vec2(0)).r"),
             Catch::Contains("'maps' is an array"));
  CHECK_THAT(message("layout(binding = 0) uniform samplerCube sky;", "texture(sky, vec3(1)).r"),
             Catch::Contains("'sky'"));
  CHECK_THAT(message("layout(std140, binding = 0) uniform camera { float x; };", "x"),
             Catch::Contains("begin with a capital"));
  CHECK_THAT(message("layout(std140, binding = 0) uniform Camera { float weights[4]; };", "weights[1]"),
             Catch::Contains("'weights'"));
  CHECK_THAT(message("layout(std140, binding = 0) uniform Camera { mat3 turn; };", "turn[1].x"),
             Catch::Contains("'turn'"));
  CHECK_THAT(message("layout(std140, binding = 0) uniform Camera { layout(offset = 32) float x; };", "x"),
             Catch::Contains("32 bytes"));
  CHECK_THAT(
      message("layout(binding = 0, r8ui) uniform uimage2D words;", "float(imageLoad(words, ivec2(0)).x)"),
      Catch::Contains("'words'"));
  CHECK_THAT(message("layout(binding = 0) uniform sampler2D a; layout(binding = 0) uniform sampler2D b;",
                     "texture(a, vec2(0)).r + texture(b, vec2(0)).r"),
             Catch::Contains("'a' and 'b' are both sampled texture 0"));
}

TEST_CASE(
    "a sample by derivatives after a discard is an error, also in a function and in a later turn of a loop") {
  const auto write = [](Project& project, const std::string& functions, const std::string& body) {
    project.write(
        "a.vert",
        "layout(location = 0) out vec2 place;\nvoid main() { place = vec2(gl_VertexID); gl_Position = "
        "vec4(0); }\n");
    project.write(
        "a.frag",
        "layout(binding = 0) uniform sampler2D albedo;\nlayout(binding = 1) uniform sampler2D mask;\n"
        "layout(location = 0) in vec2 place;\nlayout(location = 0) out vec4 result;\n" +
            functions + "\nvoid main() {\n  result = vec4(0);\n" + body + "}\n");
  };
  const std::string hole = "if (textureLod(mask, place, 0.0).r < 0.5) discard;\n";
  const std::string sample = "result += texture(albedo, place);\n";
  const std::string cut = "void cut() { " + hole + " }";
  const std::string look = "vec4 look() { return texture(albedo, place); }";
  const struct {
    std::string functions, body;
  } bad[] = {
      {"", hole + sample},
      {cut, "cut();\n" + sample},
      {look, hole + "result = look();\n"},
      {"", "for (int i = 0; i < 3; ++i) {\n" + sample + "if (result.a + float(i) > place.x) discard;\n}\n"}};
  for (const auto& one : bad) {
    CAPTURE(one.functions, one.body);
    Project project;
    write(project, one.functions, one.body);
    CHECK_THAT(project.errors(),
               Catch::Contains("a.frag:1: error: 'albedo' is sampled by derivatives after a discard"));
  }
  Project derivative;
  write(derivative, "", hole + "result.x = dFdx(place.x);\n");
  CHECK_THAT(derivative.errors(), Catch::Contains("a derivative is taken after a discard"));
  const std::string good[] = {
      sample + hole, hole + "result += textureLod(albedo, place, 1.0);\n",
      hole + "result += texelFetch(albedo, ivec2(place), 0);\n",
      "vec2 step = dFdx(place);\n" + hole + "result += textureGrad(albedo, place, step, step);\n",
      "for (int i = 0; i < 3; ++i) result += texture(albedo, place * float(i));\n" + hole};
  for (const std::string& body : good) {
    CAPTURE(body);
    Project project;
    write(project, "", body);
    project.pack();
  }
}

TEST_CASE("stages and variants that contradict one another are errors") {
  const std::string vertex =
      "layout(location = 0) out vec2 uv;\nvoid main() { uv = vec2(0.0); gl_Position = vec4(0.0); }\n";
  const auto message = [&](const std::string& vertexExtra, const std::string& fragment) {
    Project project;
    project.write("a.vert", vertexExtra + vertex);
    project.write("a.frag", "layout(location = 0) out vec4 radiance;\n" + fragment);
    return project.errors();
  };
  CHECK_THAT(
      message("", "layout(location = 1) in vec2 uv;\nvoid main() { radiance = vec4(uv, 0.0, 0.0); }\n"),
      Catch::Contains("a.frag:2: error: ") && Catch::Contains("'uv' at location 1 is not written by a.vert"));
  CHECK_THAT(
      message("", "layout(location = 0) in vec3 normal;\nvoid main() { radiance = vec4(normal, 0.0); }\n"),
      Catch::Contains("a.frag:2: error: ") && Catch::Contains("vec3") && Catch::Contains("vec2"));
  CHECK_THAT(
      message(
          "layout(std140, binding = 0) uniform Camera { float x; };\n",
          "layout(std140, binding = 1) uniform Camera { float x; };\nvoid main() { radiance = vec4(x); }\n"),
      Catch::Contains("'Camera'") && Catch::Contains("uniform block 1"));
  CHECK_THAT(message("layout(std140, binding = 0) uniform Camera { float x; };\n",
                     "layout(std140, binding = 0) uniform Camera { vec2 x; };\nvoid main() { radiance = "
                     "vec4(x, x); }\n"),
             Catch::Contains("'Camera' has another layout"));
  CHECK_THAT(
      message("layout(constant_id = 2) const int count = 1;\n",
              "layout(constant_id = 2) const int count = 2;\nvoid main() { radiance = vec4(count); }\n"),
      Catch::Contains("'count'") && Catch::Contains("default"));
  CHECK_THAT(message("#pragma lumivox axis MASKS 0 1\n",
                     "#pragma lumivox axis MASKS 1 0\nvoid main() { radiance = vec4(0.0); }\n"),
             Catch::Contains("axis MASKS has other values"));
}

TEST_CASE("entry files that make no program are errors") {
  const auto message = [](std::initializer_list<const char*> names) {
    Project project;
    for (const char* name : names) project.write(name, "void main() {}\n");
    return project.errors();
  };
  CHECK_THAT(message({"a.frag"}), Catch::Contains("needs a vertex stage"));
  CHECK_THAT(message({"a.comp", "a.vert"}), Catch::Contains("either a compute shader or raster stages"));
  CHECK_THAT(message({"Gather.comp"}), Catch::Contains("snake_case"));
  CHECK_THAT(message({"notes.txt"}), Catch::Contains("no entry files"));
  CHECK_THAT(Project().errors(), Catch::Contains("no such folder"));
  CHECK(test::runCommand("'" + (test::binaryDirectory() / "bin/shaderpack").string() + "' --technique demo")
            .exitCode == 2);
}

TEST_CASE("a binding that only some variants use is recorded as used by those alone") {
  Project project;
  project.write("a.comp", "#pragma lumivox axis MASKS 0 1\n" + kCompute +
                              "layout(binding = 3) uniform sampler2D mask;\nvoid main() { values[0] = MASKS "
                              "== 1 ? texture(mask, vec2(0.5)).r : 1.0; }\n");
  const auto pack = project.pack();
  const auto& program = pack.program("a");
  REQUIRE(program.bindings.size() == 2);
  REQUIRE(program.variants.size() == 2);
  const auto uses = [&](const shader::PackedVariant& variant, const std::string& name) {
    return std::any_of(variant.bindingsUsed.begin(), variant.bindingsUsed.end(),
                       [&](auto i) { return program.bindings[i].name == name; });
  };
  CHECK_FALSE(uses(program.variants[0], "mask"));
  CHECK(uses(program.variants[1], "mask"));
  CHECK(uses(program.variants[0], "Values"));
}
