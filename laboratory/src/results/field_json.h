// Converts records to JSON and back by the lists of their fields.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lumivox/base/error.h"
#include "lumivox/results/json.h"
#include "results/fields.h"

namespace lumivox::results {

using Json = nlohmann::ordered_json;

template <class T>
concept IsOptional = requires(T& value) {
  value.has_value();
};
template <class T>
concept IsVector = requires(T& value) {
  value.emplace_back();
};
template <class T>
concept IsVec3 = std::same_as<T, glm::vec3> || std::same_as<T, glm::ivec3>;

/// NaN is null. Absent optional values are not written.
template <class T>
Json jsonOf(const T& value) {
  if constexpr (std::same_as<T, double>) {
    return numberJson(value);
  } else if constexpr (IsVec3<T>) {
    return {value.x, value.y, value.z};
  } else if constexpr (std::same_as<T, StressOutcome>) {
    return name(value);
  } else if constexpr (IsOptional<const T>) {
    return value ? jsonOf(*value) : Json(nullptr);
  } else if constexpr (std::same_as<T, ParameterValue>) {
    return value.word.empty() ? numberJson(value.number) : Json(value.word);
  } else if constexpr (HasFields<const T>) {
    Json json = Json::object();
    fields(value, [&]<class M>(const Field& field, const M& member) {
      if constexpr (IsOptional<const M>)
        if (!member) return;
      json[field.name] = jsonOf(member);
    });
    return json;
  } else if constexpr (IsVector<T>) {
    Json list = Json::array();
    for (const auto& one : value) list.push_back(jsonOf(one));
    return list;
  } else if constexpr (requires { typename T::mapped_type; }) {
    Json json = Json::object();
    for (const auto& [name, one] : value) json[name] = jsonOf(one);
    return json;
  } else {
    return value;
  }
}

template <class T>
Json jsonOf(const Derived<T>& derived) {
  return jsonOf(derived.value);
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
  return jsonOf(passesOf(passes.point));
}

/// Missing fields keep their values, and unknown ones are ignored.
template <class T>
void read(const Json& json, T& value) {
  if constexpr (std::same_as<T, double>) {
    value = json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
  } else if constexpr (std::same_as<T, bool>) {
    value = json.is_boolean() ? json.get<bool>() : json.get<int>() != 0;  // SQLite has no Boolean type
  } else if constexpr (IsVec3<T>) {
    for (int axis = 0; axis < 3; ++axis) value[axis] = json.at(static_cast<std::size_t>(axis));
  } else if constexpr (std::same_as<T, StressOutcome>) {
    value = stressOutcomeNamed(json).value_or(StressOutcome::broken);
  } else if constexpr (IsOptional<T>) {
    if (!json.is_null()) read(json, value.emplace());
  } else if constexpr (HasFields<T>) {
    fields(value, [&](const Field& field, auto&& member) {
      if (const auto found = json.find(field.name); found != json.end()) read(*found, member);
    });
  } else if constexpr (IsVector<T>) {
    for (const Json& one : json) read(one, value.emplace_back());
  } else if constexpr (requires { typename T::mapped_type; }) {
    for (const auto& [name, one] : json.items()) read(one, value[name]);
  } else {
    value = json.get<T>();
  }
}

template <class T>
void read(const Json&, Derived<T>&) {}

template <class Flag>
void read(const Json& json, Against<Flag>& against) {
  against.bias = json == "bias";
}

template <class Error>
void read(const Json& json, Metrics<Error>& metrics) {
  for (const auto& [name, one] : json.items()) {
    NamedMetric metric;
    read(one, metric);
    metric.name = name;
    setMetric(metrics.error, metric);
  }
}

template <class Point>
void read(const Json& json, Passes<Point>& passes) {
  for (const Json& one : json) {
    PassFields pass;
    read(one, pass);
    addPass(passes.point, std::move(pass));
  }
}

}  // namespace lumivox::results
