#include "page/noise_page.h"

#include <algorithm>
#include <cmath>

#include "page/page_parts.h"

namespace lumivox::page {
namespace {

std::string partsTable(const AnalysedScene& scene, bool defaults, bool moves) {
  std::vector<Table::Column> columns{{"Pipeline"}};
  if (!defaults) columns.push_back({"Parameters"});
  for (const char* title : {"Output", "Against"}) columns.push_back({title});
  for (const char* title : {"RMSE", "Bias", "Picture's noise", "Truth's noise"})
    columns.push_back({title, "number"});
  if (moves) columns.push_back({"Flicker", "number"});
  columns.push_back({"Seeds", "number"});
  Table table(columns);
  for (const PointRecord& record : scene.points) {
    if (record.isDefault != defaults) continue;
    for (const ComponentError& error : record.point.errors) {
      std::vector<std::string> cells{escaped(shortName(record.point.pipeline))};
      if (!defaults) cells.push_back(escaped(parametersText(record.point.parameters)));
      cells.push_back(error.output == kWholePicture ? "whole picture" : escaped(error.output));
      cells.push_back(escaped(error.truth));
      cells.push_back(withUncertainty(error.error.rmse));
      cells.push_back(error.seeds < 2 ? "one seed" : withUncertainty(error.parts.bias));
      cells.push_back(error.seeds < 2       ? "one seed"
                      : error.deterministic ? "none"
                                            : withUncertainty(error.parts.noise));
      cells.push_back(number(error.error.noiseFloor));
      if (moves) cells.push_back(withUncertainty(error.flicker));
      cells.push_back(fmt::format("{}", error.seeds));
      table.row(cells);
    }
  }
  return table.html();
}

}  // namespace

std::string noiseSection(const AnalysedScene& scene) {
  const auto any = [&](const auto& test) {
    return std::any_of(scene.points.begin(), scene.points.end(), [&](const PointRecord& record) {
      return std::any_of(record.point.errors.begin(), record.point.errors.end(),
                         [&](const ComponentError& error) { return test(record, error); });
    });
  };
  const bool moves = any([](const auto&, const auto& error) { return std::isfinite(error.flicker.value); });
  std::string html =
      "<h3>Bias and noise apart</h3>\n<p class=\"caption\">What the RMSE is made of: the squares of bias, of the "
      "picture's own noise and of the truth's noise add up to the mean square over seeds. More samples or more "
      "frames take the picture's noise away, never the bias. Techniques without random numbers have none; two "
      "seeds alone tell noise only roughly, and the uncertainties are then bounds.";
  if (moves)
    html +=
        " Flicker: RMS of the changes from frame to frame, 1/24 s apart, that the truth does not make, its "
        "noise taken off.";
  html += " All in W/(sr m&sup2;), &plusmn; one standard uncertainty.</p>\n" + partsTable(scene, true, moves);
  if (any([](const auto& record, const auto&) { return !record.isDefault; }))
    html += "<details><summary>Other points of the sweeps</summary>\n" + partsTable(scene, false, moves) +
            "</details>\n";
  return html;
}

}  // namespace lumivox::page
