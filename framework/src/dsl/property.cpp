// Checks of one property's values.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dsl/wording.h"

namespace lumivox::dsl {
namespace {

// Within the normal numbers of single precision, which range from 1.2e-38 to 3.4e38.
constexpr double kSmallestMagnitude = 1e-37, kLargestMagnitude = 1e37;

bool mustCarryUnit(const Dimension& dimension) {
  return dimension == kAngle || dimension == kAngularSpeed;
}

const char* kindName(const Value& value) {
  switch (value.kind) {
    case ValueKind::number:
      return "the number";
    case ValueKind::word:
      return "the word";
    case ValueKind::text:
      return "the string";
    case ValueKind::list:
      return "the list";
    case ValueKind::range:
      return "the range";
    case ValueKind::parameter:
      return "the parameter";
  }
  return "";
}

std::string shown(const Value& value) {
  constexpr std::size_t kShown = 40;
  const std::string text = value.written();
  return text.size() <= kShown ? text : text.substr(0, kShown) + "...";
}

class PropertyChecker {
 public:
  PropertyChecker(const Document& document, const Property& property,
                  const PropertySpecification& specification, std::vector<Diagnostic>& findings)
      : document_(document), property_(property), specification_(specification), findings_(findings) {}

  void run() {
    if (specification_.type == PropertyType::any) return;
    if (property_.values.empty()) {
      return report(property_.place, static_cast<int>(property_.word.size()),
                    fmt::format("property '{}' has no value", property_.word), expectation(specification_));
    }
    if (!checkCount()) return;
    sharedUnit_ = unitOfAll();
    for (std::size_t i = 0; i < property_.values.size(); ++i) checkValue(property_.values[i], i);
    checkUnitsOfVector();
  }

 private:
  void report(const SourcePlace& place, int length, std::string what, std::string expected,
              std::string suggestion = {}) {
    findings_.push_back(
        document_.finding(place, length, std::move(what), std::move(expected), std::move(suggestion)));
  }

  bool checkCount() {
    const std::size_t count = property_.values.size();
    bool right = false;
    switch (specification_.type) {
      case PropertyType::vector2:
      case PropertyType::resolution:
        right = count == 2;
        break;
      case PropertyType::vector3:
        right = count == 3;
        break;
      case PropertyType::axisAndNumber:
        right = count == 4;
        break;
      case PropertyType::oneOrThree:
        right = count == 1 || count == 3;
        break;
      default:
        right = count == 1;
        break;
    }
    if (right) return true;
    // A value of the wrong type is the more helpful finding.
    if (count == 1 && isVector() && property_.values[0].kind != ValueKind::number &&
        property_.values[0].kind != ValueKind::parameter) {
      reportType(property_.values[0]);
      return false;
    }
    const Value& last = property_.values.back();
    report(last.place, last.length,
           fmt::format("property '{}' has {} value{}", property_.word, count, count == 1 ? "" : "s"),
           expectation(specification_));
    return false;
  }

  bool isVector() const {
    switch (specification_.type) {
      case PropertyType::vector2:
      case PropertyType::vector3:
      case PropertyType::oneOrThree:
      case PropertyType::axisAndNumber:
      case PropertyType::resolution:
        return true;
      default:
        return false;
    }
  }

  void reportType(const Value& value) {
    report(value.place, value.length,
           fmt::format("{} {} does not suit property '{}'", kindName(value), shown(value), property_.word),
           expectation(specification_));
  }

  void checkValue(const Value& value, std::size_t index) {
    if (value.kind == ValueKind::parameter) return;
    constexpr std::size_t kAxisComponents = 3;
    switch (specification_.type) {
      case PropertyType::number:
      case PropertyType::vector2:
      case PropertyType::vector3:
      case PropertyType::oneOrThree:
        return checkNumber(value, specification_.dimension, true, false);
      case PropertyType::axisAndNumber:
        if (index < kAxisComponents) return checkNumber(value, kNoDimension, false, false);
        return checkNumber(value, specification_.dimension, true, false);
      case PropertyType::integer:
      case PropertyType::resolution:
        return checkNumber(value, kNoDimension, true, true);
      case PropertyType::word:
        return checkWord(value, specification_.choices);
      case PropertyType::flag:
        return checkWord(value, {"on", "off"});
      case PropertyType::text:
        if (value.kind != ValueKind::text) reportType(value);
        return;
      case PropertyType::name:
        if (value.kind != ValueKind::text && value.kind != ValueKind::word) reportType(value);
        return;
      case PropertyType::output:
        if (value.kind != ValueKind::word || value.text.find('/') != std::string::npos) reportType(value);
        return;
      case PropertyType::list:
        return checkList(value);
      case PropertyType::range:
        return checkRange(value);
      case PropertyType::any:
        return;
    }
  }

