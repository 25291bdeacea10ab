#include "lumivox/page/stress_page.h"

#include "base/file_set.h"
#include "lumivox/results/json.h"
#include "page/document.h"
#include "page_assets.h"

namespace lumivox {

std::filesystem::path writeStressPage(const std::filesystem::path& folder,
                                      const std::vector<StressCell>& given, const std::string& commandLine) {
  std::vector<StressCell> cells = given;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (StressCell& cell : cells) {
    std::error_code failure;
    if (!cell.image.empty() && !std::filesystem::exists(folder / cell.image, failure)) cell.image.clear();
    list.push_back(toJson(cell));
  }
  page::Document document;
  document.title = "Where each technique breaks";
  document.data = {{"command", commandLine}, {"cells", std::move(list)}};
  document.scripts = {page::assets::kStressJs, page::assets::kStressPageJs};
  const std::filesystem::path file = folder / "index.html";
  const std::string json = stressCellsJson(cells), html = page::html(document);
  writeFilesAtomically(std::vector<NewFile>{{folder / "index.json", json}, {file, html}});
  return file;
}

}  // namespace lumivox
