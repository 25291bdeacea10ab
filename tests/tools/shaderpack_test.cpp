#include <lumivox/base/error.h>
#include <lumivox/base/file.h>
#include <lumivox/shader/pack.h>

#include <algorithm>
#include <set>
#include <sstream>

#include "support/facts.h"
#include "support/support.h"

using namespace lumivox;
using test::Tells;
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

/// A program, by the stages of its files, that is refused at a line with these facts.
struct Wrong {
  std::vector<std::pair<const char*, std::string>> stages;  ///< "comp" and its text
  int line;                                                 ///< 0: none is known
  Tells facts;
};

/// All in one folder, which is compiled once: each error stands at its own file.
void checkRefused(const std::vector<Wrong>& all) {
  Project project;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (const auto& [stage, text] : all[i].stages)
      project.write("p" + std::to_string(i) + "." + stage, text);
  const std::string errors = project.errors();
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::string own;
    std::istringstream lines(errors);
    const std::string file = "/p" + std::to_string(i) + ".",
                      at = (all[i].line > 0 ? ":" + std::to_string(all[i].line)
                                            : file + all[i].stages.back().first) +
                           ": error: ";
    for (std::string line; std::getline(lines, line);)
      if (line[0] == '/' && line.find(file) != std::string::npos) own += line + "\n";
    CAPTURE(all[i].stages.back().second, own);
    CHECK_THAT(own, Catch::Contains(at) && all[i].facts);
  }
}

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

