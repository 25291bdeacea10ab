// Pieces that the sections of the page share.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "lumivox/measure/metrics.h"
#include "lumivox/results/text.h"

namespace lumivox::page {

std::string escaped(const std::string& text);  ///< for HTML
std::string replaced(std::string text, const std::string& from, const std::string& to);
std::string number(double value);    ///< three digits; "-" when there is none
std::string oneDigit(double value);  ///< one that counts: "0.02", "7", "40"
std::string withUncertainty(const Measured& measured);
std::string withQuartiles(const TimingStatistics& time);
std::string percent(double share);
std::string componentTitle(const std::string& component);  ///< "Indirect diffuse"; "final": "Whole picture"

/// JSON as the content of a script element, which no text in it can end.
std::string dataBlock(const std::string& id, const std::string& json);
/// A whole page around its body; the scripts come after the chart library and kPageHelpers.
std::string wholePage(const std::string& title, const std::string& styles, const std::string& body,
                      const std::string& chartLibrary, const std::string& scripts);

/// A table that scrolls by itself. Cells are finished HTML.
class Table {
 public:
  struct Column {
    std::string title;
    const char* kind = "";  ///< "number", "wide", "cell" or nothing
  };
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  void row(const std::vector<std::string>& cells, const char* kind = "") {
    rows_ += *kind ? fmt::format("<tr class=\"{}\">", kind) : std::string("<tr>");
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const char* cellKind = i < columns_.size() ? columns_[i].kind : "";
      rows_ += *cellKind ? fmt::format("<td class=\"{}\">{}</td>", cellKind, cells[i])
                         : "<td>" + cells[i] + "</td>";
    }
    rows_ += "</tr>\n";
  }
  std::string html() const {
    std::string head;
    for (const Column& column : columns_)
      head += *column.kind ? fmt::format("<th class=\"{}\">{}</th>", column.kind, column.title)
                           : "<th>" + column.title + "</th>";
    return "<div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>\n" + rows_ +
           "</tbody></table></div>\n";
  }

 private:
  std::vector<Column> columns_;
  std::string rows_;
};

}  // namespace lumivox::page
