// The rules of the house: who may include whom, what may be named where, one name everywhere. The scanner
// itself is tested first, on bad examples, so that a rule cannot hold by never firing.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/support.h"

namespace {

namespace fs = std::filesystem;

struct SourceFile {
  std::string path;  ///< relative to the project, with forward slashes
  std::string text;
};
using Sources = std::vector<SourceFile>;
using Violations = std::vector<std::string>;

bool startsWith(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}
bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}
bool isCpp(const std::string& path) {
  return endsWith(path, ".cpp") || endsWith(path, ".h");
}

/// Blanks comments, and string literals too when asked; keeps lines, so that line numbers stay right.
enum class Strings { keep, blank };
std::string withoutComments(const std::string& text, Strings strings) {
  std::string result = text;
  enum class In { code, line, block, string } in = In::code;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i], next = i + 1 < text.size() ? text[i + 1] : '\0';
    if (in == In::code && c == '/' && next == '/') in = In::line;
    if (in == In::code && c == '/' && next == '*') in = In::block;
    if (in == In::code && c == '\'' &&
        (text.compare(i, 3, "'\"'") == 0 || text.compare(i, 4, "'\\\"'") == 0)) {
      i = text.find('"', i);  // a quotation mark as a character starts no string
      continue;
    }
    if (in == In::code && c == '"') {
      in = In::string;
      continue;
    }
    if (c == '\n') {
      if (in == In::line || in == In::string) in = In::code;
      continue;
    }
    if (in == In::string && c == '"') {
      in = In::code;
      continue;
    }
    const bool escaped = in == In::string && c == '\\';
    if (in == In::line || in == In::block || (in == In::string && strings == Strings::blank)) result[i] = ' ';
    if (in == In::block && c == '*' && next == '/') {
      result[++i] = ' ';
      in = In::code;
    }
    if (escaped && next != '\n') {
      ++i;
      if (strings == Strings::blank) result[i] = ' ';
    }
  }
  return result;
}

int lineOf(const std::string& text, std::size_t position) {
  return 1 + static_cast<int>(
                 std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(position), '\n'));
}

/// Calls `found(line, match)` for every match.
template <class Found>
void forEachMatch(const std::string& text, const std::regex& pattern, Found&& found) {
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match)
    found(lineOf(text, static_cast<std::size_t>(match->position())), *match);
}

struct Include {
  int line;
  std::string path;
};
std::vector<Include> includesOf(const std::string& text) {
  static const std::regex pattern("^[ \\t]*#[ \\t]*include[ \\t]*[<\"]([^>\"]+)[>\"]",
                                  std::regex::ECMAScript | std::regex::multiline);
  std::vector<Include> includes;
  forEachMatch(withoutComments(text, Strings::keep), pattern, [&](int line, const std::smatch& match) {
    includes.push_back({line, match[1]});
  });
  return includes;
}

// ---- the order of the parts
// ------------------------------------------------------------------------------------------------------

/// For each part of the framework those that it may include: base <- dsl <- scene; base <- gpu <- shader;
/// those <- pipeline <- toolkit, plugin; scene <- reference; base <- measure; those <- results <- analysis,
/// roofline; analysis <- page; all but page <- experiment; all <- stress.
const std::map<std::string, std::set<std::string>>& houseOrder() {
  static const std::map<std::string, std::set<std::string>> order = {
      {"base", {}},
      {"dsl", {"base"}},
      {"scene", {"base", "dsl"}},
      {"gpu", {"base"}},
      {"shader", {"base", "gpu"}},
      {"pipeline", {"base", "dsl", "scene", "gpu", "shader"}},
      {"toolkit", {"base", "dsl", "scene", "gpu", "shader", "pipeline"}},
      {"plugin", {"base", "dsl", "scene", "gpu", "shader", "pipeline"}},
      {"volume", {"base", "scene"}},
      {"reference", {"base", "dsl", "scene"}},
      {"measure", {"base", "dsl", "scene"}},
      // Records hold what a device calls itself and the parameters of a pipeline.
      {"results", {"base", "dsl", "scene", "gpu", "shader", "pipeline", "plugin", "measure"}},
      {"analysis", {"base", "measure", "results"}},
      {"roofline", {"base", "gpu", "shader", "measure", "results"}},
      {"experiment",
       {"base", "dsl", "scene", "gpu", "shader", "pipeline", "toolkit", "plugin", "reference", "measure",
        "results", "analysis", "roofline"}},
      {"page", {"base", "measure", "results", "analysis"}},
      {"stress",
       {"base", "dsl", "scene", "gpu", "shader", "pipeline", "toolkit", "plugin", "reference", "measure",
        "results", "experiment", "page"}}};
  return order;
}

