// The rules of the house: who may include whom, what may be named where, one name everywhere. The scanner
// itself is tested first, on bad examples, so that a rule cannot hold by never firing.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "support/techniques.h"
#include "tools/house_rules.h"

namespace {

namespace fs = std::filesystem;
using namespace lumivox::test::house;

constexpr std::uintmax_t kLargestFile = std::uintmax_t{1}
                                        << 20;  // bytes; larger data belongs on the asset path

// ---- the project
// ---------------------------------------------------------------------------------------------------------------------

/// All files of the project but for what .gitignore names.
const std::vector<fs::path>& projectFiles() {
  static const std::vector<fs::path> files = [] {
    std::vector<fs::path> result;
    const fs::path root = lumivox::test::sourceDirectory();
    for (auto entry = fs::recursive_directory_iterator(root); entry != fs::recursive_directory_iterator();
         ++entry) {
      const std::string name = entry->path().filename().string();
      if (entry->is_directory() && (name == ".git" || name == "build" || startsWith(name, "build-") ||
                                    name == "out" || name == ".cache")) {
        entry.disable_recursion_pending();
        continue;
      }
      if (entry->is_regular_file() && !endsWith(name, ".swp")) result.push_back(entry->path());
    }
    std::sort(result.begin(), result.end());
    return result;
  }();
  return files;
}

std::string relativePath(const fs::path& file) {
  return fs::relative(file, lumivox::test::sourceDirectory()).generic_string();
}

bool isText(const fs::path& file) {
  static const std::set<std::string> extensions = {".cpp",  ".h",     ".txt",      ".cmake", ".sh",   ".md",
                                                   ".json", ".scene", ".pipeline", ".glsl",  ".vert", ".geom",
                                                   ".frag", ".comp",  ".supp",     ".bib",   ""};
  return extensions.count(file.extension().string()) != 0;
}

const Sources& projectSources() {
  static const Sources sources = [] {
    Sources result;
    for (const fs::path& file : projectFiles()) {
      if (!isText(file)) continue;
      std::ifstream stream(file, std::ios::binary);
      result.push_back({relativePath(file), std::string(std::istreambuf_iterator<char>(stream), {})});
    }
    return result;
  }();
  return sources;
}

std::vector<std::string> projectTechniques() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(lumivox::test::sourceDirectory() / "techniques"))
    if (entry.is_directory()) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Kinds of ports of the framework and of all techniques, with members that readers must heed: those that
/// concern every reader, or all.
std::vector<HeededKind> heededKinds(bool everyReader) {
  std::vector<HeededKind> result;
  std::set<std::string> known;
  const auto add = [&](const lumivox::PortKind& kind) {
    if (!known.insert(kind.name).second) return;
    HeededKind heeded{kind.name, {}};
    for (const lumivox::PortCondition& condition : kind.conditions)
      if (!everyReader || condition.readers.empty()) heeded.members.insert(condition.member);
    if (!heeded.members.empty()) result.push_back(heeded);
  };
  for (const lumivox::PortKind* kind : lumivox::FrameworkPorts::kinds()) add(*kind);
  for (const std::string& name : projectTechniques()) {
    const lumivox::Technique* technique = lumivox::test::techniques().technique(name);
    REQUIRE(technique != nullptr);
    for (const lumivox::PassEntry& entry : technique->passes) {
      const auto pass = entry.make();
      for (const auto* output : pass->outputs()) add(output->kind());
    }
  }
  return result;
}

/// Filters: they average light in the unit of their input, which their output keeps.
const std::set<std::string> kPassedOn{"techniques/voxel_cone_tracing/dense/filter.cpp: radiance",
                                      "techniques/voxel_cone_tracing/dense/filter_directional.cpp: radiance",
                                      "techniques/voxel_cone_tracing/octree/octree_filter.cpp: radiance",
                                      "techniques/voxel_cone_tracing/clipmap/clipmap_filter.cpp: radiance",
                                      "techniques/thesis_cone_tracing/mipmap.cpp: radiance"};

