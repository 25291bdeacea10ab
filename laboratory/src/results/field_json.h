// Records as JSON and back, after the lists of their fields.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "lumivox/base/error.h"
#include "lumivox/results/json.h"
#include "results/fields.h"
#include "results/json_text.h"

namespace lumivox::results {

using Json = nlohmann::ordered_json;

/// Times are in ms, and say so.
template <class T>
constexpr const char* kUnitSuffix = std::same_as<T, TimingStatistics> ? "_ms" : "";

template <class T>
Json jsonOf(const T& value) {
  if constexpr (std::same_as<T, double>) {
    return numberJson(value);
  } else if constexpr (std::same_as<T, glm::ivec3>) {
    return {value.x, value.y, value.z};
  } else if constexpr (std::same_as<T, StressOutcome>) {
    return name(value);
  } else if constexpr (std::same_as<T, std::optional<GatheredVoxels>>) {
    return toJson(value);
  } else if constexpr (std::same_as<T, std::vector<ComponentError>>) {
    Json list = Json::array();
    for (const ComponentError& error : value) list.push_back(jsonOf(error));
    return list;
  } else if constexpr (HasFields<const T>) {
    Json json = Json::object();
    fields(value, [&]<class M>(const Field& field, const M& member) {
      json[std::same_as<M, double> ? std::string(field.name) + kUnitSuffix<T> : field.name] = jsonOf(member);
    });
    return json;
  } else {
    return value;
  }
}

template <class Flag>
Json jsonOf(const Against<Flag>& against) {
  return against.bias ? "bias" : "misses";
}

template <class Error>
Json jsonOf(const Metrics<Error>& metrics) {
  Json json = Json::object();
  for (const NamedMetric& metric : metricsOf(metrics.error)) json[metric.name] = jsonOf(metric);
  return json;
}

template <class Point>
Json jsonOf(const Passes<Point>& passes) {
  const ReportPoint& point = passes.point;
  std::vector<std::string> names = point.passOrder;
  // The work is counted before the times are taken, which say in which order the passes ran.
  for (const auto& [name, work] : point.passWork)
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  Json list = Json::array();
  for (const std::string& name : names) {
    Json pass{{"name", name}};
    if (list.size() >= point.passOrder.size()) pass["ran"] = false;
    const auto add = [&](const char* what, const auto& all) {
      if (const auto found = all.find(name); found != all.end()) pass[what] = jsonOf(found->second);
    };
    add("device", point.passDeviceMs);
    add("host", point.passHostMs);
    add("bytes", point.passBytes);
    add("work", point.passWork);
    list.push_back(std::move(pass));
  }
  return list;
}

template <class T>
void read(JsonText& text, T& value);

template <class Flag>
void read(JsonText& text, Against<Flag>& against) {
  against.bias = text.string() == "bias";
}

template <class Error>
void read(JsonText& text, Metrics<Error>& metrics) {
  text.object([&](const std::string& name) {
    NamedMetric metric;
    read(text, metric);
    metric.name = name;
    setMetric(metrics.error, metric);  // one of a later version is passed over
  });
}

template <class Point>
void read(JsonText& text, Passes<Point>& passes) {
  Point& point = passes.point;
  text.array([&] {
    std::string name;
    bool ran = true;
    text.object([&](const std::string& key) {
      if (key == "name") return read(text, name);
      if (key == "ran") return read(text, ran);
      if (key == "device") return read(text, point.passDeviceMs[name]);
      if (key == "host") return read(text, point.passHostMs[name]);
      if (key == "bytes") return read(text, point.passBytes[name]);
      if (key == "work") return read(text, point.passWork[name]);
      text.skip();
    });
    if (ran) point.passOrder.push_back(name);
  });
}

/// How many of the record's fields were there. One of an earlier version lacks some, one of a later version
/// has more.
template <class T>
int readFields(JsonText& text, T& record) {
  int found = 0;
  text.object([&](std::string_view key) {
    const int before = found;
    // Without the suffix of numbers: no other field has the same name up to it.
    const std::string_view suffix = kUnitSuffix<T>;
    if (!suffix.empty() && key.ends_with(suffix)) key.remove_suffix(suffix.size());
    fields(record, [&](const Field& field, auto&& member) {
      if (found > before || key != field.name) return;
      read(text, member);
      ++found;
    });
    if (found == before) text.skip();
  });
  return found;
}

template <class T>
void read(JsonText& text, T& value) {
  if constexpr (std::same_as<T, double>) {
    value = text.takesNull() ? std::numeric_limits<double>::quiet_NaN() : text.number<double>();
  } else if constexpr (std::same_as<T, bool>) {
    value = text.boolean();
  } else if constexpr (std::integral<T>) {
    value = text.number<T>();
  } else if constexpr (std::same_as<T, std::string>) {
    value = text.string();
  } else if constexpr (std::same_as<T, glm::ivec3>) {
    int axis = 0;
    text.array([&] { read(text, value[axis++ % 3]); });
  } else if constexpr (std::same_as<T, StressOutcome>) {
    value = stressOutcomeNamed(text.string()).value_or(StressOutcome::broken);
  } else if constexpr (std::same_as<T, std::optional<GatheredVoxels>>) {
    if (!text.takesNull()) read(text, value.emplace());
  } else if constexpr (HasFields<T>) {
    readFields(text, value);
  } else if constexpr (requires { value.emplace_back(); }) {
    text.array([&] { read(text, value.emplace_back()); });
  } else {
    text.object([&](const std::string& key) { read(text, value[key]); });
  }
}

/// A record as the store keeps it.
template <class T>
std::string recordText(const T& record) {
  return textOf(jsonOf(record), -1);
}

template <class T>
T recordFrom(const std::string& json) {
  try {
    T record;
    JsonText text(json);
    read(text, record);
    text.end();
    return record;
  } catch (const Error& error) {
    throw Error(fmt::format("'{}' is no record of a results store: {}", json.substr(0, 200), error.what()));
  }
}

}  // namespace lumivox::results
