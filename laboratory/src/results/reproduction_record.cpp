// Stores results of reproductions in a file.
#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <tuple>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/reproduction.h"
#include "results/field_json.h"

namespace lumivox {
namespace results {

constexpr Growth kGrowths[] = {Growth::unsaid, Growth::sublinear, Growth::linear, Growth::superlinear};

/// An enumerator as a word.
template <class Enum>
struct Word {
  Enum& value;
  std::span<const std::remove_const_t<Enum>> all;
};
/// Writes records with their verdicts, for readers without the rule. Reading computes verdicts anew.
template <class Records, class Verdicts>
struct Judged {
  Records& records;
  const Verdicts& verdicts;
};

void setUpFields(auto& setUp, auto&& visit) {
  visit({"why_not"}, setUp.whyNot);
  visit({"failed"}, setUp.failed);
  visit({"measured"}, setUp.measured);  // frame rates are compared as frame times
}

void quantityFields(auto& record, auto&& visit) {
  visit({"measures"}, Word{record.quantity, std::span(kPublishedQuantities)});
  visit({"unit"}, Derived{unit(record.quantity)});
}

void verdictFields(const auto& judged, auto&& visit) {
  visit({"verdict"}, Derived{name(judged.verdict)});
  visit({"why"}, judged.why);
}

void fields(Is<MeasuredRow> auto& row, auto&& visit) {
  visit({"row"}, row.name);
  quantityFields(row, visit);
  visit({"published"}, row.published);
  visit({"over"}, row.over);
  setUpFields(row, visit);
}

void fields(Is<JudgedRow> auto& judged, auto&& visit) {
  visit({"published_ratio"}, judged.publishedRatio);
  visit({"ratio"}, judged.ratio);
  visit({"ratio_low"}, judged.lowRatio);
  visit({"ratio_high"}, judged.highRatio);
  verdictFields(judged, visit);
}

void fields(Is<MeasuredPoint> auto& point, auto&& visit) {
  visit({"x"}, point.x);
  setUpFields(point, visit);
}

void fields(Is<MeasuredCurve> auto& curve, auto&& visit) {
  visit({"curve"}, curve.name);
  visit({"over"}, curve.over);
  quantityFields(curve, visit);
  visit({"published_growth"}, Word{curve.growth, std::span(kGrowths)});
  visit({"points"}, curve.points);
}

void fields(Is<JudgedCurve> auto& judged, auto&& visit) {
  visit({"exponent"}, judged.exponent.value);
  visit({"exponent_uncertainty"}, judged.exponent.uncertainty);
  verdictFields(judged, visit);
}

void fields(Is<ShownPanel> auto& panel, auto&& visit) {
  visit({"panel"}, panel.name);
  visit({"why_not"}, panel.whyNot);
  visit({"failed"}, panel.failed);
  visit({"mean_luminance"}, panel.meanLuminance);
  visit({"radiance"}, panel.radiance);
}

void fields(Is<MeasuredClaim> auto& claim, auto&& visit) {
  visit({"claim"}, claim.name);
  visit({"of"}, Word{claim.quantity, std::span(kClaimedQuantities)});
  visit({"less"}, claim.less);
  visit({"than"}, claim.than);
  visit({"dark_in"}, claim.darkIn);
  visit({"times"}, claim.times);
  visit({"less_value"}, claim.lessValue);
  visit({"than_value"}, claim.thanValue);
  visit({"why_not"}, claim.whyNot);
}

void fields(Is<JudgedClaim> auto& judged, auto&& visit) {
  verdictFields(judged, visit);
}

void fields(Is<ReproducedResult> auto& result, auto&& visit) {
  auto& published = result.published;
  visit({"id"}, published.id);
  visit({"title"}, published.title);
  visit({"paper"}, published.paper);
  visit({"published_on"}, published.device);
  visit({"device"}, result.device.renderer);
  visit({"driver"}, result.device.version);
  visit({"software"}, result.device.software);
  visit({"host"}, result.host);
  visit({"date"}, result.date);
  visit({"scale"}, result.scale);
  visit({"scaled"}, published.scaled);
  visit({"repeats"}, result.repeats);
  visit({"verdict"}, Derived{result.rows.empty() ? "" : name(result.judged.verdict)});
  visit({"why"}, Derived{result.rows.empty() ? std::string() : result.judged.why});
  visit({"rows"}, Judged{result.rows, result.judged.rows});
  visit({"curves"}, Judged{result.curves, result.judgedCurves});
  visit({"panels"}, result.panels);
  visit({"claims"}, Judged{result.claims, result.judgedClaims});
  visit({"exposure_ev"}, result.exposure);
  visit({"set_ups"}, result.setUps);
  visit({"differences"}, published.differences);
  visit({"command"}, result.command);
}

template <class Enum>
Json jsonOf(const Word<Enum>& word) {
  return name(word.value);
}

template <class Enum>
void read(const Json& json, Word<Enum>& word) {
  for (const Enum one : word.all)
    if (json == name(one)) return static_cast<void>(word.value = one);
  throw Error(fmt::format("'{}' is none of its words", json.get<std::string>()));
}

template <class Records, class Verdicts>
Json jsonOf(const Judged<Records, Verdicts>& judged) {
  Json list = jsonOf(judged.records);
  for (std::size_t i = 0; i < list.size(); ++i) list[i].update(jsonOf(judged.verdicts.at(i)));
  return list;
}

template <class Records, class Verdicts>
void read(const Json& json, Judged<Records, Verdicts>& judged) {
  read(json, judged.records);
}

}  // namespace results

namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

std::string countText(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

void compareRows(const ReproducedResult& kept, const PublishedResult& text, std::vector<std::string>& stale) {
  if (kept.rows.size() != text.rows.size())
    return stale.push_back(fmt::format("{}: {} recorded, {} in the text", text.id,
                                       countText(kept.rows.size(), "row"), text.rows.size()));
  for (std::size_t i = 0; i < text.rows.size(); ++i) {
    const MeasuredRow& was = kept.rows[i];
    const PublishedRow& is = text.rows[i];
    if (was.name != is.name || was.over != is.over || was.quantity != is.quantity)
      stale.push_back(
          fmt::format("{}: row '{}' is recorded where the text has '{}'", text.id, was.name, is.name));
    else if (was.published != is.published)
      stale.push_back(fmt::format("{}: row '{}' is recorded with {:g} as published, but the text has {:g}",
                                  text.id, is.name, was.published, is.published));
    else if (const std::string& why = is.absent.empty() ? is.substitute : is.absent;
             !why.empty() && was.whyNot != why && (was.measured || !is.absent.empty()))
      stale.push_back(fmt::format("{}: row '{}' is {} in the text, but not in the record", text.id, is.name,
                                  is.absent.empty() ? "a substitute" : "absent"));
    else if (is.absent.empty() && is.substitute.empty() && was.measured && !was.whyNot.empty())
      stale.push_back(fmt::format("{}: row '{}' is recorded as not comparable, which the text does not say",
                                  text.id, is.name));
  }
}

void compareFigures(const ReproducedResult& kept, const PublishedResult& text,
                    std::vector<std::string>& stale) {
  const auto report = [&](const char* what) {
    stale.push_back(fmt::format("{}: the recorded {} are not those of the text", text.id, what));
  };
  bool same = kept.curves.size() == text.curves.size();
  for (std::size_t i = 0; same && i < text.curves.size(); ++i)
    same = kept.curves[i].name == text.curves[i].name && kept.curves[i].over == text.curves[i].over &&
           kept.curves[i].growth == text.curves[i].growth &&
           kept.curves[i].points.size() == text.curves[i].points.size();
  if (!same) report("curves");
  same = kept.panels.size() == text.panels.size();
  for (std::size_t i = 0; same && i < text.panels.size(); ++i)
    same = kept.panels[i].name == text.panels[i].name;
  if (!same) report("panels");
  const auto told = [](const PublishedClaim& claim) {
    return std::tie(claim.name, claim.less, claim.than, claim.darkIn, claim.quantity, claim.times);
  };
  same = kept.claims.size() == text.claims.size();
  for (std::size_t i = 0; same && i < text.claims.size(); ++i)
    same = told(kept.claims[i]) == told(text.claims[i]);
  if (!same) report("claims");
}

}  // namespace

std::string reproductionsAsJson(const std::vector<ReproducedResult>& all) {
  return Json{{"version", kVersion}, {"results", results::jsonOf(all)}}.dump(1) + "\n";
}

std::vector<ReproducedResult> readReproductions(const std::filesystem::path& file) {
  const std::string text = readFile(file);
  std::string place;
  std::vector<ReproducedResult> found;
  try {
    const Json json = Json::parse(text);
    if (json.at("version") != kVersion)
      throw Error(
          fmt::format("version {} is not known here; expected {}", json.at("version").dump(), kVersion));
    for (const Json& one : json.at("results")) {
      place = fmt::format(", results[{}]", found.size());
      one.at("rows");
      results::read(one, found.emplace_back());
    }
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        fmt::format("{}{}: not results of reproductions as `lumivox reproduce --record` writes them: {}",
                    file.string(), place, error.what()));
  } catch (const Error& error) {
    throw Error(fmt::format("{}{}: {}", file.string(), place, error.what()));
  }
  return found;
}

std::vector<std::string> staleReproductions(const std::vector<ReproducedResult>& results,
                                            const std::vector<PublishedResult>& published) {
  std::vector<std::string> stale;
  for (const PublishedResult& text : published) {
    const auto kept = std::find_if(results.begin(), results.end(),
                                   [&](const ReproducedResult& one) { return one.published.id == text.id; });
    if (kept == results.end()) {
      stale.push_back(fmt::format("{}: nothing is recorded", text.id));
      continue;
    }
    compareRows(*kept, text, stale);
    compareFigures(*kept, text, stale);
    if (kept->published.title != text.title || kept->published.paper != text.paper ||
        kept->published.device != text.device || kept->published.differences != text.differences)
      stale.push_back(
          fmt::format("{}: title, paper, device or differences are not those of the text", text.id));
  }
  for (const ReproducedResult& kept : results)
    if (std::none_of(published.begin(), published.end(),
                     [&](const PublishedResult& text) { return text.id == kept.published.id; }))
      stale.push_back(fmt::format("{}: it is recorded, but there is no such text", kept.published.id));
  return stale;
}

}  // namespace lumivox