/// Programs whose stages include more than ten files: how many at most.
const std::map<std::string, int> kWidelyIncluding{
    {"shaders/implicit_visibility/light/display_glossy.comp", 13},
    {"shaders/implicit_visibility/light/reflect_glossy.comp", 14},
    {"shaders/virtual_area_lights/gather.comp", 12},
    {"shaders/voxel_cone_tracing/add.comp", 11},
    {"shaders/voxel_cone_tracing/clipmap/clipmap_filter.comp", 11},
    {"shaders/voxel_path_tracing/trace.comp", 12},
    {"shaders/voxel_cone_tracing/cones/bounce.comp", 30},
    {"shaders/voxel_cone_tracing/cones/gather.comp", 20},
    {"shaders/voxel_cone_tracing/views/lens.comp", 19},
    {"shaders/voxel_cone_tracing/cones/soft_shadows.comp", 22},
    {"shaders/voxel_cone_tracing/dense/inject.comp", 19},
    {"shaders/voxel_cone_tracing/dense/lobe_sums.comp", 12},
    {"shaders/voxel_cone_tracing/octree/octree_filter.comp", 12},
    {"shaders/voxel_cone_tracing/dense/resolve.comp", 11},
    {"shaders/voxel_cone_tracing/clipmap/clipmap_resolve.comp", 11},
    {"shaders/voxel_cone_tracing/octree/octree_resolve.comp", 12},
    {"shaders/voxelization/points.comp", 11}};

std::string joined(const Violations& violations) {
  std::string text;
  for (const std::string& violation : violations) text += violation + '\n';
  return text;
}

}  // namespace

#define CHECK_NONE(violations)    \
  do {                            \
    const auto list = violations; \
    INFO(joined(list));           \
    CHECK(list.empty());          \
  } while (false)

TEST_CASE("the scanner looks into code and neither into comments nor, when asked, into strings") {
  CHECK(withoutComments("a // b\nc /* d\n e */ f", Strings::keep) == "a     \nc     \n      f");
  CHECK(withoutComments("say(\"// \\\" x\"); y", Strings::blank) == "say(\"       \"); y");
  CHECK(withoutComments("say(\"// x\"); y", Strings::keep) == "say(\"// x\"); y");
  CHECK(withoutComments("c == '\"' // x", Strings::blank) == "c == '\"'     ");
  CHECK(lineOf("a\nb\nc", 4) == 3);
  const auto includes = includesOf("// #include \"no.h\"\n#include \"yes.h\"\n  # include <also/yes.h>\n");
  REQUIRE(includes.size() == 2);
  CHECK(includes[0].path == "yes.h");
  CHECK(includes[0].line == 2);
  CHECK(includes[1].path == "also/yes.h");
}

