// Reproduced tables and figures for readers: Markdown, a page of HTML, sheets and curves.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/results/reproduction.h"

namespace lumivox {

/// Markdown, or a page of HTML with sheets and curves in it.
std::string reproductionsAsMarkdown(const std::vector<ReproducedResult>& results);
std::string reproductionsAsHtml(const std::vector<ReproducedResult>& results);
/// The cells of one row: name, published and measured number, both ratios, verdict.
std::vector<std::string> reproductionCells(const MeasuredRow& row, const JudgedRow& judged);
/// Under these words.
const std::vector<std::string>& reproductionHeadings();
/// Rows as a table of Markdown.
std::string reproductionTable(const std::vector<MeasuredRow>& rows, const JudgedTable& judged);
/// "Reproduced: ...", with the count of rows; empty for a result of images alone.
std::string verdictText(const ReproducedResult& result);
/// "triangles^0.93 ± 0.02 (published: sublinear), reproduced".
std::string curveText(const MeasuredCurve& curve, const JudgedCurve& judged);
/// "SENTENCE: reproduced ('a' 0.1, 'b' 0.2 W/(sr m²), where 'c' is darkest)".
std::string claimText(const MeasuredClaim& claim, const JudgedClaim& judged);
/// The rule in words.
std::string reproductionRule();
/// Devices, the reduction, what was measured and how it differs, for whoever reads the numbers.
std::vector<std::string> reproductionNotes(const ReproducedResult& result);

/// The points of all curves: curve, x and its name, median, quartiles, unit, repeats, why not (RFC 4180).
std::string curvesAsCsv(const ReproducedResult& result);
/// The curves side by side on logarithmic axes, with quartiles, and a line of slope 1 to compare with.
std::string curvesAsSvg(const ReproducedResult& result);

/// Markdown with passages between `<!-- reproduced KIND ID; NAME; ... -->` and `<!-- end -->` that are
/// written from kept results:
///     table ID               all rows that were measured
///     ratios ID; ROW; ...    those rows as 1 : a : b, each divided by the first, as measured and as
///     published curve ID; CURVE        how it grows
///     claim ID; CLAIM        what both panels have, and the verdict
/// Error that names `file` and the line for a passage that is not closed, of an unknown kind, or whose
/// result, row or curve is not there.
std::string withReproducedPassages(const std::string& markdown, const std::filesystem::path& file,
                                   const std::vector<ReproducedResult>& results);

}  // namespace lumivox
