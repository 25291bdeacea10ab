// The snippets of docs/reading_results.md, run in a folder with the files that they read.
#include <cstdlib>
#include <optional>
#include <regex>

#include "lumivox/base/file.h"
#include "tools/cli_support.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

struct Snippet {
  std::string text, modules;  ///< modules: as `import` takes them; empty: of Python alone
};

std::vector<Snippet> snippets() {
  const std::string guide = readFile(sourceDirectory() / "docs/reading_results.md");
  static const std::regex block("```python\n([^`]*)```"), needs("^# needs: (.*)\n");
  std::vector<Snippet> found;
  for (std::sregex_iterator match(guide.begin(), guide.end(), block), end; match != end; ++match) {
    Snippet snippet{(*match)[1], ""};
    std::smatch modules;
    if (std::regex_search(snippet.text, modules, needs)) snippet.modules = modules[1];
    found.push_back(std::move(snippet));
  }
  return found;
}

bool runs(const std::string& command) {
  return std::system((command + " > /dev/null 2>&1").c_str()) == 0;
}

/// The Python that has these modules: the first on the path, else Debian's own.
std::optional<std::string> pythonWith(const std::string& modules) {
  for (const char* python : {"python3", "/usr/bin/python3"})
    if (runs(std::string(python) + " -c 'import " + (modules.empty() ? "sys" : modules) + "'")) return python;
  return std::nullopt;
}

/// The files that the guide's commands leave, of a room that is quick to measure.
struct Files {
  Workplace place;
  Files() {
    place.write(
        "direct.pipeline",
        "pipeline \"Direct\" {\n  param samples 4 in 1..16\n  pass gbuffer direct_lighting.gbuffer { }\n"
        "  pass shadow direct_lighting.shadow_map { size 64  area_samples $samples }\n"
        "  pass direct direct_lighting.shade { gbuffer gbuffer  shadow shadow.depth }\n  output direct "
        "direct.radiance\n}\nsweep samples { samples [1 4] }\n");
    const std::string both = "'" + place.scene() + "' ";
    ran("render", Raw{both}, place.file("direct.pipeline"), "-q -o", place.file("image.exr"));
    const CommandResult report =
        runCommand("lumivox report " + both + "--pipeline '" + place.file("direct.pipeline") +
                   "' -q --spp 16 --subpixels 1 --repeats 2 --store '" + place.file("results.sqlite") +
                   "' -o '" + place.file("index.html") + "'");
    INFO(report.errors);
    REQUIRE(report.exitCode == 0);
  }
};

CommandResult runSnippet(const Files& files, const std::string& python, const Snippet& snippet) {
  files.place.write("snippet.py", snippet.text);
  return runCommand("cd '" + files.place.path().string() + "' && PYTHONDONTWRITEBYTECODE=1 " + python +
                    " snippet.py");
}

}  // namespace

TEST_CASE("the snippets of the guide that need Python alone run, and tell the same numbers") {
  const auto python = pythonWith("");
  if (!python) return skip("no python3");
  const Files files;
  std::string all;
  int count = 0;
  for (const Snippet& snippet : snippets()) {
    if (!snippet.modules.empty()) continue;
    const CommandResult result = runSnippet(files, *python, snippet);
    INFO(snippet.text << result.errors);
    CHECK(result.exitCode == 0);
    CHECK(contains(result.output, "direct.pipeline"));
    all += result.output;
    ++count;
  }
  CHECK(count == 3);
  // The CSV's least error is that of the store's one default point, or less.
  static const std::regex flip("FLIP ([0-9.]+)");
  std::vector<double> told;
  for (std::sregex_iterator match(all.begin(), all.end(), flip), end; match != end; ++match)
    told.push_back(std::stod((*match)[1]));
  REQUIRE(told.size() == 2);
  CHECK(told[0] <= told[1] + 0.0005);
  CHECK(contains(all, "on the front:"));
}

TEST_CASE("the snippets of the guide that need packages run where these are there") {
  std::vector<std::string> lacking;
  int count = 0;
  std::optional<Files> files;
  for (const Snippet& snippet : snippets()) {
    if (snippet.modules.empty()) continue;
    ++count;
    const auto python = pythonWith(snippet.modules);
    if (!python) {
      lacking.push_back(snippet.modules);
      continue;
    }
    if (!files) files.emplace();
    const CommandResult result = runSnippet(*files, *python, snippet);
    INFO(snippet.text << result.errors);
    CHECK(result.exitCode == 0);
    CHECK_FALSE(result.output.empty());
    if (contains(snippet.modules, "pandas")) CHECK(contains(result.output, "parameter_samples"));
    if (contains(snippet.modules, "OpenImageIO")) CHECK(contains(result.output, "(16, 24, "));
  }
  CHECK(count == 2);
  if (!lacking.empty()) {
    std::string names;
    for (const std::string& one : lacking) names += (names.empty() ? "" : "; ") + one;
    skip("no Python modules " + names);
  }
}