TEST_CASE("the scanner finds what breaks the rules of the house") {
  /// How much a rule finds in one file.
  const auto in = [](const char* path, const std::string& text, const auto& rule, const auto&... more) {
    return rule(Sources{{path, text}}, more...).size();
  };
  const auto include = [](const std::string& header) { return "#include \"" + header + "\"\n"; };
  const auto order = [&](const char* path, const std::string& text) {
    return in(path, text, brokenIncludeOrder);
  };
  CHECK(order("framework/src/base/a.cpp", include("lumivox/dsl/document.h")) == 1);
  CHECK(order("framework/include/lumivox/scene/a.h", "#include <lumivox/gpu/device.h>\n") == 1);
  CHECK(order("framework/src/dsl/a.cpp", include("page/data.h")) == 1);  // private headers too
  CHECK(order("framework/src/attic/a.cpp", "") == 1);
  CHECK(order("framework/src/page/a.cpp", "") == 1);
  CHECK(order("laboratory/src/gpu/a.cpp", "") == 1);
  CHECK(order("framework/src/pipeline/a.cpp", include("lumivox/results/runs.h")) == 1);
  CHECK(order("laboratory/src/page/a.cpp", include("base/crc.h")) == 1);
  CHECK(order("laboratory/src/page/a.cpp", include("base/file_set.h") + include("lumivox/base/log.h")) == 0);
  CHECK(order("framework/src/scene/a.cpp",
              include("lumivox/base/log.h") + include("scene/b.h") + "#include <vector>\n") == 0);
  CHECK(brokenBuildOrder("lumivox_part(framework/base NEEDS report)\n").size() == 1);
  CHECK(brokenBuildOrder("lumivox_part(framework/scene     NEEDS base dsl LIBRARIES x)\n").empty());

  const std::string gl = "#include <epoxy/gl.h>\n", vdb = "#include <openvdb/openvdb.h>\n",
                    sqlite = "#include <sqlite3.h>\n";
  CHECK(in("laboratory/src/page/a.cpp", gl, escaped, kOpenGl) == 1);
  CHECK(in("techniques/x/a.cpp", "void f() { glFinish(); int a = GL_RGBA8; }", escaped, kOpenGl) == 2);
  CHECK(in("framework/src/gpu/a.cpp", gl + "glFinish();", escaped, kOpenGl) == 0);
  CHECK(in("tools/a.cpp", "glm::vec3 a; // glFinish()\nsay(\"glFinish()\"); glslangLike();", escaped,
           kOpenGl) == 0);
  CHECK(in("tools/a.cpp", "rtcNewDevice(nullptr);", escaped, kEmbree) == 1);
  CHECK(in("framework/src/scene/a.cpp", vdb, escaped, kOpenVdb) == 1);
  CHECK(in("framework/src/volume/a.cpp", vdb, escaped, kOpenVdb) == 0);
  CHECK(in("bench/x/a.cpp", vdb, escaped, kOpenVdb) == 0);
  CHECK(in("laboratory/src/page/a.cpp", sqlite + "sqlite3_open(f, &h);", escaped, kSqlite) == 2);
  CHECK(in("laboratory/src/results/a.cpp", sqlite, escaped, kSqlite) == 0);
  CHECK(in("laboratory/src/page/a.cpp", "html += \"<td class=\\\"x\\\">\";\n", markup) == 1);
  CHECK(in("laboratory/src/page/a.cpp", "#include <span>\nstd::span<int> p; a = b < c; // \"<td>\"\n",
           markup) == 0);
  CHECK(in("tests/a.cpp", "CHECK(html == \"<p>\");\n", markup) == 0);
  CHECK(in("laboratory/src/analysis/a.cpp", include("lumivox/results/store.h"), boundAnalysis) == 1);
  CHECK(in("laboratory/src/analysis/a.cpp", include("lumivox/results/runs.h"), boundAnalysis) == 0);

  const std::vector<std::string> two = {"cone_tracing", "shading"}, ambient = {"ambient"};
  const auto named = [&](const std::string& text, const std::vector<std::string>& techniques) {
    return in("framework/src/pipeline/a.cpp", text, namedTechniques, techniques);
  };
  CHECK(named("open(\"cone_tracing\");", two) == 1);
  CHECK(named("ConeTracing t;", two) == 1);
  CHECK(named("// as in cone_tracing\nint cone_tracings;", two) == 0);
  // The technique that the guide writes has a name that is a word.
  CHECK(named("open(\"ambient.gather\"); ambient::Gather g;", ambient) == 2);
  CHECK(named("say(\"the ambient occlusion\"); float ambient = 0;", ambient) == 0);
  const auto dependent = [&](const char* path, const std::string& text) {
    return in(path, text, dependentTechniques, two);
  };
  CHECK(dependent("techniques/shading/a.cpp", include("cone_tracing_shaders.h")) == 1);
  CHECK(dependent("techniques/shading/a.cpp", include("../cone_tracing/b.h")) == 1);
  CHECK(dependent("shaders/shading/a.comp", include("cone_tracing/b.glsl")) == 1);
  CHECK(dependent("shaders/toolkit/a.comp", include("cone_tracing/b.glsl")) == 1);
  CHECK(dependent("techniques/shading/a.cpp", include("lumivox/experiment/report.h")) == 1);
  CHECK(dependent("techniques/shading/a.cpp",
                  include("shading_shaders.h") + include("lumivox/pipeline/pass.h")) == 0);
  CHECK(dependent("shaders/shading/a.comp", include("common/brdf.glsl") + include("toolkit/slots.glsl")) ==
        0);

  const std::set<std::string> whole = {"techniques/shading/CMakeLists.txt",
                                       "techniques/shading/shading.cpp",
                                       "techniques/shading/README.md",
                                       "tests/techniques/shading_test.cpp",
                                       "shaders/shading/a.comp",
                                       "shaders/common/b.glsl",
                                       "shaders/toolkit/c.comp"};
  const Sources uses = {{"scenes/pipelines/shading.pipeline", "pass shade shading.shade { }"}};
  CHECK(brokenNames(whole, {"shading"}, uses).empty());
  CHECK(brokenNames(whole, {"shading"}, {}).size() == 1);
  CHECK(brokenNames({"shaders/other/a.comp"}, {}, {}).size() == 1);
  CHECK(brokenNames({"shaders/README.md"}, {}, {}).empty());
  CHECK(brokenNames(whole, {"shading"}, {uses[0], {"scenes/pipelines/odd.pipeline", ""}}).size() == 1);
  const auto voxelizer = [&](const char* name) {
    return brokenNames(
        whole, {"shading"},
        {uses[0], {std::string("scenes/pipelines/voxelizers/") + name, "pass a shading.points { }"}});
  };
  CHECK(voxelizer("points.pipeline").empty());
  CHECK(voxelizer("points_twice.pipeline").empty());
  CHECK(voxelizer("shading.pipeline").size() == 1);
  for (const char* file : {"techniques/shading/README.md", "tests/techniques/shading_test.cpp",
                           "techniques/shading/shading.cpp"}) {
    std::set<std::string> lacking = whole;
    lacking.erase(file);
    CHECK(brokenNames(lacking, {"shading"}, uses).size() == 1);
  }

  const auto sized = [](int files, int lines, const std::map<std::string, FolderSize>& exceptions = {}) {
    Sources sources{{"techniques/shading/README.md", std::string(5000, '\n')},
                    {"techniques/shading/part/b.cpp", std::string(1300, '\n')}};
    for (int file = 0; file < files; ++file)
      sources.push_back(
          {fmt::format("techniques/shading/a{}.h", file), std::string(file == 0 ? lines : 0, '\n')});
    return largeFolders(sources, exceptions);
  };
  CHECK_NONE(sized(12, 1300));
  CHECK(sized(13, 0) ==
        Violations{"techniques/shading: 13 C++ files of 0 lines; expected at most 12 of 1300"});
  CHECK(sized(1, 1301).size() == 1);
  CHECK_NONE(sized(13, 1300, {{"techniques/shading", {13, 900}}}));
  CHECK(sized(14, 0, {{"techniques/shading", {13, 900}}}).size() == 1);
  CHECK(sized(12, 0, {{"techniques/shading", {13, 900}}}).size() == 1);
  const auto including = [](int files, const std::map<std::string, int>& exceptions = {}) {
    // Of which one is found in the folder of all shaders, and each but the last includes the next one.
    Sources sources{{"shaders/shading/part/a.comp", "#include \"../b1.glsl\"\n#include \"common/c.glsl\"\n"},
                    {"shaders/common/c.glsl", "#include \"c.glsl\"\n"}};
    for (int file = 1; file < files; ++file)
      sources.push_back(
          {fmt::format("shaders/shading/b{}.glsl", file), fmt::format("#include \"b{}.glsl\"\n", file + 1)});
    return widelyIncluding(sources, exceptions);
  };
  CHECK_NONE(including(10));
  CHECK(including(11) == Violations{"shaders/shading/part/a.comp: includes 11 files; expected at most 10"});
  CHECK_NONE(including(11, {{"shaders/shading/part/a.comp", 11}}));
  CHECK(including(12, {{"shaders/shading/part/a.comp", 11}}).size() == 1);
  CHECK(including(10, {{"shaders/shading/part/a.comp", 11}}).size() == 1);

  CHECK(unfinished({{"a.cpp", std::string("// TO") + "DO: later\n"}}).size() == 1);
  CHECK(unfinished({{"a.cpp", "// to do\n"}}).empty());
  CHECK(namespacesUsedInHeaders({{"a.h", "using namespace std;\n"}, {"a.cpp", "using namespace std;\n"}})
            .size() == 1);
}

