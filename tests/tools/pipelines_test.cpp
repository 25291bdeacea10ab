// The committed pipelines: right by their grammar, bound to the passes of the techniques, in the canonical
// layout.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "lumivox/base/file.h"
#include "lumivox/dsl/document.h"
#include "lumivox/experiment/reproduce.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "support/support.h"

using namespace lumivox;
namespace fs = std::filesystem;

namespace {

/// Every pipeline of the project, wherever it lies, but those of the tests, some of which are wrong on
/// purpose.
std::vector<fs::path> committedPipelines() {
  std::vector<fs::path> files;
  for (const char* folder : {"scenes", "docs", "techniques", "tools", "bench", "framework", "laboratory"})
    for (const auto& entry : fs::recursive_directory_iterator(test::sourceDirectory() / folder))
      if (entry.path().extension() == ".pipeline") files.push_back(fs::weakly_canonical(entry.path()));
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

TEST_CASE(
    "every committed pipeline passes its check against the techniques and stands in the canonical layout") {
  TechniqueSet techniques({test::binaryDirectory() / "lib/techniques"});
  std::set<std::string> used;
  const std::vector<fs::path> pipelines = committedPipelines();
  for (const fs::path& file : pipelines) {
    INFO(file);
    const std::string text = readFile(file);
    const dsl::Document document = dsl::parse(text, file);
    REQUIRE(document.findings.empty());
    CHECK(dsl::format(document) == text);
    const Pipeline pipeline = Pipeline::load(file);
    CHECK_NOTHROW(checkPipeline(pipeline, techniques));
    for (const std::string& technique : pipeline.techniques()) used.insert(technique);
    // Each point of a sweep must be a setting that the pipeline accepts.
    for (const Sweep& sweep : pipeline.sweeps)
      for (const ParameterValues& point : sweep.points()) {
        std::vector<std::string> assignments;
        for (const auto& [name, value] : point) assignments.push_back(name + "=" + value.text());
        CHECK_NOTHROW(pipeline.settings(assignments));
      }
  }
  CHECK(techniques.skipped().empty());
  // No technique is without a pipeline, nor did the search above miss a folder: whatever a table of a paper
  // measures was among them.
  for (const auto& entry : fs::directory_iterator(test::sourceDirectory() / "techniques")) {
    if (!entry.is_directory()) continue;
    INFO(entry.path());
    CHECK(used.count(entry.path().filename().string()) == 1);
  }
  std::size_t measured = 0;
  for (const fs::path& file : committedReproductions()) {
    const PublishedResult result = PublishedResult::load(file);
    for (const PublishedSetUp* setUp : result.setUps()) {
      if (!setUp->pipeline) continue;
      INFO(setUp->place.text() << ": " << setUp->pipeline->file);
      ++measured;
      CHECK(std::binary_search(pipelines.begin(), pipelines.end(),
                               fs::weakly_canonical(setUp->pipeline->file)));
    }
  }
  CHECK(measured > 0);
}
