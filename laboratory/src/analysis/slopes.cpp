#include "lumivox/analysis/slopes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "lumivox/analysis/comparison.h"
#include "lumivox/results/json.h"
#include "lumivox/results/text.h"

namespace lumivox {
namespace {

using Json = nlohmann::ordered_json;

/// The RMSE without the reference's noise: the root of the difference of squares.
Measured withoutReferenceNoise(const ComponentError& error) {
  const Measured rmse = error.error.rmse;
  const double square = rmse.value * rmse.value - error.error.noiseFloor * error.error.noiseFloor;
  if (!(square > 0.0)) return {0.0, 0.0};
  return {std::sqrt(square), rmse.value / std::sqrt(square) * rmse.uncertainty};
}

/// Points of one pipeline that differ in one parameter.
struct Series {
  std::string pipeline, parameter, others;
  std::vector<std::pair<double, const ReportPoint*>> points;
};

std::vector<Series> seriesOf(const std::vector<const ReportPoint*>& points) {
  std::map<std::tuple<std::string, std::string, std::string>, Series> all;
  std::set<std::string>
      progressive;  // pipelines with accumulated frames; a point without a number of frames has one
  for (const ReportPoint* point : points)
    if (point->parameters.count(kAccumulatedFrames) != 0) progressive.insert(point->pipeline);
  for (const ReportPoint* point : points) {
    if (!point->failure.empty()) continue;
    ParameterValues parameters = point->parameters;
    if (progressive.count(point->pipeline) != 0)
      parameters[kAccumulatedFrames].number = framesOf(point->parameters);
    for (const auto& [name, value] : parameters) {
      if (!value.word.empty()) continue;
      ParameterValues others = parameters;
      others.erase(name);
      const std::string text = others.empty() ? std::string() : parametersText(others);
      Series& series = all[{point->pipeline, name, text}];
      series.pipeline = point->pipeline;
      series.parameter = name;
      series.others = text;
      series.points.emplace_back(value.number, point);
    }
  }
  std::vector<Series> result;
  for (auto& [key, series] : all) {
    std::set<double> values;
    for (const auto& [value, point] : series.points) values.insert(value);
    if (values.size() >= 3) result.push_back(std::move(series));
  }
  return result;
}

void add(std::vector<SweepSlope>& slopes, const Series& series, const std::string& output,
         const std::string& quantity, const std::vector<PowerLawPoint>& points) {
  SweepSlope slope{series.pipeline,    series.parameter, series.others, output, quantity, 0.0, 0.0,
                   fitPowerLaw(points)};
  if (std::isnan(slope.law.slope.value)) return;
  const auto [low, high] = std::minmax_element(
      points.begin(), points.end(), [](const PowerLawPoint& a, const PowerLawPoint& b) { return a.x < b.x; });
  slope.low = low->x;
  slope.high = high->x;
  slopes.push_back(std::move(slope));
}

}  // namespace

std::vector<SweepSlope> slopesOf(const std::vector<const ReportPoint*>& points) {
  std::vector<SweepSlope> slopes;
  for (const Series& series : seriesOf(points)) {
    // By output and quantity, in the order of the first point.
    std::vector<std::pair<std::pair<std::string, std::string>, std::vector<PowerLawPoint>>> quantities;
    const auto put = [&](const std::string& output, const char* quantity, double x, const Measured& y) {
      const std::pair<std::string, std::string> key(output, quantity);
      auto found = std::find_if(quantities.begin(), quantities.end(),
                                [&](const auto& entry) { return entry.first == key; });
      if (found == quantities.end()) found = quantities.insert(quantities.end(), {key, {}});
      found->second.push_back({x, y});
    };
    for (const auto& [value, point] : series.points) {
      for (const ComponentError& error : point->errors) {
        put(error.output, error.bias ? "bias" : "misses", value, withoutReferenceNoise(error));
        if (error.bias && error.parts.noise.value > 0.0) put(error.output, "noise", value, error.parts.noise);
      }
      if (point->frameMs.repeats > 0) put("", "time", value, medianOf(point->frameMs));
    }
    for (const auto& [key, measured] : quantities) add(slopes, series, key.first, key.second, measured);
  }
  return slopes;
}

Json toJson(const std::vector<SweepSlope>& slopes) {
  Json list = Json::array();
  for (const SweepSlope& slope : slopes)
    list.push_back({{"pipeline", slope.pipeline},
                    {"parameter", slope.parameter},
                    {"others", slope.others},
                    {"output", slope.output},
                    {"quantity", slope.quantity},
                    {"low", slope.low},
                    {"high", slope.high},
                    {"values", slope.law.points},
                    {"slope", toJson(slope.law.slope)},
                    {"plateau", toJson(slope.law.plateau)},
                    {"has_plateau", slope.law.hasPlateau()},
                    {"slope_above_plateau", numberJson(slope.law.slopeAbove)}});
  return list;
}

}  // namespace lumivox