TEST_CASE("the scanner finds inputs that are read without a look at what tells how to read them") {
  const std::vector<HeededKind> kinds{{"Light", {"unit", "readFor"}}};
  const SourceFile toolkit{"framework/src/toolkit/light.cpp",
                           "Levels readLight(const In<Light>& input, int how) {\n"
                           "  if (input->unit != 1 || !input->readFor.empty()) throw Error(\"\");\n}\n"};
  // Another class of the file has an input of the same name, and looks at all of it.
  const auto found = [&](const std::string& run, const std::string& more = "",
                         const std::set<std::string>& passedOn = {}) {
    return unheededMembers(
        {{"techniques/glow/glow.cpp",
          "class GlowPass : public Pass {\n  In<Light> light{this, \"light\"};\n  void run() { " + run +
              " }\n};\nclass Other { void run() { light->unit; light->readFor; } };\n" + more},
         toolkit},
        kinds, passedOn);
  };
  CHECK(found("use(light->levels);") ==
        Violations{"techniques/glow/glow.cpp:2: input light never looks at 'readFor' of its Light",
                   "techniques/glow/glow.cpp:2: input light never looks at 'unit' of its Light"});
  CHECK(found("use(light->levels, light->unit);").size() == 1);
  CHECK(found("/* light->readFor */ say(\"light->readFor\"); use(light->unit);").size() == 1);
  CHECK(found("use(dark->unit, light->units, light->readFor);").size() == 1);
  CHECK_NONE(found("use(light->unit); check(light->readFor);"));
  CHECK_NONE(found("use(readLight(light, 3));"));
  CHECK(found("use(readLight(dark, 3));").size() == 2);
  CHECK_NONE(found("const Light mine = *light; use(mine.unit, mine.readFor);"));
  // Functions of the technique, one behind another; a declaration alone looks at nothing.
  const std::string own = "float first(const Light& a, int b) { return second(b, a); }\n";
  CHECK_NONE(
      found("first(*light, 1);", own + "float second(int b, const Light& c) { return c.unit + c.readFor; }"));
  CHECK(found("first(*light, 1);", own + "float second(int b, const Light& c);").size() == 2);
  // A derived class reads the input of its base; members in a header are used in a source.
  CHECK_NONE(found("", "class Brighter : public GlowPass { void add() { readLight(light, 1); } };"));
  const SourceFile header{"techniques/glow/glow.h", "class Glow {\n  In<Light> light_;\n};\n"};
  CHECK(unheededMembers({header, {"techniques/glow/glow.cpp", "use(light_->unit);"}}, kinds, {}).size() == 1);
  CHECK_NONE(
      unheededMembers({header, {"techniques/glow/glow.cpp", "readLight(light_, 1);"}, toolkit}, kinds, {}));
  // In a chapter, with a function of another one.
  const SourceFile chapter{"techniques/glow/part/dim.cpp",
                           "class Dim : public Pass {\n  In<Light> light{this, \"light\"};\n"
                           "  void run() { first(light); }\n};\n"};
  CHECK(unheededMembers({chapter}, kinds, {}).size() == 2);
  CHECK_NONE(unheededMembers(
      {chapter, {"techniques/glow/more/a.cpp", "float first(const Light& a) { return a.unit + a.readFor; }"}},
      kinds, {}));
  // Exceptions, each of which must be needed.
  const std::set<std::string> exception{"techniques/glow/glow.cpp: light"};
  CHECK_NONE(found("use(light->levels);", "", exception));
  CHECK(found("readLight(light, 1);", "", exception).size() == 1);

  CHECK_NONE(unknownMembers({{"a.h", "struct Light { float unit = 1.0f; std::string readFor; };"}}, kinds));
  CHECK(unknownMembers({{"a.h", "struct Light { float units = 1.0f; /* unit = */ std::string readFor; };"}},
                       kinds)
            .size() == 1);
}