/// "gpu" for framework/src/gpu/x.cpp and framework/include/lumivox/gpu/x.h; empty outside the framework.
std::string partOf(const std::string& path) {
  static const std::regex pattern("framework/(?:src|include/lumivox)/([a-z]+)/.*");
  std::smatch match;
  return std::regex_match(path, match, pattern) ? match[1].str() : "";
}

Violations brokenIncludeOrder(const Sources& sources) {
  Violations found;
  for (const SourceFile& source : sources) {
    const std::string part = partOf(source.path);
    if (part.empty()) continue;
    const auto allowed = houseOrder().find(part);
    if (allowed == houseOrder().end()) {
      found.push_back(source.path + ": the house has no part '" + part + "'");
      continue;
    }
    for (const Include& include : includesOf(source.text)) {
      std::string path = include.path;
      if (startsWith(path, "lumivox/")) path = path.substr(8);
      const std::string other = path.substr(0, path.find('/'));
      if (path.find('/') == std::string::npos || houseOrder().count(other) == 0 || other == part) continue;
      if (allowed->second.count(other) == 0)
        found.push_back(fmt::format("{}:{}: {} may not include {}", source.path, include.line, part, other));
    }
  }
  return found;
}

/// The build says the same: lumivox_part(NAME NEEDS parts...).
Violations brokenBuildOrder(const std::string& listFile) {
  Violations found;
  static const std::regex pattern("lumivox_part\\((\\w+)\\s+NEEDS ([a-z ]+)");
  forEachMatch(listFile, pattern, [&](int line, const std::smatch& match) {
    const auto allowed = houseOrder().find(match[1]);
    std::istringstream needs(match[2]);
    for (std::string need; needs >> need;)
      if (allowed == houseOrder().end() || allowed->second.count(need) == 0)
        found.push_back(fmt::format("CMakeLists.txt:{}: {} may not need {}", line, match[1].str(), need));
  });
  return found;
}

// ---- libraries that have one home
// -------------------------------------------------------------------------------------------------

struct Confined {
  const char* what;
  const char* pattern;
  std::vector<std::string> homes;  ///< path prefixes
};

Violations escaped(const Sources& sources, const Confined& rule) {
  Violations found;
  const std::regex pattern(rule.pattern);
  for (const SourceFile& source : sources) {
    if (!isCpp(source.path)) continue;
    if (std::any_of(rule.homes.begin(), rule.homes.end(),
                    [&](const std::string& home) { return startsWith(source.path, home); }))
      continue;
    // Include paths look like strings, so they are looked at apart.
    for (const Include& include : includesOf(source.text))
      if (std::regex_search("<" + include.path, pattern))
        found.push_back(
            fmt::format("{}:{}: {} outside {}", source.path, include.line, rule.what, rule.homes.front()));
    forEachMatch(withoutComments(source.text, Strings::blank), pattern,
                 [&](int line, const std::smatch& match) {
                   if (match.str()[0] != '<')
                     found.push_back(fmt::format("{}:{}: {} ('{}') outside {}", source.path, line, rule.what,
                                                 match.str(), rule.homes.front()));
                 });
  }
  return found;
}

const Confined kOpenGl{
    "OpenGL",
    "<(epoxy|GL|EGL|GLES\\d?|GLFW|KHR)/|\\b(gl|egl|glX)[A-Z]\\w*\\s*\\(|\\b(GL|EGL)_[A-Z]\\w+",
    {"framework/src/gpu/", "tools/viewer/"}};
const Confined kEmbree{
    "Embree", "<embree|\\brtc[A-Z]\\w*\\s*\\(|\\bRTC[A-Z]\\w+", {"framework/src/reference/"}};
const Confined kOpenVdb{"OpenVDB",
                        "<openvdb|\\bopenvdb::",
                        {"tools/vdbexport/", "framework/src/volume/", "tests/framework/scene_media_test.cpp",
                         "tests/tools/vdbexport_", "bench/"}};  // speed programs compare with it

const Confined kSqlite{
    "SQLite", "<sqlite3|\\bsqlite3_\\w+", {"framework/src/results/", "tests/framework/results_"}};

