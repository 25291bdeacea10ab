// What can be changed: parameters of the pipeline and of its passes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viewer/panel_rows.h"

namespace lumivox::viewer {

Panel changePanel(const Session& session) {
  const Side& side = session.state().sides.front();
  Panel panel{"change", "Change", {}};
  panel.rows.push_back(button("undo", fmt::format("undo ({})", session.undoable()), "undo 1", "Ctrl Z"));
  panel.rows.push_back(button("redo", fmt::format("redo ({})", session.redoable()), "redo 1", "Ctrl Y"));
  panel.rows.push_back(button("reset", "all to defaults", "reset \"all\""));
  panel.rows.push_back(heading("of the pipeline"));
  for (const PipelineParameter& parameter : side.pipeline->parameters) {
    const auto set = side.values.find(parameter.name);
    const ParameterValue& value = set == side.values.end() ? parameter.value : set->second;
    const std::string statement = "set { " + parameter.name + " {} }";
    const std::string tooltip = "default " + parameter.value.text();
    Row row =
        !parameter.choices.empty()
            ? choice(parameter.name, parameter.name, value.text(), parameter.choices, statement, tooltip)
            : number(parameter.name, parameter.name, value.number, parameter.low.value_or(0.0),
                     parameter.high.value_or(std::max(1.0, 4.0 * parameter.value.number)),
                     parameter.value.number == std::floor(parameter.value.number) &&
                         parameter.high.value_or(0.5) == std::floor(parameter.high.value_or(0.5)),
                     statement, tooltip);
    row.changed = set != side.values.end() && !(set->second == parameter.value);
    panel.rows.push_back(std::move(row));
  }
  const RenderedResult rendered = session.rendered();
  if (rendered == nullptr || !rendered->sides.front().error.empty()) return panel;
  for (const PassContract& pass : rendered->sides.front().contracts) {
    if (pass.parameters.empty()) continue;
    Row title = heading(pass.name);
    title.tooltip = pass.technique + "." + pass.pass + ": " + pass.meaning;
    panel.rows.push_back(std::move(title));
    for (const PassParameter& parameter : pass.parameters) {
      const std::string name = pass.name + "." + parameter.name;
      const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
      const std::string statement = "set " + pass.name + " { " + parameter.name + " {}" + unit + " }";
      const std::string tooltip = parameter.meaning + "; default " + parameter.defaultText;
      Row row = parameter.number
                    ? number(name, parameter.name + (unit.empty() ? "" : "," + unit),
                             std::strtod(parameter.value.c_str(), nullptr), parameter.low, parameter.high,
                             parameter.integer, statement, tooltip)
                    : choice(name, parameter.name, parameter.value, parameter.choices, statement, tooltip);
      row.changed = parameter.value != parameter.defaultText;
      panel.rows.push_back(std::move(row));
    }
  }
  return panel;
}

}  // namespace lumivox::viewer