TEST_CASE(
    "parts include each other only in the order of the house, and the framework nothing of the laboratory") {
  CHECK_NONE(brokenIncludeOrder(projectSources()));
  for (const SourceFile& source : projectSources())
    if (source.path == "CMakeLists.txt") CHECK_NONE(brokenBuildOrder(source.text));
}

TEST_CASE("OpenGL stays in the gpu part, Embree in the reference and OpenVDB in its exporter and reader") {
  CHECK_NONE(escaped(projectSources(), kOpenGl));
  CHECK_NONE(escaped(projectSources(), kEmbree));
  CHECK_NONE(escaped(projectSources(), kOpenVdb));
}

TEST_CASE("SQLite stays in the results, markup in the assets of pages, and analysis knows neither") {
  CHECK_NONE(escaped(projectSources(), kSqlite));
  CHECK_NONE(markup(projectSources()));
  CHECK_NONE(boundAnalysis(projectSources()));
}

TEST_CASE("the framework names no technique and no technique includes another") {
  REQUIRE_FALSE(projectTechniques().empty());
  CHECK_NONE(namedTechniques(projectSources(), projectTechniques()));
  CHECK_NONE(namedTechniques(projectSources(), {"ambient"}));  // which a reader of the guide adds
  CHECK_NONE(dependentTechniques(projectSources(), projectTechniques()));
}

