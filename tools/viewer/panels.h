// The contents of the panels as data: the window draws them, and tests read them.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "viewer/session.h"

namespace lumivox::viewer {

/// One line of a panel. A control has the statement that it performs, with "{}" for its value.
struct Row {
  enum class Kind { heading, text, number, triple, choice, toggle, button, bars, stacks, points };
  Kind kind = Kind::text;
  std::string name;  ///< unique in its panel; scripts click it by this name
  std::string label, value, tooltip;
  std::string statement;  ///< empty: no control
  double number = 0.0, low = 0.0, high = 0.0;
  std::array<double, 3> numbers{};  ///< of a triple; its statement takes all three
  bool integer = false, logarithmic = false, on = false, changed = false;
  std::vector<std::string> choices;
  /// A small button behind a control with a word, such as "default" or "published".
  struct Reset {
    std::string word, statement;
  };
  std::vector<Reset> resets;
  /// A bar: label and length. A part of a stack, from the bottom up: label, column and height. A point:
  /// label, x, y, and the statement that restores it.
  struct Mark {
    std::string label;
    double x = 0.0, y = 0.0;
    std::string statement;
  };
  std::vector<Mark> marks;
};

struct Panel {
  std::string name, title;
  std::vector<Row> rows;
};

/// All panels: look, judge, time, need, change, scene, keep.
std::vector<Panel> panelsOf(const Session& session);
/// The panels and the state, as JSON.
nlohmann::ordered_json recordOf(const Session& session);

/// A control's statement with the value in place of "{}".
std::string filledIn(const std::string& statement, const std::string& value);
/// Three numbers as values of a statement.
std::string written(const std::array<double, 3>& numbers);

}  // namespace lumivox::viewer
