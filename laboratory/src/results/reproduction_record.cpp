// Results of reproductions as a file that stays.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <tuple>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/json.h"
#include "lumivox/results/reproduction.h"

namespace lumivox {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVersion = 1;

double numberOrNothing(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

/// For readers that do not know the rule; on reading it is judged anew.
Json judgedJson(const JudgedRow& judged) {
  return {{"published_ratio", numberJson(judged.publishedRatio)},
          {"ratio", numberJson(judged.ratio)},
          {"ratio_low", numberJson(judged.lowRatio)},
          {"ratio_high", numberJson(judged.highRatio)},
          {"verdict", name(judged.verdict)},
          {"why", judged.why}};
}

void addMeasured(Json& json, const MeasuredSetUp& setUp) {
  json["why_not"] = setUp.whyNot;
  json["failed"] = setUp.failed;
  if (const auto& time = setUp.measured)
    // Frame rates as times of frames: what is compared.
    json["measured"] = {{"median", time->median},
                        {"lower_quartile", time->lowerQuartile},
                        {"upper_quartile", time->upperQuartile},
                        {"smallest", time->smallest},
                        {"largest", time->largest},
                        {"repeats", time->repeats}};
}

void readMeasured(const Json& json, MeasuredSetUp& setUp) {
  setUp.whyNot = json.at("why_not");
  setUp.failed = json.at("failed");
  if (!json.contains("measured")) return;
  const Json& time = json.at("measured");
  setUp.measured = TimingStatistics{time.at("median"),   time.at("lower_quartile"), time.at("upper_quartile"),
                                    time.at("smallest"), time.at("largest"),        time.at("repeats")};
}

PublishedQuantity quantityOf(const Json& json) {
  for (const PublishedQuantity quantity : kPublishedQuantities)
    if (json.at("measures") == name(quantity)) return quantity;
  throw Error(fmt::format("nothing is measured as '{}'", json.at("measures").get<std::string>()));
}

Json rowJson(const MeasuredRow& row, const JudgedRow& judged) {
  Json json{{"row", row.name},
            {"measures", name(row.quantity)},
            {"unit", unit(row.quantity)},
            {"published", row.published}};
  if (!row.over.empty()) json["over"] = row.over;
  addMeasured(json, row);
  json.update(judgedJson(judged));
  return json;
}

MeasuredRow readRow(const Json& json) {
  MeasuredRow row;
  row.name = json.at("row");
  row.quantity = quantityOf(json);
  row.published = json.at("published");
  row.over = json.value("over", "");
  readMeasured(json, row);
  return row;
}

Json curveJson(const MeasuredCurve& curve, const JudgedCurve& judged) {
  Json points = Json::array();
  for (const MeasuredPoint& point : curve.points) {
    Json one{{"x", numberJson(point.x)}};
    addMeasured(one, point);
    points.push_back(std::move(one));
  }
  return {{"curve", curve.name},
          {"over", curve.over},
          {"measures", name(curve.quantity)},
          {"unit", unit(curve.quantity)},
          {"published_growth", name(curve.growth)},
          {"exponent", numberJson(judged.exponent.value)},
          {"exponent_uncertainty", numberJson(judged.exponent.uncertainty)},
          {"verdict", name(judged.verdict)},
          {"why", judged.why},
          {"points", std::move(points)}};
}

MeasuredCurve readCurve(const Json& json) {
  MeasuredCurve curve;
  curve.name = json.at("curve");
  curve.over = json.at("over");
  curve.quantity = quantityOf(json);
  for (const Growth growth : {Growth::sublinear, Growth::linear, Growth::superlinear})
    if (json.at("published_growth") == name(growth)) curve.growth = growth;
  for (const Json& one : json.at("points")) {
    MeasuredPoint point;
    point.x = numberOrNothing(one.at("x"));
    readMeasured(one, point);
    curve.points.push_back(std::move(point));
  }
  return curve;
}

Json claimJson(const MeasuredClaim& claim, const JudgedClaim& judged) {
  Json json{{"claim", claim.name}, {"of", name(claim.quantity)}, {"less", claim.less}, {"than", claim.than}};
  if (!claim.darkIn.empty()) json["dark_in"] = claim.darkIn;
  if (claim.times != 1.0) json["times"] = claim.times;
  json["less_value"] = numberJson(claim.lessValue);
  json["than_value"] = numberJson(claim.thanValue);
  json["why_not"] = claim.whyNot;
  json["verdict"] = name(judged.verdict);
  json["why"] = judged.why;
  return json;
}

MeasuredClaim readClaim(const Json& json) {
  MeasuredClaim claim;
  claim.name = json.at("claim");
  for (const ClaimedQuantity quantity : kClaimedQuantities)
    if (json.at("of") == name(quantity)) claim.quantity = quantity;
  claim.less = json.at("less");
  claim.than = json.at("than");
  claim.darkIn = json.value("dark_in", "");
  claim.times = json.value("times", 1.0);
  claim.lessValue = numberOrNothing(json.at("less_value"));
  claim.thanValue = numberOrNothing(json.at("than_value"));
  claim.whyNot = json.at("why_not");
  return claim;
}

Json resultJson(const ReproducedResult& result) {
  Json rows = Json::array(), curves = Json::array(), panels = Json::array(), claims = Json::array();
  for (std::size_t i = 0; i < result.claims.size(); ++i)
    claims.push_back(claimJson(result.claims[i], result.judgedClaims[i]));
  for (std::size_t i = 0; i < result.rows.size(); ++i)
    rows.push_back(rowJson(result.rows[i], result.judged.rows[i]));
  for (std::size_t i = 0; i < result.curves.size(); ++i)
    curves.push_back(curveJson(result.curves[i], result.judgedCurves[i]));
  for (const ShownPanel& panel : result.panels) {
    panels.push_back({{"panel", panel.name},
                      {"why_not", panel.whyNot},
                      {"failed", panel.failed},
                      {"mean_luminance", numberJson(panel.meanLuminance)}});
    if (!panel.radiance) panels.back()["radiance"] = false;
  }
  return {{"id", result.published.id},
          {"title", result.published.title},
          {"paper", result.published.paper},
          {"published_on", result.published.device},
          {"device", result.device.renderer},
          {"driver", result.device.version},
          {"software", result.device.software},
          {"host", result.host},
          {"date", result.date},
          {"scale", result.scale},
          {"scaled", result.published.scaled},
          {"repeats", result.repeats},
          {"verdict", result.rows.empty() ? "" : name(result.judged.verdict)},
          {"why", result.rows.empty() ? "" : result.judged.why},
          {"rows", std::move(rows)},
          {"curves", std::move(curves)},
          {"panels", std::move(panels)},
          {"claims", std::move(claims)},
          {"exposure_ev", result.exposure},
          {"set_ups", result.setUps},
          {"differences", result.published.differences},
          {"command", result.command}};
}

ReproducedResult readResult(const Json& json) {
  ReproducedResult result;
  PublishedResult& published = result.published;
  published.id = json.at("id");
  published.title = json.at("title");
  published.paper = json.at("paper");
  published.device = json.at("published_on");
  published.scaled = json.at("scaled").get<std::vector<std::string>>();
  published.differences = json.at("differences").get<std::vector<std::string>>();
  result.device.renderer = json.at("device");
  result.device.version = json.at("driver");
  result.device.software = json.at("software");
  result.host = json.at("host");
  result.date = json.at("date");
  result.scale = json.at("scale");
  result.repeats = json.at("repeats");
  result.exposure = json.at("exposure_ev");
  result.setUps = json.at("set_ups").get<std::vector<std::string>>();
  result.command = json.at("command");
  for (const Json& row : json.at("rows")) result.rows.push_back(readRow(row));
  for (const Json& curve : json.at("curves")) result.curves.push_back(readCurve(curve));
  for (const Json& one : json.at("panels")) {
    ShownPanel panel;
    panel.name = one.at("panel");
    panel.whyNot = one.at("why_not");
    panel.failed = one.at("failed");
    panel.radiance = one.value("radiance", true);
    panel.meanLuminance = numberOrNothing(one.at("mean_luminance"));
    result.panels.push_back(std::move(panel));
  }
  // Results that were kept before there were claims have none.
  for (const Json& one : json.value("claims", Json::array())) result.claims.push_back(readClaim(one));
  return result;
}

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

std::string reproductionsAsJson(const std::vector<ReproducedResult>& results) {
  Json all = Json::array();
  for (const ReproducedResult& result : results) all.push_back(resultJson(result));
  return Json{{"version", kVersion}, {"results", std::move(all)}}.dump(1) + "\n";
}

std::vector<ReproducedResult> readReproductions(const std::filesystem::path& file) {
  const std::string text = readFile(file);
  std::string place;
  std::vector<ReproducedResult> results;
  try {
    const Json json = Json::parse(text);
    if (json.at("version") != kVersion)
      throw Error(
          fmt::format("version {} is not known here; expected {}", json.at("version").dump(), kVersion));
    for (const Json& one : json.at("results")) {
      place = fmt::format(", results[{}]", results.size());
      results.push_back(readResult(one));
    }
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        fmt::format("{}{}: not results of reproductions as `lumivox reproduce --record` writes them: {}",
                    file.string(), place, error.what()));
  } catch (const Error& error) {
    throw Error(fmt::format("{}{}: {}", file.string(), place, error.what()));
  }
  return results;
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
