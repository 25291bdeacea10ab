#include "tools/house_rules.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <regex>

namespace lumivox::test::house {

bool startsWith(const std::string& text, const std::string& start) {
  return text.rfind(start, 0) == 0;
}
bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}
static bool isCpp(const std::string& path) {
  return endsWith(path, ".cpp") || endsWith(path, ".h");
}

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

/// For each part of both houses those that it may include: base <- dsl <- scene; base <- gpu <- shader;
/// those <- pipeline <- toolkit, plugin; scene <- reference; base <- measure; those <- results <- analysis,
/// roofline; analysis <- page; all but page <- experiment; all <- stress.
static const std::map<std::string, std::set<std::string>>& houseOrder() {
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

/// "gpu" for framework/src/gpu/x.cpp and framework/include/lumivox/gpu/x.h; empty outside both houses.
static std::string partOf(const std::string& path) {
  static const std::regex pattern("(?:framework|laboratory)/(?:src|include/lumivox)/([a-z]+)/.*");
  std::smatch match;
  return std::regex_match(path, match, pattern) ? match[1].str() : "";
}

/// Parts that judge techniques. The rest is the framework, which techniques link.
static const std::set<std::string> kLaboratory{"reference", "measure",    "results", "analysis",
                                               "roofline",  "experiment", "page",    "stress"};
/// What the laboratory sees of the framework's inside.
static const std::set<std::string> kSeenInside{
    "base/child.h",       "base/file_set.h",       "base/memory_limits.h", "base/process.h",
    "dsl/consequences.h", "pipeline/changes.h",    "pipeline/graph.h",     "pipeline/pool.h",
    "pipeline/prune.h",   "pipeline/text_values.h"};

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
    const bool judges = kLaboratory.contains(part);
    if (startsWith(source.path, "laboratory/") != judges)
      found.push_back(
          fmt::format("{}: {} is a part of the {}", source.path, part, judges ? "laboratory" : "framework"));
    for (const Include& include : includesOf(source.text)) {
      std::string path = include.path;
      if (startsWith(path, "lumivox/")) path = path.substr(8);
      const std::string other = path.substr(0, path.find('/'));
      if (path.find('/') == std::string::npos || houseOrder().count(other) == 0 || other == part) continue;
      if (allowed->second.count(other) == 0)
        found.push_back(fmt::format("{}:{}: {} may not include {}", source.path, include.line, part, other));
      else if (judges && !kLaboratory.contains(other) && path == include.path && !kSeenInside.contains(path))
        found.push_back(fmt::format("{}:{}: the laboratory may not include {}, the framework's inside",
                                    source.path, include.line, path));
    }
  }
  return found;
}

/// The build says the same: lumivox_part(HOUSE/NAME NEEDS parts...).
Violations brokenBuildOrder(const std::string& listFile) {
  Violations found;
  static const std::regex pattern("lumivox_part\\((?:framework|laboratory)/(\\w+)\\s+NEEDS ([a-z ]+)");
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
    {"framework/src/gpu/", "tools/viewer/window", "tests/framework/gpu_faults_test.cpp"}};
const Confined kEmbree{
    "Embree", "<embree|\\brtc[A-Z]\\w*\\s*\\(|\\bRTC[A-Z]\\w+", {"laboratory/src/reference/"}};
const Confined kOpenVdb{"OpenVDB",
                        "<openvdb|\\bopenvdb::",
                        {"tools/vdbexport/", "framework/src/volume/", "tests/framework/scene_media_test.cpp",
                         "tests/tools/vdbexport_", "bench/"}};  // speed programs compare with it

const Confined kSqlite{
    "SQLite", "<sqlite3|\\bsqlite3_\\w+", {"laboratory/src/results/", "tests/laboratory/results_"}};

/// Pages are built from the files of laboratory/src/page/assets; no C++ writes markup.
Violations markup(const Sources& sources) {
  Violations found;
  static const std::regex pattern(
      "</?(html|head|body|div|span|table|t[dhr]|p|h[1-6]|ul|li|img|canvas|style)[ >]");
  for (const SourceFile& source : sources) {
    if (!isCpp(source.path) || (partOf(source.path).empty() && !startsWith(source.path, "tools/"))) continue;
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

static std::string pascalCase(const std::string& name) {
  std::string result;
  bool upper = true;
  for (const char c : name) {
    if (c != '_') result += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    upper = c == '_';
  }
  return result;
}

/// Where C++ names a technique. A name that is one word of English ("ambient") may stand in sentences and be
/// a part of other names: it names the technique where a string is or begins with it, and as a namespace.
static std::regex namePattern(const std::string& technique) {
  if (technique.find('_') == std::string::npos)
    return std::regex("\"" + technique + "[\"./]|\\b" + technique + "::");
  return std::regex("\\b(" + technique + "|" + pascalCase(technique) + ")\\b");
}

/// The framework and the laboratory know techniques only by what a text or a folder names.
Violations namedTechniques(const Sources& sources, const std::vector<std::string>& techniques) {
  Violations found;
  for (const SourceFile& source : sources) {
    if (partOf(source.path).empty() || !isCpp(source.path)) continue;
    const std::string code = withoutComments(source.text, Strings::keep);  // a comment may give an example
    for (const std::string& technique : techniques)
      forEachMatch(code, namePattern(technique), [&](int line, const std::smatch& match) {
        found.push_back(fmt::format("{}:{}: names the technique '{}'", source.path, line, match.str()));
      });
  }
  return found;
}

/// A technique includes the framework, its own files and its generated shader interface; a shader includes
/// its folder, common and toolkit.
Violations dependentTechniques(const Sources& sources, const std::vector<std::string>& techniques) {
  Violations found;
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
        if (kLaboratory.contains(part))
          found.push_back(
              fmt::format("{}:{}: a technique may not include {}", source.path, include.line, part));
      }
    }
  }
  return found;
}

