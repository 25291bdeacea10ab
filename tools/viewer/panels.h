// What the panels show, as a record: a window draws it, and a test reads it.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "viewer/session.h"

namespace lumivox::viewer {

/// One line of a panel. Controls carry the statement that using them performs, with "{}" for the value.
struct Row {
  enum class Kind { heading, text, number, triple, choice, toggle, button, bars, stacks, points };
  Kind kind = Kind::text;
  std::string name;  ///< unique in its panel; what scripts click
  std::string label, value, tooltip;
  std::string statement;  ///< empty: nothing to be done
  double number = 0.0, low = 0.0, high = 0.0;
  std::array<double, 3> numbers{};  ///< of a triple, whose statement takes all three
  bool integer = false, logarithmic = false, on = false, changed = false;
  std::vector<std::string> choices;
  /// Small buttons behind it, by a word each: back to the default, to what was published.
  struct Reset {
    std::string word, statement;
  };
  std::vector<Reset> resets;
  /// Of bars: label and length; of stacks: label, column and height, from the bottom up; of points: label, x
  /// and y, and the statement that goes back to it.
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

/// What a control's statement becomes with a value.
std::string filledIn(const std::string& statement, const std::string& value);
/// Three numbers as a statement has them.
std::string written(const std::array<double, 3>& numbers);

}  // namespace lumivox::viewer