  void checkWord(const Value& value, const std::vector<std::string>& choices) {
    if (value.kind != ValueKind::word) return reportType(value);
    if (choices.empty() || std::find(choices.begin(), choices.end(), value.text) != choices.end()) return;
    report(value.place, value.length,
           fmt::format("unknown value '{}' of property '{}'", value.text, property_.word), oneOf(choices),
           suggestionFor(findings_, value.text, choices));
  }

  void checkList(const Value& value) {
    if (value.kind != ValueKind::list) return reportType(value);
    for (const Value& item : value.items) {
      if (!specification_.choices.empty()) {
        checkWord(item, specification_.choices);
      } else if (item.kind == ValueKind::number) {
        checkNumber(item, specification_.dimension, true, false);
      } else if (item.kind == ValueKind::range) {
        reportType(item);
      }
    }
  }

  void checkRange(const Value& value) {
    if (value.kind != ValueKind::range) return reportType(value);
    const Value& low = value.items.at(0);
    const Value& high = value.items.at(1);
    if (low.kind == ValueKind::parameter || high.kind == ValueKind::parameter) return;
    const bool integers =
        specification_.dimension == kNoDimension && specification_.low == std::floor(specification_.low);
    checkNumber(low, specification_.dimension, true, integers);
    checkNumber(high, specification_.dimension, true, integers);
    if (low.inBaseUnits() > high.inBaseUnits()) {
      report(value.place, value.length, fmt::format("the range {} runs backwards", shown(value)),
             "the lower end first");
    }
  }

  void checkNumber(const Value& value, const Dimension& dimension, bool bounded, bool integer) {
    if (value.kind != ValueKind::number) return reportType(value);
    if (integer && !value.integral) {
      return report(value.place, value.length, fmt::format("{} is not a whole number", shown(value)),
                    expectation(specification_));
    }
    if (value.unit && !(value.unit->dimension == dimension)) {
      return report(
          value.place, value.length,
          fmt::format("unit '{}' measures {}, not {}", value.unit->name, value.unit->dimension.text(),
                      dimension == kNoDimension ? "a plain number" : dimension.text()),
          quantity(dimension));
    }
    if (!value.unit && mustCarryUnit(dimension)) {
      return report(value.place, value.length,
                    fmt::format("{} of property '{}' has no unit", shown(value), property_.word),
                    quantity(dimension));
    }
    const double number =
        sharedUnit_ != nullptr && !value.unit ? value.number * sharedUnit_->toBase : value.inBaseUnits();
    // Factors of units are rounded binary fractions, but a bound itself must pass in every unit.
    const double tolerance = 1e-12 * std::abs(number);
    if (bounded && (number < specification_.low - tolerance || number > specification_.high + tolerance)) {
      return report(value.place, value.length,
                    fmt::format("{} of property '{}' is out of range", shown(value), property_.word),
                    expectation(specification_));
    }
    // Holds for all properties, because renderers compute in single precision.
    const double magnitude = std::abs(number);
    if (magnitude != 0.0 && !(magnitude >= kSmallestMagnitude && magnitude <= kLargestMagnitude)) {
      report(
          value.place, value.length,
          fmt::format("{} of property '{}' has no value in single precision", shown(value), property_.word),
          fmt::format("0, or a magnitude from {:g} to {:g} in base units", kSmallestMagnitude,
                      kLargestMagnitude));
    }
  }

  /// The unit behind the last component, when it holds for all.
  const Unit* unitOfAll() const {
    if (!isVector() || specification_.type == PropertyType::axisAndNumber || property_.values.size() < 2)
      return nullptr;
    const std::vector<Value>& values = property_.values;
    const bool alone = std::none_of(values.begin(), values.end() - 1,
                                    [](const Value& value) { return value.unit.has_value(); });
    return alone && values.back().unit ? &*values.back().unit : nullptr;
  }