/// Pages are built from the files of framework/src/page/assets; no C++ writes markup.
Violations markup(const Sources& sources) {
  Violations found;
  static const std::regex pattern(
      "</?(html|head|body|div|span|table|t[dhr]|p|h[1-6]|ul|li|img|canvas|style)[ >]");
  for (const SourceFile& source : sources) {
    if (!isCpp(source.path) || (!startsWith(source.path, "framework/") && !startsWith(source.path, "tools/")))
      continue;
    std::istringstream lines(withoutComments(source.text, Strings::keep));
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      if (line.rfind("#include", 0) != 0 && line.find('"') != std::string::npos &&
          std::regex_search(line, pattern))
        found.push_back(fmt::format("{}:{}: markup in C++", source.path, number));
    }
  }
  return found;
}

/// Analysis works on records alone: no device, no store, no page.
Violations boundAnalysis(const Sources& sources) {
  Violations found;
  for (const SourceFile& source : sources) {
    if (partOf(source.path) != "analysis") continue;
    for (const Include& include : includesOf(source.text))
      if (endsWith(include.path, "results/store.h") || endsWith(include.path, "results/database.h"))
        found.push_back(
            fmt::format("{}:{}: analysis may not include {}", source.path, include.line, include.path));
  }
  return found;
}

// ---- techniques
// --------------------------------------------------------------------------------------------------------------------

std::string pascalCase(const std::string& name) {
  std::string result;
  bool upper = true;
  for (const char c : name) {
    if (c != '_') result += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    upper = c == '_';
  }
  return result;
}

/// The framework and the laboratory's tests of it know techniques only by what a text or a folder names.
Violations namedTechniques(const Sources& sources, const std::vector<std::string>& techniques) {
  Violations found;
  for (const SourceFile& source : sources) {
    if (!startsWith(source.path, "framework/") || !isCpp(source.path)) continue;
    const std::string code = withoutComments(source.text, Strings::keep);  // a comment may give an example
    for (const std::string& technique : techniques)
      forEachMatch(
          code, std::regex("\\b(" + technique + "|" + pascalCase(technique) + ")\\b"),
          [&](int line, const std::smatch& match) {
            found.push_back(fmt::format("{}:{}: names the technique '{}'", source.path, line, match.str()));
          });
  }
  return found;
}

/// A technique includes the framework, its own files and its generated shader interface; a shader includes
/// its folder and common.
Violations dependentTechniques(const Sources& sources, const std::vector<std::string>& techniques) {
  Violations found;
  static const std::set<std::string> closedParts = {"reference", "measure",    "results", "analysis",
                                                    "roofline",  "experiment", "page",    "stress"};
  for (const SourceFile& source : sources) {
    const bool shader = startsWith(source.path, "shaders/");
    if (!shader && !startsWith(source.path, "techniques/")) continue;
    const std::size_t first = source.path.find('/') + 1;
    const std::string owner = source.path.substr(first, source.path.find('/', first) - first);
    for (const Include& include : includesOf(source.text)) {
      const std::string folder = include.path.substr(0, include.path.find('/'));
      const auto isForeign = [&](const std::string& technique) {
        return technique != owner && (folder == technique || include.path == technique + "_shaders.h" ||
                                      include.path.find("/" + technique + "/") != std::string::npos);
      };
      if (std::any_of(techniques.begin(), techniques.end(), isForeign))
        found.push_back(
            fmt::format("{}:{}: includes another technique: {}", source.path, include.line, include.path));
      if (startsWith(include.path, "lumivox/")) {
        const std::string part = include.path.substr(8, include.path.find('/', 8) - 8);
        if (closedParts.count(part) != 0)
          found.push_back(
              fmt::format("{}:{}: a technique may not include {}", source.path, include.line, part));
      }
    }
  }
  return found;
}

constexpr const char* kVoxelizers = "voxelizers";  // scenes/pipelines/voxelizers: what makes voxels alone

constexpr const char* kDeviceShaders =
    "device";  // shaders/device: the framework's own, which time the device

