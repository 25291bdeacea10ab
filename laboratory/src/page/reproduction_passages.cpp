// The figures that a paper card quotes, written from the kept results.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "lumivox/analysis/judge.h"
#include "lumivox/base/error.h"
#include "lumivox/page/reproduction_page.h"
#include "page/markup.h"
#include "page/passages.h"

namespace lumivox {
namespace {

using page::found;
using page::refuse;
using page::requireNames;
using Request = page::PassageRequest;

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

std::vector<std::string> commaParts(const std::string& name) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t comma; (comma = name.find(", ", from)) != std::string::npos; from = comma + 2)
    parts.push_back(name.substr(from, comma - from));
  parts.push_back(name.substr(from));
  return parts;
}

/// "3 points : 7 points (sponza)" for "sponza, 3 points" and "sponza, 7 points": parts that all names share
/// at their beginning and at their end are written once. Every name keeps a part of its own.
std::string namesText(const std::vector<std::string>& names, const char* between) {
  std::vector<std::vector<std::string>> all;
  std::size_t fewest = std::string::npos;
  for (const std::string& name : names) {
    all.push_back(commaParts(name));
    fewest = std::min(fewest, all.back().size());
  }
  if (names.size() < 2) return fmt::format("{}", fmt::join(names, between));
  std::vector<std::string> shared, own;
  const auto shareAll = [&](const auto& part) {
    return std::all_of(all.begin(), all.end(),
                       [&](const auto& parts) { return part(parts) == part(all[0]); });
  };
  std::size_t first = 0, last = 0;
  while (first + 1 < fewest && shareAll([&](const auto& parts) { return parts[first]; })) ++first;
  while (first + last + 1 < fewest && shareAll([&](const auto& parts) { return *(parts.end() - 1 - last); }))
    ++last;
  for (const auto& parts : all)
    own.push_back(fmt::format("{}", fmt::join(parts.begin() + first, parts.end() - last, ", ")));
  shared.assign(all[0].begin(), all[0].begin() + first);
  shared.insert(shared.end(), all[0].end() - last, all[0].end());
  const std::string text = fmt::format("{}", fmt::join(own, between));
  return shared.empty() ? text : fmt::format("{} ({})", text, fmt::join(shared, ", "));
}

/// "voxelization : mipmap (isotropic) = 1 : 0.4, published 1 : 0.35: *not reproduced*".
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
  std::string text =
      fmt::format("{} = {}, published {}: {}", namesText(names, isQuotient ? "; " : between),
                  fmt::join(measured, between), fmt::join(published, between), fmt::join(verdicts, ", "));
  if (!asTheWhole) text += fmt::format("; the whole table *{}*", name(result.judged.verdict));
  return page::replaced(text, "|", "\\|");
}

std::string curve(const ReproducedResult& result, const std::string& wanted) {
  const MeasuredCurve& one =
      found(result.curves, "curve", wanted, [](const MeasuredCurve& curve) { return curve.name; });
  return page::replaced(
      curveText(one, result.judgedCurves[static_cast<std::size_t>(&one - result.curves.data())]), "|", "\\|");
}

std::string claim(const ReproducedResult& result, const std::string& wanted) {
  const MeasuredClaim& one =
      found(result.claims, "claim", wanted, [](const MeasuredClaim& claim) { return claim.name; });
  return page::replaced(
      claimText(one, result.judgedClaims[static_cast<std::size_t>(&one - result.claims.data())]), "|", "\\|");
}

std::string passage(const Request& request, const std::vector<ReproducedResult>& results) {
  const ReproducedResult& result = found(results, "result", request.id, [&](const ReproducedResult& one) {
    return one.published.id == request.id ? one.published.id : citedName(one.published);
  });
  if (request.kind == "table") {
    requireNames(request, 0, 0, "table ID");
    return table(result);
  }
  if (request.kind == "ratios") {
    requireNames(request, 1, result.rows.size(), "ratios ID; ROW; ROW ...");
    return ratios(result, request.names);
  }
  if (request.kind == "curve") {
    requireNames(request, 1, 1, "curve ID; CURVE");
    return curve(result, request.names.front());
  }
  if (request.kind == "claim") {
    requireNames(request, 1, 1, "claim ID; CLAIM");
    return claim(result, request.names.front());
  }
  refuse("kind of passage", request.kind, {"table", "ratios", "curve", "claim"});
}

}  // namespace

std::string withReproducedPassages(const std::string& markdown, const std::filesystem::path& file,
                                   const std::vector<ReproducedResult>& results) {
  return page::withPassages(markdown, file, "reproduced",
                            [&](const Request& request) { return passage(request, results); });
}

}  // namespace lumivox
