#include "lumivox/page/stress_page.h"

#include "lumivox/base/file.h"
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
  writeFileAtomically(folder / "index.json", stressCellsJson(cells));
  writeFileAtomically(file, page::html(document));
  return file;
}

}  // namespace lumivox