TEST_CASE("errors of all programs are reported together, each at its line, that of an included file there") {
  Project project;
  const std::string folder = project.writeCommon("three.glsl", "float three() {\n  return 3.0;\n}\n")
                                 .parent_path()
                                 .parent_path()
                                 .string();
  // Once for all variants, its text once below it.
  project.writeCommon("wrong.glsl", "#if MASKS\r\nfloat wrong() {\r\n\treturn first;\r\n}\r\n#endif\n");
  project.write("a.comp", "// a comment\n#include \"common/three.glsl\"\n" + kCompute +
                              "void main() {\n  values[0] = undeclared;\n}\n");
  project.write(
      "b.comp",
      "#pragma lumivox axis MASKS 0 1\n#pragma lumivox axis OTHER 0 1\n#include \"common/wrong.glsl\"\n" +
          kCompute + "void main() { values[0] = float(OTHER); }\n");
  project.write("c.comp", kCompute + "void main() {\n second(); }\n");
  project.write("d.comp", "\n#include \"common/absent.glsl\"\n" + kCompute + "void main() {}\n");
  const std::string errors = project.errors();
  INFO(errors);
  for (const char* error : {"/demo/a.comp:6: error: 'undeclared'", "/common/wrong.glsl:3: error: 'first'",
                            "/demo/c.comp:4: error: 'second'", "/demo/d.comp:2: error: ",
                            "\n  \treturn first;\n", "\n    values[0] = undeclared;\n"}) {
    const std::string text = (error[0] == '/' ? folder : "") + error;
    const std::size_t at = errors.find(text);
    CAPTURE(text);
    REQUIRE(at != std::string::npos);
    CHECK(errors.find(text, at + 1) == std::string::npos);
  }
  // Where a missing file was sought.
  CHECK_THAT(errors, Catch::Contains("shaders/common/absent.glsl") &&
                         Catch::Contains("shaders/demo/common/absent.glsl"));
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

TEST_CASE("wrong constraints, declarations, bindings and discards are errors at their line, all at once") {
  const auto constraint = [](const std::string& text) {
    return std::vector<std::pair<const char*, std::string>>{
        {"comp", "#pragma lumivox axis MASKS 0 1\n\n#pragma lumivox require " + text + "\n" + kCompute +
                     "void main() {}\n"}};
  };
  const auto declaration = [](const std::string& text, const std::string& use = "1.0") {
    return std::vector<std::pair<const char*, std::string>>{
        {"comp", kCompute + text + "\nvoid main() { values[0] = " + use + "; }\n"}};
  };
  const std::string hole = "if (textureLod(mask, place, 0.0).r < 0.5) discard;\n";
  const std::string sample = "result += texture(albedo, place);\n";
  const auto discarding = [&](const std::string& functions, const std::string& body) {
    return std::vector<std::pair<const char*, std::string>>{
        {"vert",
         "layout(location = 0) out vec2 place;\nvoid main() { place = vec2(gl_VertexID); gl_Position = vec4(0); }\n"},
        {"frag",
         "layout(binding = 0) uniform sampler2D albedo;\nlayout(binding = 1) uniform sampler2D mask;\n"
         "layout(location = 0) in vec2 place;\nlayout(location = 0) out vec4 result;\n" +
             functions + "\nvoid main() {\n  result = vec4(0);\n" + body + "}\n"}};
  };
  std::string many = "#pragma lumivox axis A 0 1 2 3 4 5 6 7 8 9";
  for (const char* axis : {"B", "C", "D"})
    many += std::string("\n#pragma lumivox axis ") + axis + " 0 1 2 3 4 5 6 7 8 9";
  checkRefused({
      {constraint("MASK"), 3, Tells("MASK", "did you mean", "MASKS")},
      {constraint("(MASKS"), 3, Tells("expected", ")")},
      {constraint("MASKS ||"), 3, Tells("end")},
      {constraint("MASKS MASKS"), 3, Tells("operator")},
      {constraint("MASKS == spot"), 3, Tells("spot", "MASKS")},
      {declaration("#pragma lumivox axes MASKS 0 1"), 3, Tells("expected", "axis", "require")},
      {declaration("#pragma lumivox axis masks 0 1"), 3, Tells("masks", "capitals")},
      {declaration("#pragma lumivox axis MASKS 0"), 3, Tells("MASKS", "two")},
      {declaration("#pragma lumivox axis MASKS 0 0"), 3, Tells("twice")},
      {declaration("#pragma lumivox axis MASKS 0 one"), 3, Tells("integers", "words")},
      {declaration("#version 330"), 3, Tells("#version", 450)},
      {{{"comp", many + "\n" + kCompute + "void main() {}\n"}}, 4, Tells(4096)},
      // What C++ could not serve.
      {declaration("uniform sampler2D albedo;", "texture(albedo, vec2(0)).r"), 3, Tells("albedo", "binding")},
      {declaration("layout(location = 0) uniform float gain;", "gain"), 3, Tells("gain", "block")},
      {declaration("layout(binding = 0) uniform sampler2D maps[2];", "texture(maps[1], vec2(0)).r"), 3,
       Tells("maps", "array")},
      {declaration("layout(binding = 0) uniform samplerCube sky;", "texture(sky, vec3(1)).r"), 3,
       Tells("sky")},
      {declaration("layout(std140, binding = 0) uniform camera { float x; };", "x"), 3, Tells("capital")},
      {declaration("layout(std140, binding = 0) uniform Camera { float weights[4]; };", "weights[1]"), 3,
       Tells("weights")},
      {declaration("layout(std140, binding = 0) uniform Camera { mat3 turn; };", "turn[1].x"), 3,
       Tells("turn")},
      {declaration("layout(std140, binding = 0) uniform Camera { layout(offset = 32) float x; };", "x"), 3,
       Tells(32)},
      {declaration("layout(binding = 0, r8ui) uniform uimage2D words;",
                   "float(imageLoad(words, ivec2(0)).x)"),
       3, Tells("words")},
      // Samples by derivatives after a discard, also in a function and in a later turn of a loop.
      {discarding("", hole + sample), 1, Tells("albedo", "derivatives", "discard")},
      {discarding("void cut() { " + hole + " }", "cut();\n" + sample), 1, Tells("albedo", "discard")},
      {discarding("vec4 look() { return texture(albedo, place); }", hole + "result = look();\n"), 1,
       Tells("albedo", "discard")},
      {discarding("", "for (int i = 0; i < 3; ++i) {\n" + sample +
                          "if (result.a + float(i) > place.x) discard;\n}\n"),
       1, Tells("albedo", "discard")},
      {discarding("", hole + "result.x = dFdx(place.x);\n"), 0, Tells("derivative", "discard")},
  });
  const std::string good[] = {
      sample + hole, hole + "result += textureLod(albedo, place, 1.0);\n",
      hole + "result += texelFetch(albedo, ivec2(place), 0);\n",
      "vec2 step = dFdx(place);\n" + hole + "result += textureGrad(albedo, place, step, step);\n",
      "for (int i = 0; i < 3; ++i) result += texture(albedo, place * float(i));\n" + hole};
  Project project;
  for (std::size_t i = 0; i < std::size(good); ++i)
    for (const auto& [stage, text] : discarding("", good[i]))
      project.write("p" + std::to_string(i) + "." + stage, text);
  project.pack();
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

TEST_CASE("stages and variants that contradict one another are errors, all at once") {
  const std::string vertex =
      "layout(location = 0) out vec2 uv;\nvoid main() { uv = vec2(0.0); gl_Position = vec4(0.0); }\n";
  const auto stages = [&](const std::string& vertexExtra, const std::string& fragment) {
    return std::vector<std::pair<const char*, std::string>>{
        {"vert", vertexExtra + vertex}, {"frag", "layout(location = 0) out vec4 radiance;\n" + fragment}};
  };
  checkRefused({
      {stages("", "layout(location = 1) in vec2 uv;\nvoid main() { radiance = vec4(uv, 0.0, 0.0); }\n"), 2,
       Tells("uv", 1, "p0.vert")},
      {stages("", "layout(location = 0) in vec3 normal;\nvoid main() { radiance = vec4(normal, 0.0); }\n"), 2,
       Tells("normal", "vec3", "p1.vert", "vec2", "uv")},
      {stages(
           "layout(std140, binding = 0) uniform Camera { float x; };\n",
           "layout(std140, binding = 1) uniform Camera { float x; };\nvoid main() { radiance = vec4(x); }\n"),
       2, Tells("Camera", "block", 1, 0)},
      {stages(
           "layout(std140, binding = 0) uniform Camera { float x; };\n",
           "layout(std140, binding = 0) uniform Camera { vec2 x; };\nvoid main() { radiance = vec4(x, x); }\n"),
       2, Tells("Camera", "layout")},
      {stages("layout(constant_id = 2) const int count = 1;\n",
              "layout(constant_id = 2) const int count = 2;\nvoid main() { radiance = vec4(count); }\n"),
       2, Tells("count", 2, "default")},
      {{{"comp", kCompute +
                     "layout(binding = 0) uniform sampler2D a; layout(binding = 0) uniform sampler2D b;\n"
                     "void main() { values[0] = texture(a, vec2(0)).r + texture(b, vec2(0)).r; }\n"}},
       3,
       Tells("a", "b", "texture", 0)},
  });
  checkRefused({{stages("#pragma lumivox axis MASKS 0 1\n",
                        "#pragma lumivox axis MASKS 1 0\nvoid main() { radiance = vec4(0.0); }\n"),
                 2, Tells("MASKS")}});
}

TEST_CASE("entry files that make no program are errors") {
  const auto checkMessage = [](std::initializer_list<const char*> names, const Tells& facts) {
    Project project;
    for (const char* name : names) project.write(name, "void main() {}\n");
    CHECK_THAT(project.errors(), facts);
  };
  checkMessage({"a.frag"}, Tells("vertex"));
  checkMessage({"a.comp", "a.vert"}, Tells("compute", "raster"));
  checkMessage({"Gather.comp"}, Tells("snake_case"));
  checkMessage({"notes.txt"}, Tells("no entry files"));
  checkMessage({}, Tells("no such folder"));
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
