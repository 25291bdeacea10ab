#include <numbers>

#include "dsl/lexer.h"

namespace lumivox::dsl {
namespace {

std::string power(const char* name, int exponent) {
  return exponent == 1 ? name : std::string(name) + '^' + std::to_string(exponent);
}

}  // namespace

std::string Dimension::text() const {
  std::string above, below;
  const auto add = [&](const char* name, int exponent) {
    std::string& side = exponent > 0 ? above : below;
    if (exponent == 0) return;
    if (!side.empty()) side += ' ';
    side += power(name, exponent > 0 ? exponent : -exponent);
  };
  add("length", length);
  add("angle", angle);
  add("time", time);
  if (above.empty() && below.empty()) return "no unit";
  if (below.empty()) return above;
  return (above.empty() ? "1" : above) + '/' + below;
}

const std::vector<Unit>& knownUnits() {
  constexpr double kDegree = std::numbers::pi / 180.0;
  static const std::vector<Unit> units = {
      {"m", kLength, 1.0},
      {"cm", kLength, 0.01},
      {"mm", kLength, 0.001},
      {"km", kLength, 1000.0},
      {"s", kTime, 1.0},
      {"ms", kTime, 0.001},
      {"min", kTime, 60.0},
      {"deg", kAngle, kDegree},
      {"rad", kAngle, 1.0},
      {"/m", kInverseLength, 1.0},
      {"/cm", kInverseLength, 100.0},
      {"/km", kInverseLength, 0.001},
      {"m/s", kSpeed, 1.0},
      {"cm/s", kSpeed, 0.01},
      {"deg/s", kAngularSpeed, kDegree},
      {"rad/s", kAngularSpeed, 1.0},
  };
  return units;
}

const Unit* findUnit(const std::string& name) {
  for (const Unit& unit : knownUnits()) {
    if (unit.name == name) return &unit;
  }
  return nullptr;
}

std::vector<std::string> unitNameList() {
  std::vector<std::string> names;
  for (const Unit& unit : knownUnits()) names.push_back(unit.name);
  return names;
}

std::string unitNames(const Dimension& dimension) {
  std::vector<std::string> names;
  for (const Unit& unit : knownUnits()) {
    if (unit.dimension == dimension) names.push_back(unit.name);
  }
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) text += i + 1 == names.size() ? " or " : ", ";
    text += names[i];
  }
  return text;
}

}  // namespace lumivox::dsl
