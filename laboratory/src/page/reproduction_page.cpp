// Reproduced tables and figures for readers.
#include "lumivox/page/reproduction_page.h"

#include <fmt/format.h>

#include <cmath>

#include "lumivox/analysis/judge.h"
#include "lumivox/page/contact_sheet.h"
#include "lumivox/results/text.h"
#include "page/document.h"
#include "page/markup.h"
#include "page_assets.h"

namespace lumivox {
namespace {

using namespace page;

std::string withUnit(double value, const char* unit) {
  return *unit == '\0' ? fmt::format("{:.6g}", value) : fmt::format("{:.4g} {}", value, unit);
}

std::string measuredText(const MeasuredRow& row) {
  if (!row.measured) return "-";
  constexpr double kMillisecondsPerSecond = 1000.0;
  if (row.quantity == PublishedQuantity::frameRate)
    return fmt::format("{:.3g} {}", kMillisecondsPerSecond / row.measured->median, unit(row.quantity));
  if (row.quantity == PublishedQuantity::time) {
    const std::string quartiles = formatQuartiles(*row.measured);
    return formatMilliseconds(row.measured->median) + (quartiles.empty() ? "" : " " + quartiles) + " ms";
  }
  return withUnit(row.measured->median, unit(row.quantity));
}

std::string ratioText(double ratio) {
  return std::isfinite(ratio) ? fmt::format("{:.3g}", ratio) : "-";
}

std::string heading(const ReproducedResult& result) {
  return result.published.id + ": " + result.published.title;
}

std::string capital(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string markdownCell(const std::string& text) {
  return replaced(text, "|", "\\|");
}

std::string panelText(const ShownPanel& panel) {
  std::string text = panel.name;
  if (std::isfinite(panel.meanLuminance))
    text += fmt::format(", mean {:.3g}{}", panel.meanLuminance, panel.radiance ? " W/(sr m²)" : "");
  return panel.whyNot.empty() ? text : text + ": " + panel.whyNot;
}

std::string pointText(const MeasuredCurve& curve, const MeasuredPoint& point) {
  MeasuredRow row;
  static_cast<MeasuredSetUp&>(row) = point;
  row.quantity = curve.quantity;
  return fmt::format("{:.6g}: {}{}", point.x, measuredText(row),
                     point.whyNot.empty() ? "" : ", " + point.whyNot);
}

}  // namespace

const std::vector<std::string>& reproductionHeadings() {
  static const std::vector<std::string> names = {
      "row", "published", "measured", "published ratio", "measured ratio", "verdict"};
  return names;
}

std::vector<std::string> reproductionCells(const MeasuredRow& row, const JudgedRow& judged) {
  const bool spread = judged.lowRatio < judged.highRatio;
  return {
      row.over.empty() ? row.name : row.name + " / " + row.over,
      withUnit(row.published, unit(row.quantity)),
      measuredText(row),
      ratioText(judged.publishedRatio),
      ratioText(judged.ratio) +
          (spread ? fmt::format(" [{:.3g}, {:.3g}]", judged.lowRatio, judged.highRatio) : std::string()),
      judged.why.empty() ? name(judged.verdict) : fmt::format("{}: {}", name(judged.verdict), judged.why)};
}

std::string verdictText(const ReproducedResult& result) {
  if (result.rows.empty()) return {};
  return capital(name(result.judged.verdict)) + ": " + result.judged.why + ".";
}

std::string curveText(const MeasuredCurve& curve, const JudgedCurve& judged) {
  std::string text = fmt::format("{}^{:.2f}", curve.over, judged.exponent.value);
  if (!std::isfinite(judged.exponent.value)) text = "-";
  if (judged.exponent.uncertainty > 0.0) text += fmt::format(" ± {:.2f}", judged.exponent.uncertainty);
  if (curve.growth != Growth::unsaid) text += fmt::format(" (published: {})", name(curve.growth));
  text += fmt::format(", {}", name(judged.verdict));
  return judged.why.empty() ? text : text + ": " + judged.why;
}

std::string claimText(const MeasuredClaim& claim, const JudgedClaim& judged) {
  const char* unit = claim.quantity == ClaimedQuantity::luminance ? " W/(sr m²)"
                     : claim.quantity == ClaimedQuantity::colour  ? " of the mean luminance between channels"
                                                                  : " of the mean luminance between pixels";
  std::string text = fmt::format("{}: {}", claim.name, name(judged.verdict));
  if (std::isfinite(claim.lessValue) && std::isfinite(claim.thanValue)) {
    text += fmt::format(" ('{}' {:.3g}, '{}' {:.3g}{}", claim.less, claim.lessValue, claim.than,
                        claim.thanValue, unit);
    if (claim.times != 1.0) text += fmt::format(", which counts {:g} times", claim.times);
    if (!claim.darkIn.empty()) text += fmt::format(", where '{}' is darkest", claim.darkIn);
    text += ")";
  }
  return judged.why.empty() ? text : text + ": " + judged.why;
}

std::vector<std::string> reproductionNotes(const ReproducedResult& result) {
  const PublishedResult& published = result.published;
  std::vector<std::string> notes;
  notes.push_back(fmt::format(
      "Published on: {}. Measured on: {} ({}{}), {}, {}.",
      published.device.empty() ? "not said" : published.device, result.device.renderer, result.device.version,
      result.device.software ? ", a software rasteriser" : "", result.host, result.date));
  if (result.scale != 1.0) {
    std::string parameters;
    for (const std::string& name : published.scaled) parameters += ", " + name;
    notes.push_back(fmt::format("Reduced: image sides{} times {:.4g}.", parameters, result.scale));
  }
  for (const std::string& setUp : result.setUps) notes.push_back("Measured: " + setUp + ".");
  for (const std::string& difference : published.differences) notes.push_back("Differs: " + difference + ".");
  notes.push_back("Repeat: " + result.command);
  return notes;
}

std::string reproductionRule() {
  return fmt::format(
      "Ratios are to the first comparable row, or to the row that is named. A row is reproduced when its measured ratio, {1} standard uncertainties to "
      "both sides, lies within a factor of {0} of the published one; not reproduced when all of that lies beyond; not "
      "comparable when the set-up is not here or is another one, or when the uncertainty reaches across the limit. A table "
      "is reproduced when a row is, none is not, and no two rows are in another order than published. Frame rates "
      "count as times of frames. Brackets behind times are quartiles. A curve grows as a power of what it is drawn over: less than linearly where the exponent, {1} "
      "standard uncertainties to both sides, is below 1, linearly where from its first point to its last it grows as that does within the same factor. Of images "
      "the paper's claims are judged, each by one number of two panels: which one has less. Images without a claim have no verdict.",
      kReproducedFactor, kReproducedSigmas);
}

std::string reproductionTable(const std::vector<MeasuredRow>& rows, const JudgedTable& judged) {
  std::string text =
      fmt::format("| {} |\n|---|---|---|---|---|---|\n", fmt::join(reproductionHeadings(), " | "));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<std::string> cells = reproductionCells(rows[i], judged.rows[i]);
    for (std::string& cell : cells) cell = markdownCell(cell);
    text += fmt::format("| {} |\n", fmt::join(cells, " | "));
  }
  return text;
}

std::string reproductionsAsMarkdown(const std::vector<ReproducedResult>& results) {
  std::string text = "# Published tables and figures, measured here\n\n" + reproductionRule() + "\n";
  for (const ReproducedResult& result : results) {
    const std::string verdict = verdictText(result);
    text += fmt::format("\n## {}\n\n{}.{}\n\n", heading(result), result.published.paper,
                        verdict.empty() ? "" : " **" + verdict + "**");
    if (!result.rows.empty()) text += reproductionTable(result.rows, result.judged) + "\n";
    for (std::size_t i = 0; i < result.curves.size(); ++i) {
      text += fmt::format("**{}**: {}\n\n", result.curves[i].name,
                          curveText(result.curves[i], result.judgedCurves[i]));
      for (const MeasuredPoint& point : result.curves[i].points)
        text += fmt::format("- {} {}\n", result.curves[i].over, pointText(result.curves[i], point));
      text += "\n";
    }
    const bool fractions = std::any_of(result.panels.begin(), result.panels.end(),
                                       [](const ShownPanel& panel) { return !panel.radiance; });
    for (const ShownPanel& panel : result.panels) text += "- Panel " + panelText(panel) + "\n";
    for (std::size_t i = 0; i < result.claims.size(); ++i)
      text += "- Claim: " + claimText(result.claims[i], result.judgedClaims[i]) + "\n";
    if (!result.panels.empty())
      text += fmt::format("- Exposure of all panels{}: {}\n", fractions ? " of radiance" : "",
                          exposureText(result.exposure));
    for (const std::string& note : reproductionNotes(result)) text += "- " + note + "\n";
  }
  return text;
}

std::string reproductionsAsHtml(const std::vector<ReproducedResult>& results) {
  using Json = nlohmann::ordered_json;
  Json shown = Json::array(), images = Json::array();
  for (const ReproducedResult& result : results) {
    Json rows = Json::array(), curves = Json::array(), panels = Json::array(), claims = Json::array();
    for (std::size_t i = 0; i < result.rows.size(); ++i)
      rows.push_back(reproductionCells(result.rows[i], result.judged.rows[i]));
    for (std::size_t i = 0; i < result.curves.size(); ++i)
      curves.push_back(result.curves[i].name + ": " + curveText(result.curves[i], result.judgedCurves[i]));
    for (const ShownPanel& panel : result.panels) panels.push_back(panelText(panel));
    for (std::size_t i = 0; i < result.claims.size(); ++i)
      claims.push_back(claimText(result.claims[i], result.judgedClaims[i]));
    shown.push_back({{"heading", heading(result)},
                     {"title", result.published.title},
                     {"paper", result.published.paper},
                     {"verdict", verdictText(result)},
                     {"rows", std::move(rows)},
                     {"curves", std::move(curves)},
                     {"panels", std::move(panels)},
                     {"claims", std::move(claims)},
                     {"notes", reproductionNotes(result)}});
    Json own = Json::object();
    if (!result.panels.empty()) own["sheet"] = base64(encodePng(contactSheet(result)));
    if (!result.curves.empty()) own["curves"] = base64(curvesAsSvg(result));
    images.push_back(std::move(own));
  }
  Document document;
  document.title = "Published tables and figures, measured here";
  document.data = {{"title", document.title},
                   {"rule", reproductionRule()},
                   {"headings", reproductionHeadings()},
                   {"results", std::move(shown)}};
  document.images = {{"results", std::move(images)}};
  document.scripts = {assets::kReproductionPageJs};
  return html(document);
}

}  // namespace lumivox
