// The panel of changes: parameters of the pipeline and of its passes, and their resets.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viewer/panel_rows.h"

namespace lumivox::viewer {
namespace {

const std::vector<std::string> kSwitch{"off", "on"};

bool isSwitch(const std::string& value) {
  return std::find(kSwitch.begin(), kSwitch.end(), value) != kSwitch.end();
}

/// The value that selects the published form: "on" for a switch `as_published`, or the choice of that name.
/// Empty if there is none.
std::string publishedWord(const std::string& name, const std::vector<std::string>& choices) {
  if (name == "as_published") return "on";
  for (const char* word : {"as_published", "published"})
    if (std::find(choices.begin(), choices.end(), word) != choices.end()) return word;
  return {};
}

void addResets(Row& row, const std::string& value, const std::string& byDefault, const std::string& published,
               const std::string& back) {
  row.changed = value != byDefault;
  row.tooltip += "\ndefault " + byDefault;
  if (row.changed) row.resets.push_back({"default", back});
  if (published.empty()) return;
  row.tooltip += "\npublished " + published;
  if (value != published) row.resets.push_back({"published", filledIn(row.statement, published)});
}

/// The pass parameters that take their value from this parameter of the pipeline.
std::vector<const PassParameter*> boundTo(const Side& side, const std::vector<PassContract>& contracts,
                                          const std::string& name) {
  std::vector<const PassParameter*> bound;
  for (const PassText& pass : side.pipeline->passes)
    for (const PassContract& contract : contracts) {
      if (contract.name != pass.name) continue;
      for (const dsl::Item& item : pass.block->items) {
        if (!item.property || item.property->values.empty()) continue;
        const dsl::Value& value = item.property->values.front();
        if (value.kind != dsl::ValueKind::parameter || value.text != name) continue;
        for (const PassParameter& parameter : contract.parameters)
          if (parameter.name == item.property->word) bound.push_back(&parameter);
      }
    }
  return bound;
}

Row ofPipeline(const Side& side, const std::vector<PassContract>& contracts,
               const PipelineParameter& parameter) {
  const auto set = side.values.find(parameter.name);
  const ParameterValue& value = set == side.values.end() ? parameter.value : set->second;
  std::string unit = value.word.empty() && value.dimension == dsl::kAngle ? " rad" : "", tooltip;
  for (const PassParameter* bound : boundTo(side, contracts, parameter.name)) {
    if (tooltip.find(bound->meaning) == std::string::npos)
      tooltip += (tooltip.empty() ? "" : "\n") + bound->meaning;
    if (!bound->unit.empty()) unit = " " + bound->unit;
  }
  const std::string statement = "set { " + parameter.name + " {}" + unit + " }";
  std::vector<std::string> choices = parameter.choices;
  if (choices.empty() && isSwitch(value.word)) choices = kSwitch;
  if (choices.empty() && !value.word.empty()) choices = {value.word};
  Row row;
  if (!choices.empty()) {
    row = choice(parameter.name, parameter.name, value.text(), choices, statement, tooltip);
    row.tooltip += fmt::format("\none of {}", fmt::join(choices, ", "));
  } else {
    const double low = parameter.low.value_or(0.0),
                 high = parameter.high.value_or(std::max(1.0, 4.0 * parameter.value.number));
    const auto isWhole = [](double number) { return number == std::floor(number); };
    row =
        number(parameter.name, parameter.name + (unit.empty() ? "" : "," + unit), value.number, low, high,
               isWhole(parameter.value.number) && isWhole(parameter.high.value_or(0.5)), statement, tooltip);
    if (parameter.low) row.tooltip += fmt::format("\n{}..{}{}", low, high, unit);
  }
  addResets(row, value.text(), parameter.value.text(), publishedWord(parameter.name, choices),
            "reset " + quoted(parameter.name));
  return row;
}

Row ofPass(const PassContract& pass, const PassParameter& parameter) {
  const std::string name = pass.name + "." + parameter.name;
  const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
  const std::string statement = "set " + pass.name + " { " + parameter.name + " {}" + unit + " }";
  Row row;
  if (parameter.number) {
    row = number(name, parameter.name + (unit.empty() ? "" : "," + unit),
                 std::strtod(parameter.value.c_str(), nullptr), parameter.low, parameter.high,
                 parameter.integer, statement, parameter.meaning);
    row.tooltip += fmt::format("\n{}..{}{}", parameter.low, parameter.high, unit);
  } else {
    row = choice(name, parameter.name, parameter.value, parameter.choices, statement, parameter.meaning);
    row.tooltip += fmt::format("\none of {}", fmt::join(parameter.choices, ", "));
  }
  addResets(row, parameter.value, parameter.defaultText, publishedWord(parameter.name, parameter.choices),
            filledIn(statement, parameter.defaultText));
  return row;
}

}  // namespace

Panel changePanel(const Session& session) {
  const Side& side = session.state().sides.front();
  const RenderedResult rendered = session.rendered();
  std::vector<PassContract> contracts;
  if (rendered != nullptr && rendered->sides.front().error.empty())
    contracts = rendered->sides.front().contracts;
  Panel panel{"change", "Change", {}};
  std::vector<Row>& rows = panel.rows;
  rows.push_back(button("undo", fmt::format("undo ({})", session.undoable()), "undo 1", "Ctrl Z"));
  rows.push_back(button("redo", fmt::format("redo ({})", session.redoable()), "redo 1", "Ctrl Y"));
  rows.push_back(button("reset", "all as in the text", "reset \"all\""));
  const std::size_t published = rows.size();
  rows.push_back(heading("of the pipeline"));
  for (const PipelineParameter& parameter : side.pipeline->parameters)
    rows.push_back(ofPipeline(side, contracts, parameter));
  for (const PassContract& pass : contracts) {
    if (pass.parameters.empty()) continue;
    rows.push_back(heading(pass.name));
    rows.back().tooltip = pass.technique + "." + pass.pass + ": " + pass.meaning;
    for (const PassParameter& parameter : pass.parameters) rows.push_back(ofPass(pass, parameter));
  }
  std::string statements;
  for (const Row& row : rows)
    for (const Row::Reset& reset : row.resets)
      if (reset.word == "published") statements += (statements.empty() ? "" : "\n") + reset.statement;
  if (!statements.empty())
    rows.insert(rows.begin() + static_cast<std::ptrdiff_t>(published),
                button("published", "all as published", statements,
                       "every word that stands for a paper's own form; numbers are not known"));
  return panel;
}

}  // namespace lumivox::viewer