  /// Refuses units on some components but not on the last: the meaning of the others would be a guess.
  void checkUnitsOfVector() {
    if (!isVector() || specification_.type == PropertyType::axisAndNumber) return;
    std::size_t withUnit = 0;
    for (const Value& value : property_.values) withUnit += value.unit.has_value() ? 1u : 0u;
    const Value& last = property_.values.back();
    if (withUnit == 0 || withUnit == property_.values.size() || (withUnit == 1 && last.unit)) return;
    report(last.place, last.length,
           fmt::format("only some components of property '{}' have a unit", property_.word),
           "a unit after every component, or one after the last for all");
  }

  const Document& document_;
  const Property& property_;
  const PropertySpecification& specification_;
  std::vector<Diagnostic>& findings_;
  const Unit* sharedUnit_ = nullptr;
};

}  // namespace

void checkProperty(const Document& document, const Property& property,
                   const PropertySpecification& specification, std::vector<Diagnostic>& findings) {
  PropertyChecker(document, property, specification, findings).run();
}

std::string oneOf(const std::vector<std::string>& words) {
  if (words.size() == 1) return "'" + words.front() + "'";
  return "one of " + listed(words);
}

std::string quantity(const Dimension& dimension) {
  if (dimension == kAngle) return "an angle such as 39 deg";
  if (dimension == kAngularSpeed) return "an angular speed such as 30 deg/s";
  const std::string units = unitNames(dimension);
  if (dimension == kNoDimension) return "a number without unit";
  if (dimension == kLength) return fmt::format("a length in {}", units);
  if (dimension == kTime) return fmt::format("a time in {}", units);
  if (dimension == kSpeed) return fmt::format("a speed in {}", units);
  return fmt::format("a number in {}", units.empty() ? dimension.text() : units);
}

std::string quantityText(double value, const Dimension& dimension) {
  if (dimension == kAngle) return fmt::format("{:.6g} deg", value * 180.0 / std::numbers::pi);
  if (dimension == kAngularSpeed) return fmt::format("{:.6g} deg/s", value * 180.0 / std::numbers::pi);
  for (const Unit& unit : knownUnits()) {
    if (unit.dimension == dimension && unit.toBase == 1.0) return fmt::format("{:.6g} {}", value, unit.name);
  }
  return fmt::format("{:.6g}", value);
}

std::string rangeText(const PropertySpecification& specification) {
  const bool low = std::isfinite(specification.low), high = std::isfinite(specification.high);
  const auto text = [&](double value) { return quantityText(value, specification.dimension); };
  if (low && high) return fmt::format("from {} to {}", text(specification.low), text(specification.high));
  if (low) return fmt::format("at least {}", text(specification.low));
  if (high) return fmt::format("at most {}", text(specification.high));
  return {};
}

std::string expectation(const PropertySpecification& specification) {
  const Dimension& dimension = specification.dimension;
  const std::string bounds = rangeText(specification).empty() ? "" : ", " + rangeText(specification);
  const std::string unit = dimension == kNoDimension ? "" : fmt::format(" ({})", quantity(dimension));
  switch (specification.type) {
    case PropertyType::number:
      return (dimension == kNoDimension ? "a number" : quantity(dimension)) + bounds;
    case PropertyType::integer:
      return "a whole number" + bounds;
    case PropertyType::vector2:
      return "two numbers" + unit + bounds;
    case PropertyType::vector3:
      return "three numbers" + unit + bounds;
    case PropertyType::oneOrThree:
      return "one number or three" + unit + bounds;
    case PropertyType::axisAndNumber:
      return "an axis of three numbers and " + quantity(dimension) + bounds;
    case PropertyType::resolution:
      return "two whole numbers, width and height" + bounds;
    case PropertyType::word:
      return specification.choices.empty() ? "a word" : oneOf(specification.choices);
    case PropertyType::text:
      return "a string in double quotes";
    case PropertyType::name:
      return "a name";
    case PropertyType::list:
      return specification.choices.empty() ? "a list in brackets" + unit + bounds
                                           : "a list in brackets of " + oneOf(specification.choices);
    case PropertyType::range:
      return "a range LOW..HIGH" + unit + bounds;
    case PropertyType::output:
      return "an output PASS.PORT";
    case PropertyType::flag:
      return "on or off";
    case PropertyType::any:
      return "a value";
  }
  return {};
}

}  // namespace lumivox::dsl