TEST_CASE("a folder of a technique is read in one sitting, and so is what a shader includes") {
  CHECK_NONE(largeFolders(projectSources(), {}));
  CHECK_NONE(widelyIncluding(projectSources(), kWidelyIncluding));
}

TEST_CASE("the switch as_published is the framework's: no pass declares one of its own") {
  for (const SourceFile& source : projectSources())
    if (startsWith(source.path, "techniques/")) {
      INFO(source.path);
      CHECK(source.text.find("\"as_published\"") == std::string::npos);
    }
}

TEST_CASE("no pass reads a kind of port without a look at the members that tell every reader how") {
  const std::vector<HeededKind> kinds = heededKinds(true);
  REQUIRE(kinds.size() >= 5);
  CHECK_NONE(unheededMembers(projectSources(), kinds, kPassedOn));
  CHECK_NONE(unknownMembers(projectSources(), heededKinds(false)));
}

TEST_CASE("a technique has one name everywhere: its folder, source, shaders, test, paper card and pipeline") {
  std::set<std::string> files;
  for (const fs::path& file : projectFiles()) files.insert(relativePath(file));
  Sources pipelines;
  for (const SourceFile& source : projectSources())
    if (startsWith(source.path, "scenes/pipelines/") && endsWith(source.path, ".pipeline"))
      pipelines.push_back(source);
  CHECK_NONE(brokenNames(files, projectTechniques(), pipelines));
}

TEST_CASE(
    "nothing in the tree is larger than a mebibyte, marked as unfinished, or a header that opens a namespace "
    "for others") {
  for (const fs::path& file : projectFiles()) {
    INFO(relativePath(file));
    CHECK(fs::file_size(file) <= kLargestFile);
  }
  CHECK_NONE(unfinished(projectSources()));
  CHECK_NONE(namespacesUsedInHeaders(projectSources()));
}
