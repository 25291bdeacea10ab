#include "viewer/panel_rows.h"

#include <fmt/format.h>

namespace lumivox::viewer {

using Kind = Row::Kind;

Row heading(const std::string& label) {
  Row row;
  row.kind = Kind::heading;
  row.name = row.label = label;
  return row;
}
Row text(const std::string& name, const std::string& label, const std::string& value,
         const std::string& tooltip) {
  Row row;
  row.name = name;
  row.label = label;
  row.value = value;
  row.tooltip = tooltip;
  return row;
}
Row toggle(const std::string& name, const std::string& label, bool on, const std::string& statement,
           const std::string& tooltip) {
  Row row = text(name, label, on ? "on" : "off", tooltip);
  row.kind = Kind::toggle;
  row.on = on;
  row.statement = statement;
  return row;
}
Row button(const std::string& name, const std::string& label, const std::string& statement,
           const std::string& tooltip) {
  Row row = text(name, label, {}, tooltip);
  row.kind = Kind::button;
  row.statement = statement;
  return row;
}
Row choice(const std::string& name, const std::string& label, const std::string& value,
           std::vector<std::string> choices, const std::string& statement, const std::string& tooltip) {
  Row row = text(name, label, value, tooltip);
  row.kind = Kind::choice;
  row.choices = std::move(choices);
  row.statement = statement;
  return row;
}
Row number(const std::string& name, const std::string& label, double value, double low, double high,
           bool integer, const std::string& statement, const std::string& tooltip) {
  Row row = text(name, label, integer ? fmt::format("{:.0f}", value) : fmt::format("{:.6g}", value), tooltip);
  row.kind = Kind::number;
  row.number = value;
  row.low = low;
  row.high = high;
  row.integer = integer;
  row.logarithmic = low > 0.0 && high / low > 100.0;
  row.statement = statement;
  return row;
}

Row triple(const std::string& name, const std::string& label, const std::array<double, 3>& values, double low,
           double high, const std::string& statement, const std::string& tooltip) {
  Row row = text(name, label, fmt::format("{:.4g} {:.4g} {:.4g}", values[0], values[1], values[2]), tooltip);
  row.kind = Kind::triple;
  row.numbers = values;
  row.low = low;
  row.high = high;
  row.statement = statement;
  return row;
}

}  // namespace lumivox::viewer