/// One name everywhere. `files` are all paths of the project; pipelines come with their text.
Violations brokenNames(const std::set<std::string>& files, const std::vector<std::string>& techniques,
                       const Sources& pipelines) {
  Violations found;
  for (const std::string& name : techniques) {
    for (const std::string& needed :
         {"techniques/" + name + "/CMakeLists.txt", "techniques/" + name + "/" + name + ".cpp",
          "techniques/" + name + "/README.md", "tests/techniques/" + name + "_test.cpp"})
      if (files.count(needed) == 0) found.push_back(name + ": there is no " + needed);
    // A library of passes needs no pipeline of its own name, but a technique that no pipeline uses is never
    // measured.
    const std::regex use("\\bpass\\s+\\w+\\s+" + name + "\\.");
    if (std::none_of(pipelines.begin(), pipelines.end(),
                     [&](const SourceFile& p) { return std::regex_search(p.text, use); }))
      found.push_back(name + ": no pipeline in scenes/pipelines uses it");
  }
  for (const SourceFile& pipeline : pipelines) {
    const std::string stem = fs::path(pipeline.path).stem().string();
    if (fs::path(pipeline.path).parent_path().filename() == kVoxelizers) {
      // Named by the pass that makes the voxels, behind which others may stand.
      std::string pass;
      forEachMatch(pipeline.text, std::regex("\\bpass\\s+\\w+\\s+\\w+\\.(\\w+)"),
                   [&](int, const std::smatch& match) {
                     if (startsWith(stem, match[1])) pass = match[1];
                   });
      if (pass.empty()) found.push_back(pipeline.path + ": its name starts with the name of no pass in it");
      continue;
    }
    if (std::none_of(techniques.begin(), techniques.end(),
                     [&](const std::string& name) { return startsWith(stem, name); }))
      found.push_back(pipeline.path + ": its name starts with the name of no technique");
  }
  for (const std::string& file : files) {
    if (!startsWith(file, "shaders/")) continue;
    const std::string folder = file.substr(8, file.find('/', 8) - 8);
    if (folder != "common" && folder != kDeviceShaders &&
        std::find(techniques.begin(), techniques.end(), folder) == techniques.end())
      found.push_back(file + ": there is no technique '" + folder + "'");
  }
  return found;
}

// ---- everything else
// ----------------------------------------------------------------------------------------------------------------

Violations unfinished(const Sources& sources) {
  Violations found;
  const std::regex pattern(std::string("\\b(TO") + "DO|FIX" + "ME|XX" +
                           "X)\\b");  // in pieces, or this file would break its own rule
  for (const SourceFile& source : sources)
    forEachMatch(source.text, pattern, [&](int line, const std::smatch& match) {
      found.push_back(fmt::format("{}:{}: {}", source.path, line, match.str()));
    });
  return found;
}

