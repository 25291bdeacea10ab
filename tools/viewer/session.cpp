#include "viewer/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/base/error.h"
#include "lumivox/experiment/report.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/free_camera.h"

namespace lumivox::viewer {
namespace {

namespace fs = std::filesystem;

constexpr double kWatchSeconds = 0.25;  // between looks at the files
constexpr std::size_t kMostUndo = 1000;
constexpr std::size_t kFramesKept = 64;  // of which times are told

/// Statements that change what is made or how it is judged, and so can be undone; looking around cannot.
bool isUndoable(const std::string& word) {
  static const std::set<std::string> words{
      "set",   "reset",       "show",     "beside",          "swap", "off", "on",
      "light", "environment", "material", "keep_everything", "seed"};
  return words.count(word) != 0;
}

std::vector<std::shared_ptr<const Pipeline>> loadPipelines(const SessionOptions& options,
                                                           const Scene& scene) {
  std::vector<std::shared_ptr<const Pipeline>> pipelines;
  for (const fs::path& file : options.pipelines)
    pipelines.push_back(std::make_shared<const Pipeline>(Pipeline::load(file)));
  if (!pipelines.empty()) return pipelines;
  const auto scenes = committedScenes(options.scene.parent_path());
  if (!scenes) throw Error("no pipelines beside the scene or the program; name one: view SCENE PIPELINE...");
  TechniqueSet techniques(options.techniques);
  const SceneTraits traits = SceneTraits::of(scene);
  for (const fs::path& file : pipelinesIn(*scenes / "pipelines")) {
    auto pipeline = std::make_shared<const Pipeline>(Pipeline::load(file));
    if (whyUnsuited(*pipeline, techniques, traits).empty()) pipelines.push_back(std::move(pipeline));
  }
  if (pipelines.empty())
    throw Error(fmt::format("no committed pipeline suits {}; name one: view SCENE PIPELINE...",
                            options.scene.string()));
  return pipelines;
}

double medianOfTimes(std::vector<double> times) {
  return statisticsOf(std::move(times)).median;
}

std::string valuesText(const Pipeline& pipeline, const ParameterValues& values) {
  std::string text = pipeline.file.stem().string();
  for (const auto& [name, value] : values) text += fmt::format(" {}={}", name, value.text());
  return text;
}

/// What is alike in everything that costs time.
std::string keyOf(const Rendered& rendered, std::size_t side) {
  const Side& what = rendered.wish.sides[side];
  return fmt::format("{} {} {} {} {}x{}", what.pipeline->hash.text(), valuesText(*what.pipeline, what.values),
                     rendered.wish.keepEverything, rendered.wish.scene->hash.text(), rendered.wish.width,
                     rendered.wish.height);
}

template <class Word>
Word wordOf(const std::vector<std::string>& words, const std::string& text) {
  return static_cast<Word>(std::find(words.begin(), words.end(), text) - words.begin());
}

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

Session::Session(const SessionOptions& options, std::function<void()> wake)
    : options_(options),
      techniques_(options.techniques, wake),
      judge_(makeJudgeWork, wake),
      tracer_(makeReferenceWork, wake),
      renderer_([device = options.device] { return makeRenderWork(device); }, wake) {
  loadScene(options.scene);
  pipelines_ = loadPipelines(options, *scene_);
  const Camera& camera = scene_->camera(options.camera);
  state_.camera = camera.name;
  state_.time = options.time;
  state_.width = options.width > 0 ? options.width : camera.width;
  state_.height = options.height > 0 ? options.height : camera.height;
  state_.output = kWholeImage;
  state_.sides.push_back({pipelines_.front(), pipelines_.front()->settings(options.settings)});
  watchFiles();
}

Session::~Session() = default;

void Session::loadScene(const fs::path& file) {
  scene_ = std::make_shared<const Scene>(lumivox::loadScene(file, options_.sceneLoad));
  options_.scene = file;
  applyEdits();
}

void Session::applyEdits() {
  edited_ = state_.edits.empty() ? scene_ : std::make_shared<const Scene>(edited(*scene_, state_.edits));
  applied_ = state_.edits;
}

void Session::say(const std::string& message, bool error) {
  message_ = message;
  messageIsError_ = error;
  pictureChanged_ = true;
}

std::string Session::problem() const {
  if (!textProblem_.empty()) return textProblem_;
  if (!techniques_.errors().empty()) return techniques_.errors().begin()->second;
  if (rendered_ != nullptr) {
    for (const RenderedSide& side : rendered_->sides)
      if (!side.error.empty()) return side.error;
    if (!rendered_->portError.empty()) return rendered_->portError;
  }
  if (reference_ != nullptr && !reference_->error.empty()) return "reference: " + reference_->error;
  return {};
}

// ---- actions

std::vector<Action> Session::perform(const std::string& statements) {
  std::vector<Action> left;
  try {
    for (const Action& action : parseActions(statements))
      if (!perform(action)) left.push_back(action);
  } catch (const std::exception& error) {
    say(error.what(), true);
  }
  return left;
}

bool Session::perform(const Action& action) {
  const ViewState before = state_;
  try {
    if (!doLook(action) && !doChange(action) && !doKeep(action)) return false;
  } catch (const std::exception& error) {
    state_ = before;
    say(error.what(), true);
    return true;
  }
  if (isUndoable(action.word())) {
    undo_.push_back(before);
    if (undo_.size() > kMostUndo) undo_.erase(undo_.begin());
    redo_.clear();
  }
  log_.push_back(action.written());
  stateChanged_ = pictureChanged_ = true;
  return true;
}

void Session::freeCamera(const std::function<Camera(Camera)>& change) {
  Camera camera = change(cameraOf(state_, *scene_));
  camera.name = "view";
  camera.keys.clear();
  snapshotFrom(*scene_, state_.time, camera, state_.width, state_.height);  // refuses one that looks nowhere
  state_.free = std::move(camera);
}

bool Session::doLook(const Action& action) {
  const std::string& word = action.word();
  const auto vector = [&] {
    const std::vector<double> n = action.numbers();
    return glm::dvec3(n[0], n[1], n[2]);
  };
  if (word == "camera") {
    state_.camera = scene_->camera(action.text()).name;
    state_.free.reset();
  } else if (word == "eye") {
    freeCamera([&](Camera camera) { return camera.eye = vector(), camera; });
  } else if (word == "target") {
    freeCamera([&](Camera camera) { return camera.target = vector(), camera; });
  } else if (word == "fov") {
    const double fov = action.number();
    if (!(fov > 0.0) || !(fov < 3.1)) throw Error("fov: expected an angle between 0 and 177 deg");
    freeCamera([&](Camera camera) { return camera.fov = fov, camera; });
  } else if (word == "move") {
    freeCamera([&](const Camera& camera) { return moved(camera, vector()); });
  } else if (word == "turn" || word == "orbit") {
    const std::vector<double> n = action.numbers();
    freeCamera([&](const Camera& camera) {
      return word == "turn" ? turned(camera, n[0], n[1]) : orbited(camera, n[0], n[1]);
    });
  } else if (word == "zoom") {
    freeCamera([&](const Camera& camera) { return zoomed(camera, action.number()); });
  } else if (word == "time") {
    state_.time = action.number();
  } else if (word == "play") {
    state_.plays = action.flag();
  } else if (word == "speed") {
    state_.speed = action.number();
  } else if (word == "size") {
    const std::vector<double> n = action.numbers();
    state_.width = static_cast<int>(n[0]);
    state_.height = static_cast<int>(n[1]);
  } else if (word == "output") {
    const std::string name = action.text();
    std::vector<std::string> names{kWholeImage};
    for (const Pipeline::Output& output : state_.sides.front().pipeline->outputs)
      names.push_back(output.name);
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error(fmt::format("output '{}': expected one of {}", name, fmt::join(names, ", ")));
    state_.output = name;
    state_.port.reset();
  } else if (word == "port") {
    const std::string name = action.text();
    const std::size_t dot = name.find('.');
    if (name == "nothing") {
      state_.port.reset();
    } else if (dot == std::string::npos) {
      throw Error(fmt::format("port '{}': expected PASS.PORT, or nothing", name));
    } else {
      state_.port = PortChoice{name.substr(0, dot), name.substr(dot + 1), {}, 0, 0};
    }
  } else if (word == "texture" || word == "level" || word == "slice") {
    if (!state_.port) throw Error(word + ": no port is shown; expected `port PASS.PORT` before");
    if (word == "texture") state_.port->texture = action.text();
    if (word == "level") state_.port->level = static_cast<int>(action.number());
    if (word == "slice") state_.port->slice = static_cast<int>(action.number());
  } else if (word == "layout") {
    state_.layout = wordOf<Layout>(layoutWords(), action.text());
  } else if (word == "error_map") {
    state_.errorMap = wordOf<ErrorMap>(errorMapWords(), action.text());
  } else if (word == "split") {
    state_.split = action.number();
  } else if (word == "exposure") {
    const dsl::Value& value = action.property->values.front();
    if (value.kind == dsl::ValueKind::word && value.text == "auto") {
      state_.exposure.reset();
    } else if (value.kind == dsl::ValueKind::number && std::abs(value.number) <= kLargestExposure) {
      state_.exposure = value.number;
    } else {
      throw Error(fmt::format("exposure {}: expected auto, or EV of at most {} up or down", value.written(),
                              kLargestExposure));
    }
  } else if (word == "tone") {
    state_.curve = wordOf<Curve>(curveWords(), action.text());
  } else if (word == "samples") {
    state_.samples = static_cast<int>(action.number());
  } else if (word == "reference") {
    state_.traces = action.flag();
  } else if (word == "times") {
    state_.timesPasses = action.flag();
  } else {
    return false;
  }
  return true;
}

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

// ---- going on

void Session::watchFiles() {
  std::set<fs::path> files;
  const auto addText = [&](const fs::path& file) {
    files.insert(file);
    try {
      for (const fs::path& included : dsl::parseFile(file).includedFiles) files.insert(included);
    } catch (const Error&) {
      // It is gone; it may come back.
    }
  };
  addText(options_.scene);
  for (const auto& pipeline : pipelines_) addText(pipeline->file);
  texts_.set(files);
  std::set<std::string> used;
  for (const Side& side : state_.sides)
    for (const std::string& technique : side.pipeline->techniques()) used.insert(technique);
  techniques_.use(used);
}

void Session::readChangedFiles() {
  try {
    const std::shared_ptr<const Scene> before = scene_;
    scene_ = std::make_shared<const Scene>(lumivox::loadScene(options_.scene, options_.sceneLoad));
    if (scene_->hash == before->hash) scene_ = before;
    applyEdits();
    scene_->camera(state_.camera);
    for (auto& pipeline : pipelines_) {
      auto again = std::make_shared<const Pipeline>(Pipeline::load(pipeline->file));
      if (again->hash == pipeline->hash) continue;
      for (Side& side : state_.sides)
        if (side.pipeline->file == pipeline->file) {
          // What the text still knows of what was set.
          ParameterValues values;
          for (const auto& [name, value] : side.values)
            for (const PipelineParameter& parameter : again->parameters)
              if (parameter.name == name && parameter.misfit(value).empty()) values[name] = value;
          side = {again, values};
        }
      pipeline = std::move(again);
    }
    textProblem_.clear();
  } catch (const std::exception& error) {
    textProblem_ = error.what();
  }
  stateChanged_ = pictureChanged_ = true;
}

bool Session::step(double seconds) {
  if (state_.plays) {
    state_.time += seconds * state_.speed;
    stateChanged_ = true;
  }
  if (state_.layout == Layout::flicker || picture_.badPixels > 0) {
    const bool before = flicker_ < kFlickerSeconds;
    flicker_ = std::fmod(flicker_ + seconds, 2.0 * kFlickerSeconds);
    pictureChanged_ = pictureChanged_ || before != (flicker_ < kFlickerSeconds);
  }
  sinceWatch_ += seconds;
  if (sinceWatch_ >= kWatchSeconds) {
    sinceWatch_ = 0.0;
    if (!texts_.changed().empty()) {
      readChangedFiles();
      watchFiles();
    }
    if (techniques_.update()) stateChanged_ = pictureChanged_ = true;
  }
  if (stateChanged_) wantFrame();
  takeResults();
  const bool news = pictureChanged_;
  if (pictureChanged_) compose();
  pictureChanged_ = false;
  return news;
}

void Session::wantFrame() {
  // A frame at a time: while time goes on each would be passed over for the next.
  if (state_.plays && renderer_.busy()) return;
  stateChanged_ = false;
  if (!(applied_ == state_.edits)) applyEdits();
  std::set<std::string> used;
  for (const Side& side : state_.sides)
    for (const std::string& technique : side.pipeline->techniques()) used.insert(technique);
  techniques_.use(used);
  RenderWish wish;
  wish.scene = edited_;
  wish.camera = cameraOf(state_, *edited_);
  wish.time = state_.time;
  wish.width = state_.width;
  wish.height = state_.height;
  wish.seed = state_.seed;
  wish.keepEverything = state_.keepEverything;
  wish.timesPasses = state_.timesPasses && !state_.plays;
  wish.sides = state_.sides;
  wish.port = state_.port;
  wish.techniques = techniques_.directories();
  wish.number = ++wishes_;
  asked_ = wish;
  renderer_.want(std::move(wish));
}

void Session::takeResults() {
  if (std::optional<Rendered> rendered = renderer_.take()) {
    rendered_ = std::make_shared<const Rendered>(std::move(*rendered));
    if (std::all_of(rendered_->sides.begin(), rendered_->sides.end(),
                    [](const RenderedSide& side) { return side.error.empty(); }))
      lastGood_ = rendered_;
    noteTried();
    wantReference();
    wantJudgement();
    pictureChanged_ = true;
  }
  if (std::optional<ReferenceResult> reference = tracer_.take()) {
    if (referenceWish_ && (*reference)->wish.isSameView(*referenceWish_)) {
      reference_ = *reference;
      wantJudgement();
      pictureChanged_ = true;
    }
  }
  if (auto judged = judge_.take()) {
    judged_ = std::move(*judged);
    noteTried();
    pictureChanged_ = true;
  }
}

void Session::wantReference() {
  if (!state_.traces || state_.plays) {
    tracer_.stop();
    referenceWish_.reset();
    return;
  }
  const RenderWish& shown = rendered_->wish;
  ReferenceWish wish{shown.scene,   shown.camera, shown.time,
                     shown.width,   shown.height, bounceLayersOf(*rendered_),
                     state_.samples};
  if (referenceWish_ && referenceWish_->isSameView(wish)) return;
  referenceWish_ = wish;
  reference_.reset();
  judged_.reset();
  tracer_.want(std::move(wish));
}

void Session::wantJudgement() {
  if (reference_ == nullptr || !reference_->error.empty() || rendered_ == nullptr) return;
  judge_.want({rendered_, reference_, state_.exposure});
}

void Session::noteTried() {
  const bool judges = judged_ != nullptr && judged_->wish.rendered == rendered_;
  for (std::size_t i = 0; i < rendered_->sides.size(); ++i) {
    const RenderedSide& side = rendered_->sides[i];
    if (!side.error.empty()) continue;
    const Side& what = rendered_->wish.sides[i];
    const std::string key = keyOf(*rendered_, i);
    auto known =
        std::find_if(tried_.begin(), tried_.end(), [&](const TriedPoint& one) { return one.key == key; });
    if (known == tried_.end())
      known =
          tried_.insert(tried_.end(), {valuesText(*what.pipeline, what.values), key, what, 0.0, {}, {}, {}});
    // A frame that found its results kept says nothing of the cost.
    const bool whole = std::all_of(side.frame.passes.begin(), side.frame.passes.end(),
                                   [](const PassRecord& pass) { return pass.ran; });
    if (!judges && whole) known->times.push_back(side.frame.frameMs);
    if (!judges && rendered_->wish.timesPasses)
      for (const PassRecord& pass : side.times) {
        std::vector<PassRecord>& last = known->passes[pass.name];
        last.push_back(pass);
        if (last.size() > kFramesKept) last.erase(last.begin());
      }
    known->frameMs = known->times.empty() ? side.frame.frameMs : medianOfTimes(known->times);
    if (judges)
      for (const JudgedOutput& output : judged_->sides[i])
        if (output.output == kWholeImage) known->error = output.error.rmse;
  }
}

std::vector<PassTimes> Session::passTimes(std::size_t side) const {
  std::vector<PassTimes> times;
  if (rendered_ == nullptr || side >= rendered_->sides.size()) return times;
  const RenderedSide& shown = rendered_->sides[side];
  const std::string key = keyOf(*rendered_, side);
  const auto tried =
      std::find_if(tried_.begin(), tried_.end(), [&](const TriedPoint& one) { return one.key == key; });
  if (tried == tried_.end()) return times;
  for (const PassRecord& pass : shown.times) {
    PassTimes one;
    one.name = pass.name;
    one.onHost = pass.onHost;
    std::vector<double> device, host;
    if (const auto records = tried->passes.find(pass.name); records != tried->passes.end())
      for (const PassRecord& record : records->second) {
        device.push_back(record.deviceMs);
        host.push_back(record.hostMs);
      }
    one.device = statisticsOf(std::move(device));
    one.host = statisticsOf(std::move(host));
    const auto when = shown.runs.find(pass.name);
    if (when != shown.runs.end()) one.when = when->second;
    times.push_back(std::move(one));
  }
  return times;
}

bool Session::settled() const {
  return !stateChanged_ && !renderer_.busy() && rendered_ != nullptr && rendered_->wish.number == wishes_ &&
         !techniques_.compiles();
}
bool Session::judgedNow() const {
  return settled() && judged_ != nullptr && judged_->wish.rendered == rendered_ &&
         judged_->wish.reference == reference_;
}
bool Session::moves() const {
  return state_.plays || state_.layout == Layout::flicker || picture_.badPixels > 0;
}

}  // namespace lumivox::viewer
