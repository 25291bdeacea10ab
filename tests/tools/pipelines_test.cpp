// The committed pipelines: right by their grammar, bound to the passes of the techniques, in the canonical
// layout.
#include <algorithm>
#include <string>
#include <vector>

#include "lumivox/base/file.h"
#include "lumivox/dsl/document.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "support/support.h"

using namespace lumivox;
namespace fs = std::filesystem;

TEST_CASE(
    "every committed pipeline passes its check against the techniques and stands in the canonical layout") {
  TechniqueSet techniques({test::binaryDirectory() / "lib/techniques"});
  std::size_t seen = 0;
  for (const fs::path& folder :
       {test::sourceDirectory() / "scenes/pipelines", test::sourceDirectory() / "scenes/pipelines/voxelisers",
        test::sourceDirectory() / "docs/examples"})
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() != ".pipeline") continue;
      INFO(entry.path());
      ++seen;
      const std::string text = readFile(entry.path());
      const dsl::Document document = dsl::parse(text, entry.path());
      REQUIRE(document.findings.empty());
      CHECK(dsl::format(document) == text);
      const Pipeline pipeline = Pipeline::load(entry.path());
      CHECK_NOTHROW(checkPipeline(pipeline, techniques));
      // Each point of a sweep must be a setting that the pipeline accepts.
      for (const Sweep& sweep : pipeline.sweeps)
        for (const ParameterValues& point : sweep.points()) {
          std::vector<std::string> assignments;
          for (const auto& [name, value] : point) assignments.push_back(name + "=" + value.text());
          CHECK_NOTHROW(pipeline.settings(assignments));
        }
    }
  CHECK(seen >= 2);
  CHECK(techniques.skipped().empty());
}
