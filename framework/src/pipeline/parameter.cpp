// Parameters of a pass: values with a range, set from numbers and words.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/dsl/document.h"
#include "lumivox/pipeline/pass.h"
#include "pipeline/text_values.h"

namespace lumivox {

namespace {

std::string withUnit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " " + unit;
}

std::string rangeText(const ParamBase& parameter) {
  if (parameter.type() == ParamBase::Type::integer)
    return fmt::format("{}..{}", parameter.low(), parameter.high());
  // As floats, which is how they were given: 0.1f is written 0.1 and not 0.10000000149.
  const float low = static_cast<float>(parameter.low()), high = static_cast<float>(parameter.high());
  return withUnit(fmt::format("{}..{}", low, high), parameter.unit());
}

}  // namespace

ParamBase::ParamBase(Pass* pass, std::string name, Type type, std::string meaning)
    : name_(std::move(name)), meaning_(std::move(meaning)), type_(type) {
  pass->parameters_.push_back(this);
}

// ---- int -----------------------------------------------------------------------------------------------

Param<int>::Param(Pass* pass, std::string name, int value, ParamRange<int> range, std::string meaning)
    : ParamBase(pass, std::move(name), Type::integer, std::move(meaning)), value_(value), default_(value) {
  assert(range.low <= value && value <= range.high);
  low_ = range.low;
  high_ = range.high;
}
std::string Param<int>::valueText() const {
  return fmt::format("{}", value_);
}
std::string Param<int>::defaultText() const {
  return fmt::format("{}", default_);
}
std::string Param<int>::set(double number) {
  if (!(number >= low_ && number <= high_) || number != std::floor(number)) {
    return "must be a whole number in " + rangeText(*this);
  }
  value_ = static_cast<int>(number);
  return {};
}
std::string Param<int>::set(const std::string&) {
  return "must be a whole number in " + rangeText(*this);
}

// ---- float ---------------------------------------------------------------------------------------------

Param<float>::Param(Pass* pass, std::string name, float value, ParamRange<float> range, std::string unit,
                    std::string meaning)
    : ParamBase(pass, std::move(name), Type::number, std::move(meaning)), value_(value), default_(value) {
  assert(range.low <= value && value <= range.high);
  const auto& units = dsl::knownUnits();
  // Its range and its value are in base units.
  std::vector<std::string> names;
  for (const dsl::Unit& one : units)
    if (one.toBase == 1.0) names.emplace_back(one.name);
  if (!unit.empty() && std::find(names.begin(), names.end(), unit) == names.end())
    throw Error(fmt::format("parameter '{}' in '{}', which is no base unit of the texts; expected {}",
                            this->name(), unit, oneOf(names, "none")));
  low_ = range.low;
  high_ = range.high;
  unit_ = std::move(unit);
}
std::string Param<float>::valueText() const {
  return withUnit(fmt::format("{}", value_), unit_);
}
std::string Param<float>::defaultText() const {
  return withUnit(fmt::format("{}", default_), unit_);
}
std::string Param<float>::set(double number) {
  // Compared as floats: the range's ends were given as floats, and 0.1 must fit into 0.1..1.
  const float rounded = static_cast<float>(number);
  if (!(rounded >= static_cast<float>(low_) && rounded <= static_cast<float>(high_))) {
    return "must be a number in " + rangeText(*this);
  }
  value_ = rounded;
  return {};
}
std::string Param<float>::set(const std::string&) {
  return "must be a number in " + rangeText(*this);
}

// ---- flag ----------------------------------------------------------------------------------------------

Param<bool>::Param(Pass* pass, std::string name, bool value, std::string meaning)
    : ParamBase(pass, std::move(name), Type::flag, std::move(meaning)), value_(value), default_(value) {
  choices_ = {"on", "off"};
}
std::string Param<bool>::valueText() const {
  return value_ ? "on" : "off";
}
std::string Param<bool>::defaultText() const {
  return default_ ? "on" : "off";
}
std::string Param<bool>::set(double) {
  return "must be on or off";
}
std::string Param<bool>::set(const std::string& word) {
  if (word != "on" && word != "off") return "must be on or off";
  value_ = word == "on";
  return {};
}

// ---- word ----------------------------------------------------------------------------------------------

WordParam::WordParam(Pass* pass, std::string name, std::size_t value, std::vector<std::string> words,
                     std::string meaning)
    : ParamBase(pass, std::move(name), Type::word, std::move(meaning)), value_(value), default_(value) {
  assert(value < words.size());
  choices_ = std::move(words);
}
std::string WordParam::wordOf(std::string_view name) {
  std::string word;
  for (const char letter : name.substr(0, name.find_last_not_of('_') + 1)) {
    const bool capital = std::isupper(static_cast<unsigned char>(letter)) != 0;
    if (capital) word += '_';
    word += capital ? static_cast<char>(std::tolower(static_cast<unsigned char>(letter))) : letter;
  }
  return word;
}
std::string WordParam::set(double) {
  return fmt::format("must be one of {}", fmt::join(choices_, ", "));
}
std::string WordParam::set(const std::string& word) {
  for (std::size_t i = 0; i < choices_.size(); ++i) {
    if (word == choices_[i]) {
      value_ = i;
      return {};
    }
  }
  return fmt::format("must be one of {}", fmt::join(choices_, ", "));
}

}  // namespace lumivox