constexpr const char* kVoxelizers = "voxelizers";  // scenes/pipelines/voxelizers: what makes voxels alone

// Shaders of no technique: what techniques share, the framework's own, which serve all techniques or time the
// device.
constexpr std::array kOtherShaders{"common", "toolkit", "device"};

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
    const std::string stem = std::filesystem::path(pipeline.path).stem().string();
    if (std::filesystem::path(pipeline.path).parent_path().filename() == kVoxelizers) {
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
    if (!startsWith(file, "shaders/") || file.find('/', 8) == std::string::npos) continue;
    const std::string folder = file.substr(8, file.find('/', 8) - 8);
    if (std::find(kOtherShaders.begin(), kOtherShaders.end(), folder) == kOtherShaders.end() &&
        std::find(techniques.begin(), techniques.end(), folder) == techniques.end())
      found.push_back(file + ": there is no technique '" + folder + "'");
  }
  return found;
}

// ---- sizes
// --------------------------------------------------------------------------------------------------------------------------

Violations largeFolders(const Sources& sources, const std::map<std::string, FolderSize>& exceptions) {
  std::map<std::string, FolderSize> sizes;
  for (const SourceFile& source : sources) {
    if (!startsWith(source.path, "techniques/") || !isCpp(source.path)) continue;
    FolderSize& size = sizes[std::filesystem::path(source.path).parent_path().generic_string()];
    ++size.files;
    size.lines += static_cast<int>(std::count(source.text.begin(), source.text.end(), '\n'));
  }
  Violations found;
  std::set<std::string> needed;
  for (const auto& [folder, size] : sizes) {
    if (size.files <= kLargestFolder.files && size.lines <= kLargestFolder.lines) continue;
    needed.insert(folder);
    FolderSize most = kLargestFolder;
    if (const auto exception = exceptions.find(folder); exception != exceptions.end())
      most = {std::max(most.files, exception->second.files), std::max(most.lines, exception->second.lines)};
    if (size.files > most.files || size.lines > most.lines)
      found.push_back(fmt::format("{}: {} C++ files of {} lines; expected at most {} of {}", folder,
                                  size.files, size.lines, most.files, most.lines));
  }
  for (const auto& [folder, size] : exceptions)
    if (!needed.contains(folder)) found.push_back(folder + ": needs no exception from the size of a folder");
  return found;
}

Violations widelyIncluding(const Sources& sources, const std::map<std::string, int>& exceptions) {
  std::map<std::string, std::vector<std::string>> included;  // by each shader
  for (const SourceFile& source : sources)
    if (startsWith(source.path, "shaders/")) included[source.path];
  for (const SourceFile& source : sources) {
    const auto own = included.find(source.path);
    if (own == included.end()) continue;
    for (const Include& include : includesOf(source.text))
      // Beside the including file first, as shaderpack seeks them.
      for (const std::filesystem::path& folder :
           {std::filesystem::path(source.path).parent_path(), std::filesystem::path("shaders")}) {
        const std::string path = (folder / include.path).lexically_normal().generic_string();
        if (included.count(path) == 0) continue;
        own->second.push_back(path);
        break;
      }
  }
  Violations found;
  std::set<std::string> needed;
  for (const auto& [path, direct] : included) {
    if (endsWith(path, ".glsl")) continue;
    std::set<std::string> all(direct.begin(), direct.end());
    for (std::vector<std::string> open = direct; !open.empty();) {
      const std::string next = open.back();
      open.pop_back();
      for (const std::string& further : included.at(next))
        if (all.insert(further).second) open.push_back(further);
    }
    const int count = static_cast<int>(all.size());
    if (count <= kMostIncluded) continue;
    needed.insert(path);
    const auto exception = exceptions.find(path);
    const int most = exception == exceptions.end() ? kMostIncluded : exception->second;
    if (count > most)
      found.push_back(fmt::format("{}: includes {} files; expected at most {}", path, count, most));
  }
  for (const auto& [path, count] : exceptions)
    if (!needed.contains(path))
      found.push_back(path + ": needs no exception from the number of included files");
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

}  // namespace lumivox::test::house
