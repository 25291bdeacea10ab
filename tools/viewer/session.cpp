#include "viewer/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "lumivox/base/error.h"
#include "lumivox/experiment/report.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/free_camera.h"

namespace lumivox::viewer {
namespace {

namespace fs = std::filesystem;

constexpr double kWatchSeconds = 0.25;  // between checks of the files
constexpr std::size_t kMostUndo = 1000;

/// Whether the statement can be undone: it changes what is rendered, not only how it is looked at.
bool isUndoable(const Action& action) {
  static const std::set<std::string> words{
      "set",         "reset",    "show",   "beside",          "swap", "off", "on", "light",
      "environment", "material", "medium", "keep_everything", "seed"};
  return words.count(action.word()) != 0 || (action.word() == "camera" && action.block != nullptr);
}

std::vector<std::shared_ptr<const Pipeline>> loadPipelines(const SessionOptions& options,
                                                           const Scene& scene) {
  std::vector<std::shared_ptr<const Pipeline>> pipelines;
  for (const fs::path& file : options.pipelines)
    pipelines.push_back(std::make_shared<const Pipeline>(Pipeline::load(file)));
  TechniqueSet techniques(options.techniques, options.strict);
  if (options.strict)  // throws before the window opens
    for (const auto& pipeline : pipelines)
      for (const std::string& name : pipeline->techniques()) techniques.technique(name);
  if (!pipelines.empty()) return pipelines;
  const auto scenes = committedScenes(options.scene.parent_path());
  if (!scenes) throw Error("no pipelines beside the scene or the program; name one: view SCENE PIPELINE...");
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

}  // namespace

Session::Session(const SessionOptions& options, std::function<void()> wake)
    : options_(options),
      techniques_(options.techniques, wake),
      tools_(makeToolWork, wake),
      judge_(makeJudgeWork, wake),
      tracer_(makeReferenceWork, wake),
      renderer_([device = options.device] { return makeRenderWork(device); }, wake) {
  scene_ = std::make_shared<const Scene>(loadScene(options.scene, options.sceneLoad));
  edited_ = editedFrom_ = scene_;
  pipelines_ = loadPipelines(options, *scene_);
  const Camera& camera = scene_->camera(options.camera);
  state_.camera = camera.name;
  state_.time = options.time;
  state_.seed = options.seed;
  state_.width = options.width > 0 ? options.width : camera.width;
  state_.height = options.height > 0 ? options.height : camera.height;
  state_.output = kWholeImage;
  state_.sides.push_back({pipelines_.front(), pipelines_.front()->settings(options.settings)});
  watchFiles();
}

Session::~Session() = default;

std::shared_ptr<const Scene> Session::editedScene(const std::shared_ptr<const Scene>& scene,
                                                  const SceneEdits& edits) const {
  // An unchanged scene stays the same object, so that holders need not compare contents.
  if (editedFrom_ == scene && applied_ == edits) return edited_;
  return edits.empty() ? scene : std::make_shared<const Scene>(edited(*scene, edits));
}

void Session::applyEdits(const SceneEdits& edits) {
  edited_ = editedScene(scene_, edits);
  editedFrom_ = scene_;
  applied_ = edits;
}

void Session::say(const std::string& message, bool error) {
  message_ = message;
  messageIsError_ = error;
  pictureChanged_ = true;
}

std::string Session::problem() const {
  if (!textProblem_.empty()) return textProblem_;
  if (!frameProblem_.empty()) return frameProblem_;
  if (!techniques_.errors().empty()) return techniques_.errors().begin()->second;
  if (rendered_ != nullptr) {
    for (const RenderedSide& side : rendered_->sides)
      if (!side.error.empty()) return side.error;
    if (!rendered_->portError.empty()) return rendered_->portError;
    if (!rendered_->skipped.empty()) return rendered_->skipped;
  }
  if (reference_ != nullptr && !reference_->error.empty()) return "reference: " + reference_->error;
  if (judged_ != nullptr && judged_->wish.rendered == rendered_ && !judged_->error.empty())
    return "error of the picture: " + judged_->error;
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
  bool keeps = false;  // true: only something is saved, and no frame is rendered
  try {
    if (!doLook(action) && !doChange(action)) {
      keeps = doKeep(action);
      if (!keeps) return false;
    }
    applyEdits(state_.edits);  // throws for edits that a text could not express
  } catch (const std::exception& error) {
    state_ = before;
    say(error.what(), true);
    return true;
  }
  const bool joined = joins_ && isUndoable(action) && !undo_.empty() && !log_.empty();
  if (isUndoable(action)) {
    if (!joined) undo_.push_back(before);
    if (undo_.size() > kMostUndo) undo_.erase(undo_.begin());
    redo_.clear();
  }
  if (joined) log_.pop_back();
  log_.push_back(action.written());
  stateChanged_ = stateChanged_ || !keeps;
  pictureChanged_ = true;
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
      // The file is absent; it may come back.
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

bool Session::step(double seconds) {
  if (state_.plays) {
    state_.time += seconds * state_.speed;
    if (state_.loop > 0.0 && state_.time >= state_.loop) state_.time = std::fmod(state_.time, state_.loop);
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
  // The edits changed with which a text was refused: try it again.
  if (!textProblem_.empty() && !(state_.edits == refusedWith_)) readChangedFiles();
  if (stateChanged_) wantFrame();
  takeResults();
  const bool news = pictureChanged_;
  if (pictureChanged_) compose();
  pictureChanged_ = false;
  return news;
}

void Session::wantFrame() {
  // While time advances, only one frame is requested at a time: otherwise each would be skipped for the next.
  if (state_.plays && renderer_.busy()) return;
  stateChanged_ = false;
  frameProblem_.clear();
  RenderWish wish;
  try {
    applyEdits(state_.edits);
    wish = wishNow();
  } catch (const std::exception& error) {
    frameProblem_ = error.what();
    return;
  }
  wish.number = ++wishes_;
  asked_ = wish;
  renderer_.want(std::move(wish));
}

RenderWish Session::wishNow() {
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
  wish.timesPasses = state_.timesPasses && showsPanels_ && !state_.plays;
  wish.countsWork = state_.countsWork && !state_.plays;
  wish.sides = state_.sides;
  wish.port = state_.port;
  wish.techniques = techniques_.directories();
  return wish;
}

bool Session::stop(double seconds) {
  tracer_.stop();
  judge_.stop();
  renderer_.stop();
  techniques_.stop();
  tools_.stop();
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (tracer_.busy() || judge_.busy() || renderer_.busy() || techniques_.compiles() || tools_.busy()) {
    if (std::chrono::steady_clock::now() > until) {
      techniques_.removeFiles();
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
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
