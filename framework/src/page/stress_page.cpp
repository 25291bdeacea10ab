#include "page/stress_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "lumivox/base/file.h"
#include "lumivox/page/stress_page.h"
#include "page/page_parts.h"

namespace lumivox::page {
namespace {

/// How an outcome is called and what it means; in the order of concern.
struct Outcome {
  StressOutcome outcome;
  const char* meaning;
};
constexpr Outcome kOutcomes[] = {
    {StressOutcome::broken, "NaN, infinite or negative where it must not be, a crash or a hang"},
    {StressOutcome::diverges, "finite, but it grows without bound or does not converge where it should"},
    {StressOutcome::biased, "healthy and bounded, but beyond the limit of the case"},
    {StressOutcome::refused, "a clear message in place of a picture"},
    {StressOutcome::stable, "healthy, and within the limit of the case"},
    {StressOutcome::notApplicable, "the case asks for something that the pipeline does not have"}};

std::string words(const std::string& name) {
  return replaced(name, "_", " ");
}

/// Cases and pipelines in the order in which they come first.
struct Axes {
  std::vector<std::pair<std::string, std::string>> cases;      ///< family, case
  std::vector<std::pair<std::string, std::string>> pipelines;  ///< technique, pipeline
};

template <class List, class Value>
void addOnce(List& list, const Value& value) {
  if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
}

Axes axesOf(const std::vector<StressCell>& cells) {
  Axes axes;
  for (const StressCell& cell : cells) {
    addOnce(axes.cases, std::pair(cell.family, cell.name));
    addOnce(axes.pipelines, std::pair(cell.technique, cell.pipeline));
  }
  // Neighbours of one family or technique stand together, in the order of their first ones.
  const auto together = [](auto& list) {
    std::vector<std::string> heads;
    for (const auto& one : list) addOnce(heads, one.first);
    std::stable_sort(list.begin(), list.end(), [&](const auto& a, const auto& b) {
      return std::find(heads.begin(), heads.end(), a.first) < std::find(heads.begin(), heads.end(), b.first);
    });
  };
  together(axes.cases);
  together(axes.pipelines);
  return axes;
}

std::string matrixText(const StressCell& cell) {
  switch (cell.outcome) {
    case StressOutcome::broken:
      return "broken";
    case StressOutcome::refused:
      return "refused";
    case StressOutcome::notApplicable:
      return "";
    case StressOutcome::diverges:
    case StressOutcome::biased:
    case StressOutcome::stable:
      break;
  }
  if (cell.measure.empty()) return name(cell.outcome);
  return number(cell.value.value) + (cell.unit.empty() ? "" : " " + escaped(cell.unit));
}

/// Names of the columns stand upright, so that a dozen and more fit.
std::string matrixHead(const Axes& axes) {
  std::string techniques = "<tr><th></th>", names = "<tr><th>case</th>";
  for (std::size_t i = 0; i < axes.pipelines.size();) {
    std::size_t end = i;
    while (end < axes.pipelines.size() && axes.pipelines[end].first == axes.pipelines[i].first) ++end;
    techniques += fmt::format("<th class=\"group\" colspan=\"{}\">{}</th>", end - i,
                              escaped(words(axes.pipelines[i].first)));
    for (; i < end; ++i)
      names += "<th class=\"upright\"><span>" + escaped(words(shortName(axes.pipelines[i].second))) +
               "</span></th>";
  }
  return "<thead>" + techniques + "</tr>\n" + names + "</tr></thead>\n";
}

std::string matrix(const std::vector<StressCell>& cells) {
  const Axes axes = axesOf(cells);
  std::map<std::pair<std::string, std::string>, std::size_t> places;  // case and pipeline to cell
  for (std::size_t i = 0; i < cells.size(); ++i) places[{cells[i].name, cells[i].pipeline}] = i;
  std::string body, family;
  for (const auto& [caseFamily, caseName] : axes.cases) {
    if (caseFamily != family)
      body += fmt::format("<tr class=\"family\"><th colspan=\"{}\">{}</th></tr>\n", axes.pipelines.size() + 1,
                          escaped(words(caseFamily)));
    family = caseFamily;
    body += "<tr><td class=\"case\">" + escaped(words(caseName)) + "</td>";
    for (const auto& [technique, pipeline] : axes.pipelines) {
      const auto place = places.find({caseName, pipeline});
      if (place == places.end()) {
        body += "<td></td>";
        continue;
      }
      const StressCell& cell = cells[place->second];
      const std::string text = matrixText(cell);
      body += fmt::format(
          "<td class=\"cell {}\" title=\"{}\">{}</td>", name(cell.outcome),
          escaped(shortName(pipeline) + ", " + caseName + ": " + stressValueText(cell) +
                  (cell.measure.empty() ? "" : "; " + cell.measure)),
          text.empty() ? std::string() : fmt::format("<a href=\"#cell-{}\">{}</a>", place->second, text));
    }
    body += "</tr>\n";
  }
  return "<div class=\"scroll\"><table class=\"stress\">" + matrixHead(axes) + "<tbody>\n" + body +
         "</tbody></table></div>\n";
}

std::string legend(const std::vector<StressCell>& cells) {
  std::string items;
  for (const Outcome& one : kOutcomes) {
    const auto count = std::count_if(cells.begin(), cells.end(),
                                     [&](const StressCell& cell) { return cell.outcome == one.outcome; });
    items += fmt::format("<tr><td class=\"cell {}\">{}</td><td class=\"number\">{}</td><td>{}</td></tr>\n",
                         name(one.outcome), escaped(words(name(one.outcome))), count, one.meaning);
  }
  return "<table class=\"stress legend\"><tbody>\n" + items + "</tbody></table>\n";
}

std::string pictureLink(const StressCell& cell, const std::string& pictures) {
  if (pictures.empty() || cell.picture.empty()) return {};
  return fmt::format("<a href=\"{0}\"><img alt=\"picture of the cell\" src=\"{0}\" loading=\"lazy\"></a>",
                     escaped(cell.picture));
}

std::string measureText(const StressCell& cell) {
  if (cell.measure.empty()) return {};
  std::string text = escaped(cell.measure) + ": <b>" + withUncertainty(cell.value) + "</b>";
  if (!cell.unit.empty()) text += " " + escaped(cell.unit);
  if (cell.limit > 0.0) text += "; limit " + number(cell.limit);
  return text;
}

std::string concern(const StressCell& cell, std::size_t index, const std::string& pictures) {
  std::string html = fmt::format(
      "<section class=\"concern\" id=\"cell-{}\">\n{}<h4><span class=\"cell {}\">{}</span> {}: {}</h4>\n",
      index, pictureLink(cell, pictures), name(cell.outcome), escaped(words(name(cell.outcome))),
      escaped(shortName(cell.pipeline)), escaped(words(cell.name)));
  if (const std::string measure = measureText(cell); !measure.empty()) html += "<p>" + measure + "</p>\n";
  if (!cell.detail.empty()) html += "<p class=\"soft\">" + escaped(cell.detail) + "</p>\n";
  if (!cell.explanation.empty()) html += "<p>" + escaped(cell.explanation) + "</p>\n";
  return html + "<pre>" + escaped(cell.command) + "</pre>\n</section>\n";
}

std::string quietTable(const std::vector<StressCell>& cells, const std::string& pictures) {
  Table table({{"Pipeline"}, {"Case"}, {"Measured", "wide"}, {"Detail", "wide"}, {"Picture"}, {"Command"}});
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const StressCell& cell = cells[i];
    if (cell.outcome != StressOutcome::stable) continue;
    table.row({fmt::format("<span id=\"cell-{}\"></span>{}", i, escaped(shortName(cell.pipeline))),
               escaped(words(cell.name)), measureText(cell), escaped(cell.detail),
               pictures.empty() || cell.picture.empty()
                   ? ""
                   : "<a href=\"" + escaped(cell.picture) + "\">picture</a>",
               "<code>" + escaped(cell.command) + "</code>"});
  }
  return table.html();
}

}  // namespace

