// Reproduced tables for readers.
#include <fmt/format.h>

#include <cmath>

#include "lumivox/report/reproduce.h"
#include "report/page_parts.h"

namespace lumivox {
namespace {

using namespace report;

const std::vector<std::string>& headings() {
  static const std::vector<std::string> names = {
      "row", "published", "measured", "published ratio", "measured ratio", "verdict"};
  return names;
}

std::string withUnit(double value, const char* unit) {
  return *unit == '\0' ? fmt::format("{:.6g}", value) : fmt::format("{:.4g} {}", value, unit);
}

std::string measuredText(const MeasuredRow& row) {
  if (!row.measured) return "-";
  constexpr double kMillisecondsPerSecond = 1000.0;
  if (row.quantity == PublishedQuantity::frameRate)
    return fmt::format("{:.3g} {}", kMillisecondsPerSecond / row.measured->median, unit(row.quantity));
  if (row.quantity == PublishedQuantity::time)
    return fmt::format("{} [{}, {}] ms", formatMilliseconds(row.measured->median),
                       formatMilliseconds(row.measured->lowerQuartile),
                       formatMilliseconds(row.measured->upperQuartile));
  return withUnit(row.measured->median, unit(row.quantity));
}

std::string ratioText(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.3g}", ratio) : "-";
}

std::string heading(const ReproducedTable& table) {
  return table.table.id + ": " + table.table.title;
}

std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string markdownCell(const std::string& text) {
  return replaced(text, "|", "\\|");
}

}  // namespace

std::vector<std::string> reproductionCells(const PublishedRow& row, const MeasuredRow& measured,
                                           const JudgedRow& judged) {
  const bool spread = judged.lowRatio < judged.highRatio;
  return {
      row.name,
      withUnit(row.published, unit(row.quantity)),
      measuredText(measured),
      ratioText(judged.publishedRatio),
      ratioText(judged.ratio) +
          (spread ? fmt::format(" [{:.3g}, {:.3g}]", judged.lowRatio, judged.highRatio) : std::string()),
      judged.why.empty() ? name(judged.verdict) : fmt::format("{}: {}", name(judged.verdict), judged.why)};
}

std::string verdictText(const ReproducedTable& table) {
  return capital(name(table.judged.verdict)) + ": " + table.judged.why + ".";
}

std::vector<std::string> reproductionNotes(const ReproducedTable& table) {
  std::vector<std::string> notes;
  notes.push_back(fmt::format(
      "Published on: {}. Measured on: {} ({}{}), {}, {}.",
      table.table.device.empty() ? "not said" : table.table.device, table.device.renderer,
      table.device.version, table.device.software ? ", a software rasteriser" : "", table.host, table.date));
  if (table.scale != 1.0) {
    std::string parameters;
    for (const std::string& name : table.table.scaled) parameters += ", " + name;
    notes.push_back(fmt::format("Reduced: picture sides{} times {:.4g}.", parameters, table.scale));
  }
  for (const std::string& setUp : table.setUps) notes.push_back("Measured: " + setUp + ".");
  for (const std::string& difference : table.table.differences)
    notes.push_back("Differs: " + difference + ".");
  notes.push_back("Repeat: " + table.command);
  return notes;
}

std::string reproductionRule() {
  return fmt::format(
      "Ratios are to the first comparable row. A row is reproduced when its measured ratio, {1} standard uncertainties to "
      "both sides, lies within a factor of {0} of the published one; not reproduced when all of that lies beyond; not "
      "comparable when the set-up is not here or is another one, or when the uncertainty reaches across the limit. A table "
      "is reproduced when a row is, none is not, and no two rows stand in the other order than published. Frame rates "
      "count as times of frames. Brackets behind times are quartiles.",
      kReproducedFactor, kReproducedSigmas);
}

std::string reproductionsAsMarkdown(const std::vector<ReproducedTable>& tables) {
  std::string text = "# Published tables, measured here\n\n" + reproductionRule() + "\n";
  for (const ReproducedTable& table : tables) {
    text += fmt::format("\n## {}\n\n{}. **{}**\n\n", heading(table), table.table.paper, verdictText(table));
    text += fmt::format("| {} |\n|---|---|---|---|---|---|\n", fmt::join(headings(), " | "));
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      std::vector<std::string> cells =
          reproductionCells(table.table.rows[i], table.rows[i], table.judged.rows[i]);
      for (std::string& cell : cells) cell = markdownCell(cell);
      text += fmt::format("| {} |\n", fmt::join(cells, " | "));
    }
    text += "\n";
    for (const std::string& note : reproductionNotes(table)) text += "- " + note + "\n";
  }
  return text;
}

std::string reproductionsAsHtml(const std::vector<ReproducedTable>& tables) {
  std::string body =
      "<main>\n<h1>Published tables, measured here</h1>\n<p>" + escaped(reproductionRule()) + "</p>\n";
  for (const ReproducedTable& table : tables) {
    body += fmt::format("<h2>{}</h2>\n<p>{}. <strong>{}</strong></p>\n", escaped(heading(table)),
                        escaped(table.table.paper), escaped(verdictText(table)));
    std::vector<Table::Column> columns;
    for (const std::string& heading : headings())
      columns.push_back({heading, heading == "row" || heading == "verdict" ? "wide" : "number"});
    Table html(columns);
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      std::vector<std::string> cells =
          reproductionCells(table.table.rows[i], table.rows[i], table.judged.rows[i]);
      for (std::string& cell : cells) cell = escaped(cell);
      html.row(cells);
    }
    body += html.html() + "<ul>\n";
    for (const std::string& note : reproductionNotes(table)) body += "<li>" + escaped(note) + "</li>\n";
    body += "</ul>\n";
  }
  return wholePage("Published tables, measured here", "", body + "</main>\n", "", "");
}

}  // namespace lumivox
