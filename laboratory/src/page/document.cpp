#include "page/document.h"

#include <cstdlib>
#include <filesystem>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/json.h"
#include "page/markup.h"
#include "page_assets.h"

namespace lumivox::page {
namespace {

/// JSON as the content of a script element, which no text in it can end.
std::string block(const char* id, const nlohmann::ordered_json& json) {
  return std::string("<script type=\"application/json\" id=\"") + id + "\">" +
         replaced(textOf(json, -1), "<", "\\u003c") + "</script>\n";
}

std::string script(const std::string& text) {
  return "<script>\n" + replaced(text, "</script", "<\\/script") + "</script>\n";
}

}  // namespace

std::string html(const Document& document) {
  std::string records = block("data", document.data), scripts;
  if (!document.images.is_null()) records += block("images", document.images);
  if (document.charts) scripts += script(chartLibrary());
  scripts += script(assets::kPlotsJs) + script(assets::kPageJs);
  for (const char* text : document.scripts) scripts += script(text);
  // Inserted text may contain such words itself, so the page is put together from its end.
  std::string page = assets::kPageHtml;
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"{{scripts}}", scripts},
                                   {"{{records}}", records},
                                   {"{{style}}", assets::kPageCss},
                                   {"{{title}}", escaped(document.title)}})
    page.replace(page.find(name), name.size(), text);
  return page;
}

std::string chartLibrary() {
  const std::vector<std::string> places = [] {
    std::vector<std::string> list;
    if (const char* given = std::getenv("LUMIVOX_CHART_JS"); given != nullptr && *given != '\0')
      list.emplace_back(given);
    else
      list = {"/usr/share/javascript/chart.js/chart.min.js", "/usr/share/javascript/chart.js/Chart.min.js"};
    return list;
  }();
  std::string sought;
  for (const std::string& place : places) {
    std::error_code failure;
    if (std::filesystem::is_regular_file(place, failure)) {
      std::string text = readFile(place);
      if (text.find("Chart.js v3") == std::string::npos)
        throw Error(place + ": not Chart.js 3; the report needs the Debian package libjs-chart.js");
      return text;
    }
    sought += (sought.empty() ? "" : ", ") + place;
  }
  throw AbsentError("Chart.js not found; the report needs the Debian package libjs-chart.js; searched: " +
                    sought);
}

}  // namespace lumivox::page
