// Statements that change what is rendered and can be undone, and undo itself.
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

template <class Named>
bool hasNamed(const std::vector<Named>& all, const std::string& name) {
  return std::any_of(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
}
template <class Named>
void requireNamed(const std::vector<Named>& all, const std::string& what, const std::string& name) {
  if (hasNamed(all, name)) return;
  std::vector<std::string> names;
  for (const Named& one : all) names.push_back(one.name);
  const std::string nearest = nearestWord(name, names);
  throw Error(
      fmt::format("{} '{}': the scene has none of that name; expected {}{}", what, name,
                  names.empty() ? "nothing: there is none" : fmt::format("one of {}", fmt::join(names, ", ")),
                  nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
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
  } else if (!resetScene(name)) {
    if (side.values.erase(name) != 0) return;
    const auto& parameters = side.pipeline->parameters;
    if (std::none_of(parameters.begin(), parameters.end(), [&](const auto& one) { return one.name == name; }))
      throw Error(
          fmt::format("reset {}: the pipeline has no such parameter, and the scene no such part", name));
  }
}

bool Session::resetScene(const std::string& name) {
  SceneEdits& edits = state_.edits;
  if (name == "scene") {
    edits = {};
    return true;
  }
  const std::size_t space = name.find(' ');
  const std::string kind = name.substr(0, space),
                    part = space == std::string::npos ? std::string() : name.substr(space + 1);
  const std::vector<std::string> parts = partsOf(*scene_);
  bool known = edits.off.erase(name) != 0 || std::find(parts.begin(), parts.end(), name) != parts.end();
  if (kind == "environment") known = true, edits.environment.reset();
  if (kind == "light") edits.powers.erase(part);
  if (kind == "medium") edits.media.erase(part);
  if (kind == "material") known = hasNamed(editableMaterials(*scene_), part), edits.materials.erase(part);
  if (kind == "camera") known = hasNamed(scene_->cameras, part), edits.cameras.erase(part);
  return known;
}

void Session::stepBack(std::vector<ViewState>& from, std::vector<ViewState>& to, int steps) {
  std::vector<ViewState> left = from, done = to;
  ViewState now = state_;
  for (int i = 0; i < steps && !left.empty(); ++i) {
    done.push_back(now);
    // The view is not undone.
    now.sides = std::move(left.back().sides);
    now.edits = std::move(left.back().edits);
    now.keepEverything = left.back().keepEverything;
    now.seed = left.back().seed;
    left.pop_back();
  }
  applyEdits(now.edits);  // throws, before any change, if a text that has changed since refuses them
  state_ = std::move(now);
  from = std::move(left);
  to = std::move(done);
}

bool Session::editScene(const Action& action) {
  if (action.block == nullptr || action.word() == "set") return false;
  const std::string& word = action.word();
  const std::string name = action.block->header.front().text;
  SceneEdits& edits = state_.edits;
  if (word == "light") requireNamed(editableLights(*scene_), word, name);
  if (word == "material") requireNamed(editableMaterials(*scene_), word, name);
  if (word == "medium") requireNamed(scene_->media, word, name);
  if (word == "camera") requireNamed(scene_->cameras, word, name);
  for (const dsl::Item& item : action.block->items) {
    const dsl::Property& property = *item.property;
    const std::string& is = property.word;
    const double number = property.values.front().inBaseUnits();
    if (word == "light") edits.powers[name] = colourOf(property);
    if (word == "material") {
      MaterialEdit& edit = edits.materials[name];
      if (is == "diffuse") edit.diffuse = colourOf(property);
      if (is == "specular") edit.specular = colourOf(property);
      if (is == "emission") edit.emission = colourOf(property);
      if (is == "exponent") edit.exponent = static_cast<float>(number);
    }
    if (word == "medium") {
      MediumEdit& edit = edits.media[name];
      if (is == "extinction") edit.extinction = colourOf(property);
      if (is == "albedo") edit.albedo = colourOf(property);
      if (is == "anisotropy") edit.anisotropy = static_cast<float>(number);
    }
    if (word == "camera") {
      CameraEdit& edit = edits.cameras[name];
      const std::vector<double> values = dsl::numbersInBaseUnits(property);
      if (is == "eye") edit.eye = glm::dvec3(values[0], values[1], values[2]);
      if (is == "target") edit.target = glm::dvec3(values[0], values[1], values[2]);
      if (is == "fov") edit.fov = number;
    }
  }
  return true;
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
  } else if (editScene(action)) {
    // perform() throws for edits that a text could not express.
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
