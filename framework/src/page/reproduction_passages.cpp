// The figures that a paper card quotes, written from the kept results.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "lumivox/analysis/judge.h"
#include "lumivox/base/error.h"
#include "lumivox/page/reproduction_page.h"
#include "page/markup.h"

namespace lumivox {
namespace {

constexpr const char* kOpening = "<!-- reproduced ";
constexpr const char* kOpeningEnd = " -->";
constexpr const char* kClosing = "<!-- end -->";

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// "ratios 004-table-3; isotropic, voxelization; isotropic, mipmap"
struct Request {
  std::string kind, id;
  std::vector<std::string> names;
};

Request requestOf(const std::string& text) {
  Request request;
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t to = std::min(text.find(';', from), text.size());
    parts.push_back(trimmed(text.substr(from, to - from)));
    from = to + 1;
  }
  const std::size_t space = std::min(parts.front().find(' '), parts.front().size());
  request.kind = parts.front().substr(0, space);
  request.id = trimmed(parts.front().substr(space));
  request.names.assign(parts.begin() + 1, parts.end());
  return request;
}

[[noreturn]] void refuse(const std::string& what, const std::string& name,
                         const std::vector<std::string>& known) {
  const std::string nearest = nearestWord(name, known);
  throw Error(fmt::format("there is no {} '{}'; expected one of {}{}", what, name, fmt::join(known, ", "),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

template <class Things, class Name>
const auto& found(const Things& things, const char* what, const std::string& wanted, const Name& name) {
  std::vector<std::string> known;
  for (const auto& one : things) {
    if (name(one) == wanted) return one;
    known.push_back(name(one));
  }
  refuse(what, wanted, known);
}

std::string ratio(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-";
}

/// All rows that were measured; the others are in the whole table.
std::string table(const ReproducedResult& result) {
  std::vector<MeasuredRow> rows;
  for (const MeasuredRow& row : result.rows)
    if (row.measured) rows.push_back(row);
  JudgedTable judged;
  for (std::size_t i = 0; i < result.rows.size(); ++i)
    if (result.rows[i].measured) judged.rows.push_back(result.judged.rows[i]);
  return fmt::format("\n\n{}\n{}\n\n", reproductionTable(rows, judged), verdictText(result));
}

/// "1 : 0.53 : 0.4, published 1 : 0.86 : 0.35: *not reproduced*".
std::string ratios(const ReproducedResult& result, const std::vector<std::string>& names) {
  std::vector<MeasuredRow> rows;
  for (const std::string& name : names)
    rows.push_back(found(result.rows, "row", name, [](const MeasuredRow& row) { return row.name; }));
  // A row that is divided by one of its own is judged in the whole table, the others among themselves.
  const bool isQuotient =
      std::any_of(rows.begin(), rows.end(), [](const auto& row) { return !row.over.empty(); });
  JudgedTable judged;
  if (isQuotient) {
    for (const MeasuredRow& row : rows)
      judged.rows.push_back(result.judged.rows[static_cast<std::size_t>(
          std::find_if(result.rows.begin(), result.rows.end(),
                       [&](const auto& one) { return one.name == row.name; }) -
          result.rows.begin())]);
  } else {
    judged = judge(rows);
  }
  // Each verdict once, in the order of the rows.
  std::vector<std::string> measured, published, verdicts;
  bool asTheWhole = true;
  for (const JudgedRow& row : judged.rows) {
    measured.push_back(ratio(row.ratio));
    published.push_back(ratio(row.publishedRatio));
    if (row.verdict == Verdict::reference || (!isQuotient && measured.size() == 1)) continue;
    asTheWhole = asTheWhole && row.verdict == result.judged.verdict;
    std::string verdict = fmt::format("*{}*", name(row.verdict));
    if (!row.why.empty()) verdict += " (" + row.why + ")";
    if (std::find(verdicts.begin(), verdicts.end(), verdict) == verdicts.end()) verdicts.push_back(verdict);
  }
  const char* const between = isQuotient ? ", " : " : ";
  std::string text = fmt::format("{}, published {}: {}", fmt::join(measured, between),
                                 fmt::join(published, between), fmt::join(verdicts, ", "));
  if (!asTheWhole) text += fmt::format("; the whole table *{}*", name(result.judged.verdict));
  return page::replaced(text, "|", "\\|");
}

std::string curve(const ReproducedResult& result, const std::string& wanted) {
  const MeasuredCurve& one =
      found(result.curves, "curve", wanted, [](const MeasuredCurve& curve) { return curve.name; });
  return page::replaced(
      curveText(one, result.judgedCurves[static_cast<std::size_t>(&one - result.curves.data())]), "|", "\\|");
}

std::string passage(const Request& request, const std::vector<ReproducedResult>& results) {
  const ReproducedResult& result =
      found(results, "result", request.id, [](const ReproducedResult& one) { return one.published.id; });
  const auto requireNames = [&](std::size_t least, std::size_t most, const char* expected) {
    if (request.names.size() < least || request.names.size() > most)
      throw Error(
          fmt::format("'{}' has {} names; expected {}", request.kind, request.names.size(), expected));
  };
  if (request.kind == "table") {
    requireNames(0, 0, "table ID");
    return table(result);
  }
  if (request.kind == "ratios") {
    requireNames(1, result.rows.size(), "ratios ID; ROW; ROW ...");
    return ratios(result, request.names);
  }
  if (request.kind == "curve") {
    requireNames(1, 1, "curve ID; CURVE");
    return curve(result, request.names.front());
  }
  refuse("kind of passage", request.kind, {"table", "ratios", "curve"});
}

/// Within a fenced block, which shows how something is written.
bool isFenced(const std::string& markdown, std::size_t at) {
  bool fenced = markdown.rfind("```", 0) == 0;
  for (std::size_t fence = markdown.find("\n```"); fence < at; fence = markdown.find("\n```", fence + 1))
    fenced = !fenced;
  return fenced;
}

}  // namespace

std::string withReproducedPassages(const std::string& markdown, const std::filesystem::path& file,
                                   const std::vector<ReproducedResult>& results) {
  std::string text;
  std::size_t at = 0;
  for (;;) {
    std::size_t opening = markdown.find(kOpening, at);
    while (opening != std::string::npos && isFenced(markdown, opening))
      opening = markdown.find(kOpening, opening + 1);
    if (opening == std::string::npos) return text + markdown.substr(at);
    const auto lineNumber =
        1 + std::count(markdown.begin(), markdown.begin() + static_cast<std::ptrdiff_t>(opening), '\n');
    const auto fail = [&](const std::string& what) {
      throw Error(fmt::format("{}:{}: {}", file.string(), lineNumber, what));
    };
    const std::size_t words = opening + std::string_view(kOpening).size(),
                      wordsEnd = markdown.find(kOpeningEnd, words), closing = markdown.find(kClosing, words),
                      next = markdown.find(kOpening, words);
    if (wordsEnd == std::string::npos || closing == std::string::npos || closing < wordsEnd || next < closing)
      fail(fmt::format("this passage of reproduced figures has no end; expected {} after it", kClosing));
    const std::size_t inside = wordsEnd + std::string_view(kOpeningEnd).size();
    text += markdown.substr(at, inside - at);
    try {
      text += passage(requestOf(markdown.substr(words, wordsEnd - words)), results);
    } catch (const Error& error) {
      fail(error.what());
    }
    text += kClosing;
    at = closing + std::string_view(kClosing).size();
  }
}

}  // namespace lumivox
