// Parameters of a pass: values with a range, set from numbers and words.
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cctype>
#include <cmath>
#include <memory>

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
  // Written as floats, as they were given: 0.1f is 0.1 and not 0.10000000149.
  const float low = static_cast<float>(parameter.low()), high = static_cast<float>(parameter.high());
  return withUnit(fmt::format("{}..{}", low, high), parameter.unit());
}

}  // namespace

ParamBase::ParamBase(Pass* pass, std::string name, Type type, std::string meaning)
    : name_(std::move(name)), meaning_(std::move(meaning)), type_(type) {
  auto& all = pass->parameters_;
  all.insert(pass->publishedForm_ != nullptr ? all.end() - 1 : all.end(), this);
}

void ParamBase::addPublishedForm(Pass* pass) {
  if (pass->publishedForm_ == nullptr) pass->ownPublishedForm_ = std::make_unique<PublishedForm>(pass);
}

PublishedForm::PublishedForm(Pass* pass, std::string more)
    : Param<bool>(pass, "as_published", false, {}), pass_(*pass), more_(std::move(more)) {
  if (pass->publishedForm_ != nullptr) {  // added by an earlier parameter
    pass->parameters_.pop_back();
    pass->ownPublishedForm_.reset();
  }
  pass->publishedForm_ = this;
}

std::string PublishedForm::meaning() const {
  std::vector<std::string> words;
  for (const ParamBase* parameter : pass_.parameters())
    if (const std::string text = parameter->publishedText(); !text.empty())
      words.push_back(fmt::format("'{} {}'", parameter->name(), text));
  if (!more_.empty()) words.push_back(more_);
  return fmt::format("as printed: {}", fmt::join(words, ", "));
}

std::string Pass::applyPublished() {
  if (publishedForm_ == nullptr) return {};
  const bool on = *publishedForm_;
  std::vector<std::string> contradictions;
  for (ParamBase* parameter : parameters_) {
    const std::string printed = parameter->publishedText();
    if (printed.empty()) continue;
    if (!parameter->isStated())
      on ? parameter->setPublished() : parameter->setDefault();
    else if (on && parameter->valueText() != printed)
      contradictions.push_back(fmt::format("'{0} {1}' is published, and '{0} {2}' given", parameter->name(),
                                           printed, parameter->valueText()));
  }
  if (contradictions.empty()) return {};
  return fmt::format("as_published is on: {}; expected the published value, or none",
                     fmt::join(contradictions, "; "));
}

// ---- int -----------------------------------------------------------------------------------------------

Param<int>::Param(Pass* pass, std::string name, int value, ParamRange<int> range, std::string meaning,
                  MaybePublished<int> printed)
    : ParamBase(pass, std::move(name), Type::integer, std::move(meaning)),
      value_(value),
      default_(value),
      published_(printed) {
  assert(range.low <= value && value <= range.high);
  assert(!printed || (range.low <= printed->value && printed->value <= range.high));
  low_ = range.low;
  high_ = range.high;
  if (printed) addPublishedForm(pass);
}
std::string Param<int>::publishedText() const {
  return published_ ? fmt::format("{}", published_->value) : std::string();
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
                    std::string meaning, MaybePublished<float> printed)
    : ParamBase(pass, std::move(name), Type::number, std::move(meaning)),
      value_(value),
      default_(value),
      published_(printed) {
  assert(range.low <= value && value <= range.high);
  assert(!printed || (range.low <= printed->value && printed->value <= range.high));
  const auto& units = dsl::knownUnits();
  // Range and value are in base units.
  std::vector<std::string> names;
  for (const dsl::Unit& one : units)
    if (one.toBase == 1.0) names.emplace_back(one.name);
  if (!unit.empty() && std::find(names.begin(), names.end(), unit) == names.end())
    throw Error(fmt::format("parameter '{}' in '{}', which is no base unit of the texts; expected {}",
                            this->name(), unit, oneOf(names, "none")));
  low_ = range.low;
  high_ = range.high;
  unit_ = std::move(unit);
  if (printed) addPublishedForm(pass);
}
std::string Param<float>::publishedText() const {
  return published_ ? withUnit(fmt::format("{}", published_->value), unit_) : std::string();
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

Param<bool>::Param(Pass* pass, std::string name, bool value, std::string meaning,
                   MaybePublished<bool> printed)
    : ParamBase(pass, std::move(name), Type::flag, std::move(meaning)),
      value_(value),
      default_(value),
      published_(printed) {
  choices_ = {"on", "off"};
  if (printed) addPublishedForm(pass);
}
std::string Param<bool>::publishedText() const {
  if (!published_) return {};
  return published_->value ? "on" : "off";
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
                     std::string meaning, std::optional<std::size_t> printed)
    : ParamBase(pass, std::move(name), Type::word, std::move(meaning)),
      value_(value),
      default_(value),
      published_(printed) {
  assert(value < words.size());
  choices_ = std::move(words);
  if (printed) addPublishedForm(pass);
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
