// What is made and how it is judged: statements that can be undone, and undoing them.
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "viewer/session.h"

namespace lumivox::viewer {
namespace {

namespace fs = std::filesystem;

glm::vec3 colourOf(const Action& action) {
  const std::vector<double> n = action.numbers();
  return n.size() == 1
             ? glm::vec3(static_cast<float>(n[0]))
             : glm::vec3(static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2]));
}
glm::vec3 colourOf(const dsl::Property& property) {
  return colourOf(Action{nullptr, &property, nullptr});
}

}  // namespace

void Session::choosePipeline(std::size_t side, const std::string& name) {
  for (const auto& pipeline : pipelines_)
    if (pipeline->file.stem() == name || pipeline->file == name) {
      state_.sides.resize(std::max(state_.sides.size(), side + 1));
      state_.sides[side] = {pipeline, {}};
      return;
    }
  if (fs::path(name).extension() == ".pipeline") {
    auto pipeline = std::make_shared<const Pipeline>(Pipeline::load(name));
    pipelines_.push_back(pipeline);
    state_.sides.resize(std::max(state_.sides.size(), side + 1));
    state_.sides[side] = {std::move(pipeline), {}};
    watchFiles();
    return;
  }
  std::vector<std::string> names;
  for (const auto& pipeline : pipelines_) names.push_back(pipeline->file.stem().string());
  const std::string nearest = nearestWord(name, names);
  throw Error(fmt::format("no pipeline '{}'; expected a file, or one of {}{}", name, fmt::join(names, ", "),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

void Session::setParameters(const Action& action) {
  Side& side = state_.sides.front();
  if (!action.block->header.empty()) {
    side.pipeline = std::make_shared<const Pipeline>(
        withPassParameters(*side.pipeline, action.block->header.front().text, *action.block));
    return;
  }
  std::vector<std::string> settings;
  for (const dsl::Item& item : action.block->items)
    if (item.property) {
      if (item.property->values.size() != 1)
        throw DiagnosticsError(
            {action.document->finding(item.property->place, static_cast<int>(item.property->word.size()),
                                      "'" + item.property->word + "' has no single value", "one value")});
      settings.push_back(item.property->word + "=" + item.property->values.front().written());
    }
  for (const auto& [name, value] : side.pipeline->settings(settings)) side.values[name] = value;
}

void Session::resetParameter(const std::string& name) {
  Side& side = state_.sides.front();
  if (name == "all") {
    for (const auto& pipeline : pipelines_)
      if (pipeline->file == side.pipeline->file) side = {pipeline, {}};
    side.values.clear();
  } else {
    if (side.values.erase(name) != 0) return;
    const auto& parameters = side.pipeline->parameters;
    if (std::none_of(parameters.begin(), parameters.end(), [&](const auto& one) { return one.name == name; }))
      throw Error(fmt::format("reset {}: the pipeline has no such parameter", name));
  }
}

void Session::stepBack(std::vector<ViewState>& from, std::vector<ViewState>& to, int steps) {
  for (int i = 0; i < steps && !from.empty(); ++i) {
    ViewState before = std::move(from.back());
    from.pop_back();
    to.push_back(state_);
    // Where one looks from, and how, is nothing that is undone.
    ViewState now = state_;
    now.sides = std::move(before.sides);
    now.edits = std::move(before.edits);
    now.keepEverything = before.keepEverything;
    now.seed = before.seed;
    state_ = std::move(now);
  }
}

bool Session::doChange(const Action& action) {
  const std::string& word = action.word();
  const auto requirePart = [&](const std::string& name) {
    const std::vector<std::string> parts = partsOf(*scene_);
    if (std::find(parts.begin(), parts.end(), name) != parts.end()) return;
    throw Error(
        fmt::format("'{}': no such part of the scene; expected one of {}", name, fmt::join(parts, ", ")));
  };
  if (word == "show") {
    choosePipeline(0, action.text());
    state_.output = kWholeImage;
    state_.port.reset();
  } else if (word == "beside") {
    const std::string name = action.text();
    if (name == "nothing") {
      state_.sides.resize(1);
    } else if (name == "copy") {
      state_.sides.resize(1);
      state_.sides.push_back(state_.sides.front());
    } else {
      choosePipeline(1, name);
    }
  } else if (word == "swap") {
    if (state_.sides.size() < 2) throw Error("swap: nothing is beside; expected `beside` before");
    if (action.flag()) std::swap(state_.sides[0], state_.sides[1]);
  } else if (word == "set") {
    setParameters(action);
  } else if (word == "reset") {
    resetParameter(action.text());
  } else if (word == "off") {
    requirePart(action.text());
    state_.edits.off.insert(action.text());
  } else if (word == "on") {
    requirePart(action.text());
    state_.edits.off.erase(action.text());
  } else if (word == "environment") {
    state_.edits.environment = colourOf(action);
  } else if (word == "light") {
    const std::string name = action.block->header.front().text;
    requirePart("light " + name);
    for (const dsl::Item& item : action.block->items) state_.edits.powers[name] = colourOf(*item.property);
  } else if (word == "material") {
    const std::string name = action.block->header.front().text;
    if (std::none_of(scene_->materials.begin(), scene_->materials.end(),
                     [&](const Material& one) { return one.name == name; }))
      throw Error(fmt::format("material '{}': the scene has none of that name", name));
    MaterialEdit& edit = state_.edits.materials[name];
    for (const dsl::Item& item : action.block->items) {
      const dsl::Property& property = *item.property;
      if (property.word == "diffuse") edit.diffuse = colourOf(property);
      if (property.word == "specular") edit.specular = colourOf(property);
      if (property.word == "emission") edit.emission = colourOf(property);
      if (property.word == "exponent")
        edit.exponent = static_cast<float>(property.values.front().inBaseUnits());
    }
  } else if (word == "keep_everything") {
    state_.keepEverything = action.flag();
  } else if (word == "seed") {
    state_.seed = static_cast<std::uint64_t>(action.number());
  } else if (word == "undo") {
    stepBack(undo_, redo_, static_cast<int>(action.number()));
  } else if (word == "redo") {
    stepBack(redo_, undo_, static_cast<int>(action.number()));
  } else if (word == "reload") {
    readChangedFiles();
    techniques_.reload();
  } else {
    return false;
  }
  return true;
}

}  // namespace lumivox::viewer