const char* const kStressStyle = R"css(
table.stress td.cell { text-align: center; padding: 2px 6px; font-size: .8rem; border-left: 1px solid #fff; }
table.stress td.cell a { color: inherit; text-decoration: none; display: block; }
table.stress td.case { position: sticky; left: 0; background: #fff; font-size: .82rem; padding: 2px 10px; }
table.stress th.upright { vertical-align: bottom; padding: 6px 2px; }
table.stress th.upright span { writing-mode: vertical-rl; transform: rotate(180deg); font-size: .8rem; }
table.stress th.group { border-left: 2px solid var(--ink); font-size: .8rem; white-space: normal; }
table.stress tr.family th { text-align: left; background: var(--wash); position: static; }
table.stress.legend { width: auto; }
.cell.stable { background: #dcefe0; } .cell.biased { background: #fce3b6; } .cell.diverges { background: #f5b48a; }
.cell.refused { background: #d9e3f2; } .cell.not_applicable { background: #f2f2f2; }
.cell.broken { background: #b3261e; color: #fff; font-weight: 600; }
.concern { border-top: 1px solid var(--line); padding: 6px 0; overflow: hidden; }
.concern h4 { margin: 6px 0; } .concern .cell { padding: 1px 8px; border-radius: 4px; font-size: .8rem; }
.concern img { float: right; width: 128px; image-rendering: pixelated; border: 1px solid var(--line); margin: 4px 0 4px 12px; }
section:target, tr:has(:target) { background: #fffbe0; }
)css";

std::string stressSection(const std::vector<StressCell>& cells, const std::string& pictures) {
  if (cells.empty()) return {};
  std::string concerns;
  for (const Outcome& one : kOutcomes)
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (cells[i].outcome == one.outcome && one.outcome != StressOutcome::stable &&
          one.outcome != StressOutcome::notApplicable)
        concerns += concern(cells[i], i, pictures);
  std::string html =
      "<h2 id=\"stress\">Where each technique breaks</h2>\n<p class=\"caption\">Every pipeline on every extreme "
      "case. A cell holds what its case measures; its colour is the outcome. Each leads to its picture and to "
      "the command that repeats it.</p>\n" +
      legend(cells) + matrix(cells) + "<h3>Cells that are not stable</h3>\n" +
      (concerns.empty() ? std::string("<p>There are none.</p>\n") : concerns) + "<h3>Stable cells</h3>\n" +
      quietTable(cells, pictures);
  return html;
}

}  // namespace lumivox::page

namespace lumivox {

std::filesystem::path writeStressPage(const std::filesystem::path& folder,
                                      const std::vector<StressCell>& given, const std::string& commandLine) {
  using namespace page;
  std::vector<StressCell> cells = given;
  std::set<std::string> devices, dates;
  for (StressCell& cell : cells) {
    std::error_code failure;
    if (!cell.picture.empty() && !std::filesystem::exists(folder / cell.picture, failure))
      cell.picture.clear();
    if (!cell.device.empty()) devices.insert(cell.device);
    dates.insert(cell.created.substr(0, 10));
  }
  const std::string dateText = dates.empty()       ? std::string()
                               : dates.size() == 1 ? *dates.begin()
                                                   : fmt::format("{} to {}", *dates.begin(), *dates.rbegin());
  const std::string body =
      "<header>\n<h1>Lumivox stress battery</h1>\n<p class=\"soft\">" +
      fmt::format("{} cells on {}, {}", cells.size(), escaped(fmt::format("{}", fmt::join(devices, "; "))),
                  dateText) +
      (commandLine.empty() ? std::string() : ", by <code>" + escaped(commandLine) + "</code>") +
      ". The same numbers stand in index.json beside this page.</p>\n</header>\n<main>\n" +
      stressSection(cells, "pictures") + "</main>\n";
  const std::filesystem::path page = folder / "index.html";
  writeFileAtomically(folder / "index.json", stressCellsJson(cells));
  writeFileAtomically(
      page, wholePage("Where each technique breaks",
                      std::string("main, header { max-width: 1500px; }") + kStressStyle, body, "", ""));
  return page;
}

}  // namespace lumivox