Violations namespacesUsedInHeaders(const Sources& sources) {
  Violations found;
  static const std::regex pattern("\\busing\\s+namespace\\b");
  for (const SourceFile& source : sources)
    if (endsWith(source.path, ".h"))
      forEachMatch(withoutComments(source.text, Strings::blank), pattern, [&](int line, const std::smatch&) {
        found.push_back(fmt::format("{}:{}: using namespace in a header", source.path, line));
      });
  return found;
}

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
  CHECK(brokenIncludeOrder({{"framework/src/base/a.cpp", "#include \"lumivox/dsl/document.h\"\n"}}).size() ==
        1);
  CHECK(brokenIncludeOrder({{"framework/include/lumivox/scene/a.h", "#include <lumivox/gpu/device.h>\n"}})
            .size() == 1);
  CHECK(brokenIncludeOrder({{"framework/src/dsl/a.cpp", "#include \"page/data.h\"\n"}}).size() ==
        1);  // private headers too
  CHECK(brokenIncludeOrder({{"framework/src/attic/a.cpp", ""}}).size() == 1);
  CHECK(brokenIncludeOrder({{"framework/src/scene/a.cpp",
                             "#include \"lumivox/base/log.h\"\n#include \"scene/b.h\"\n#include <vector>\n"}})
            .empty());
  CHECK(brokenBuildOrder("lumivox_part(base NEEDS report)\n").size() == 1);
  CHECK(brokenBuildOrder("lumivox_part(scene     NEEDS base dsl LIBRARIES x)\n").empty());

  CHECK(escaped({{"framework/src/page/a.cpp", "#include <epoxy/gl.h>\n"}}, kOpenGl).size() == 1);
  CHECK(escaped({{"techniques/x/a.cpp", "void f() { glFinish(); int a = GL_RGBA8; }"}}, kOpenGl).size() == 2);
  CHECK(escaped({{"framework/src/gpu/a.cpp", "#include <epoxy/gl.h>\nglFinish();"}}, kOpenGl).empty());
  CHECK(escaped({{"tools/a.cpp", "glm::vec3 a; // glFinish()\nsay(\"glFinish()\"); glslangLike();"}}, kOpenGl)
            .empty());
  CHECK(escaped({{"tools/a.cpp", "rtcNewDevice(nullptr);"}}, kEmbree).size() == 1);
  CHECK(escaped({{"framework/src/scene/a.cpp", "#include <openvdb/openvdb.h>\n"}}, kOpenVdb).size() == 1);
  CHECK(escaped({{"framework/src/volume/a.cpp", "#include <openvdb/openvdb.h>\n"}}, kOpenVdb).empty());
  CHECK(escaped({{"bench/x/a.cpp", "#include <openvdb/openvdb.h>\n"}}, kOpenVdb).empty());

  CHECK(
      escaped({{"framework/src/page/a.cpp", "#include <sqlite3.h>\nsqlite3_open(f, &h);"}}, kSqlite).size() ==
      2);
  CHECK(escaped({{"framework/src/results/a.cpp", "#include <sqlite3.h>\n"}}, kSqlite).empty());
  CHECK(markup({{"framework/src/page/a.cpp", "html += \"<td class=\\\"x\\\">\";\n"}}).size() == 1);
  CHECK(markup({{"framework/src/page/a.cpp", "#include <span>\nstd::span<int> p; a = b < c; // \"<td>\"\n"}})
            .empty());
  CHECK(markup({{"tests/a.cpp", "CHECK(html == \"<p>\");\n"}}).empty());
  CHECK(boundAnalysis({{"framework/src/analysis/a.cpp", "#include \"lumivox/results/store.h\"\n"}}).size() ==
        1);
  CHECK(boundAnalysis({{"framework/src/analysis/a.cpp", "#include \"lumivox/results/runs.h\"\n"}}).empty());

  const std::vector<std::string> two = {"cone_tracing", "shading"};
  CHECK(namedTechniques({{"framework/src/pipeline/a.cpp", "open(\"cone_tracing\");"}}, two).size() == 1);
  CHECK(namedTechniques({{"framework/src/pipeline/a.cpp", "ConeTracing t;"}}, two).size() == 1);
  CHECK(namedTechniques({{"framework/src/pipeline/a.cpp", "// as in cone_tracing\nint cone_tracings;"}}, two)
            .empty());
  CHECK(dependentTechniques({{"techniques/shading/a.cpp", "#include \"cone_tracing_shaders.h\"\n"}}, two)
            .size() == 1);
  CHECK(
      dependentTechniques({{"techniques/shading/a.cpp", "#include \"../cone_tracing/b.h\"\n"}}, two).size() ==
      1);
  CHECK(dependentTechniques({{"shaders/shading/a.comp", "#include \"cone_tracing/b.glsl\"\n"}}, two).size() ==
        1);
  CHECK(dependentTechniques({{"techniques/shading/a.cpp", "#include \"lumivox/experiment/report.h\"\n"}}, two)
            .size() == 1);
  CHECK(dependentTechniques({{"techniques/shading/a.cpp",
                              "#include \"shading_shaders.h\"\n#include \"lumivox/pipeline/pass.h\"\n"},
                             {"shaders/shading/a.comp", "#include \"common/brdf.glsl\"\n"}},
                            two)
            .empty());

  const std::set<std::string> whole = {
      "techniques/shading/CMakeLists.txt", "techniques/shading/shading.cpp", "techniques/shading/README.md",
      "tests/techniques/shading_test.cpp", "shaders/shading/a.comp",         "shaders/common/b.glsl"};
  const Sources uses = {{"scenes/pipelines/shading.pipeline", "pass shade shading.shade { }"}};
  CHECK(brokenNames(whole, {"shading"}, uses).empty());
  CHECK(brokenNames(whole, {"shading"}, {}).size() == 1);
  CHECK(brokenNames({"shaders/other/a.comp"}, {}, {}).size() == 1);
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

  CHECK(unfinished({{"a.cpp", std::string("// TO") + "DO: later\n"}}).size() == 1);
  CHECK(unfinished({{"a.cpp", "// to do\n"}}).empty());
  CHECK(namespacesUsedInHeaders({{"a.h", "using namespace std;\n"}, {"a.cpp", "using namespace std;\n"}})
            .size() == 1);
}

TEST_CASE("the parts of the framework include each other only in the order of the house") {
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
  CHECK_NONE(dependentTechniques(projectSources(), projectTechniques()));
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
