// The viewer without a window: the state, the statements that change it, the workers, and the resulting
// picture.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/scene/scene.h"
#include "viewer/actions.h"
#include "viewer/judge_worker.h"
#include "viewer/picture.h"
#include "viewer/reference_worker.h"
#include "viewer/render_worker.h"
#include "viewer/session_options.h"
#include "viewer/techniques.h"
#include "viewer/tool_worker.h"
#include "viewer/view_state.h"
#include "viewer/watch.h"

namespace lumivox::viewer {

/// Times of a pass over the last timed frames.
struct PassTimes {
  std::string name;
  TimingStatistics device, host;  ///< ms
  bool onHost = false;
  RunsWhen when = RunsWhen::everyFrame;
};

/// Settings that were tried, with their frame time and error: a point of the chart.
struct TriedPoint {
  std::string label, key;
  Side side;
  double frameMs = 0.0;
  std::vector<double> times;                              ///< ms of all frames; frameMs is their median
  std::map<std::string, std::vector<PassRecord>> passes;  ///< of the last timed frames
  std::optional<Measured> error;                          ///< FLIP of the whole image
};

/// A text whose file exists already, until the user answers whether to overwrite it.
struct TextToWrite {
  std::filesystem::path file;
  std::string text;
};

/// The passes of a timed frame, by side.
struct TimedFrame {
  double seconds = 0.0;  ///< since the process started
  std::vector<std::vector<PassRecord>> sides;
};

class Session {
 public:
  /// `wake` is called from other threads when a worker has a result. Error if a text is wrong.
  Session(const SessionOptions& options, std::function<void()> wake);
  ~Session();

  /// Performs the statements that need no window, and returns those that do. An error becomes message(), and
  /// its statement has no effect.
  std::vector<Action> perform(const std::string& statements);
  /// The same for one statement. False: it needs the window.
  bool perform(const Action& action);
  /// Advances the time by `seconds`, checks the files and takes results from the workers. Returns whether the
  /// picture changed.
  bool step(double seconds);

  const ViewState& state() const { return state_; }
  const Scene& scene() const { return *scene_; }  ///< as its text has it
  const Scene& shownScene() const { return *edited_; }
  const std::vector<std::shared_ptr<const Pipeline>>& pipelines() const { return pipelines_; }
  RenderedResult rendered() const { return rendered_; }     ///< the last frame; null before the first
  ReferenceResult reference() const { return reference_; }  ///< of this view; null while there is none
  std::shared_ptr<const Judged> judged() const { return judged_; }
  const Picture& picture() const { return picture_; }
  const std::vector<TriedPoint>& tried() const { return tried_; }
  static constexpr double kFrameSeconds = 10.0;  ///< that timedFrames() covers
  /// The timed frames of the last kFrameSeconds, oldest first.
  const std::deque<TimedFrame>& timedFrames() const { return timedFrames_; }
  /// Seconds from the process's start to the first picture; nothing before that.
  std::optional<double> firstPictureSeconds() const { return firstPicture_; }
  /// The times of the passes of one side with its present settings, in the order of the passes.
  std::vector<PassTimes> passTimes(std::size_t side) const;
  const std::map<std::string, std::string>& technicalErrors() const { return techniques_.errors(); }
  const std::string& message() const { return message_; }  ///< the last error or completed action
  bool messageIsError() const { return messageIsError_; }
  /// The question that waits for `answer`; empty: none.
  std::string question() const;
  /// Passes are timed only while the panels are shown.
  void showPanels(bool shown) {
    stateChanged_ = stateChanged_ || shown != showsPanels_;
    showsPanels_ = shown;
  }
  /// Whether the changes from now on are undone together with the one before, as those of one drag of the
  /// mouse.
  void joinChanges(bool join) { joins_ = join; }
  void say(const std::string& message, bool error);
  /// The present fault of the texts, the shaders or the frame, which is shown over the last good picture;
  /// empty: none.
  std::string problem() const;
  double exposure() const { return exposure_; }
  /// The values at a pixel of the picture, of each output and of the reference, as lines of text.
  std::vector<std::string> valuesAt(int x, int y) const;
  /// The command that repeats the picture. Error if the texts do not contain all that is shown.
  std::string command() const;
  std::vector<std::string> history() const { return log_; }  ///< statements as in a script
  std::size_t undoable() const { return undo_.size(); }
  std::size_t redoable() const { return redo_.size(); }
  /// Whether the frame of the present state is complete, and judged against the reference so far.
  bool settled() const;
  bool judgedNow() const;
  /// Whether the picture changes without input, so that step() must be called again soon.
  bool moves() const;
  bool tracing() const { return tracer_.busy(); }
  bool keeping() const { return keeping_; }  ///< whether a program is still writing a file
  /// Stops all workers. Returns whether they ended within `seconds`; otherwise the session must not be
  /// destroyed, only the process ended.
  bool stop(double seconds);

 private:
  void doIt(const Action& action);
  bool doLook(const Action& action);
  bool doLookAtPort(const Action& action);
  bool doChange(const Action& action);
  bool doKeep(const Action& action);
  bool isAsInTexts() const;
  std::vector<std::string> runWords(const std::string& camera) const;
  void exportGrid(const std::filesystem::path& file);
  void addPoint(const std::filesystem::path& store);
  void startTool(ToolWish wish);
  Camera framed(const Camera& camera, const std::string& what) const;
  void setParameters(const Action& action);
  void resetParameter(const std::string& name);
  /// Takes back the edits of a part. Returns whether the scene has such a part.
  bool resetScene(const std::string& name);
  bool editScene(const Action& action);
  std::string sceneText();
  void write(const TextToWrite& text);
  void choosePipeline(std::size_t side, const std::string& name);
  void freeCamera(const std::function<Camera(Camera)>& change);
  void rememberForUndo();
  void stepBack(std::vector<ViewState>& from, std::vector<ViewState>& to, int steps);
  void watchFiles();
  bool readChangedFiles();
  bool takeTexts(ViewState next);
  RenderWish wishNow();
  void wantFrame();
  void takeResults();
  void wantReference();
  void wantJudgement();
  void noteTried();
  void noteTimes();
  void compose();
  Picture portPicture(const PictureLook& outputLook) const;
  std::shared_ptr<const Scene> editedScene(const std::shared_ptr<const Scene>& scene,
                                           const SceneEdits& edits) const;
  void applyEdits(const SceneEdits& edits);

  static constexpr double kFlickerSeconds = 0.5;  ///< for each of two pictures that flicker

  SessionOptions options_;
  std::shared_ptr<const Scene> scene_, edited_, editedFrom_;
  std::vector<std::shared_ptr<const Pipeline>> pipelines_;
  ViewState state_;
  SceneEdits applied_;
  SceneEdits refusedWith_;  ///< the edits that gave textProblem_
  std::vector<ViewState> undo_, redo_;
  std::vector<std::string> log_;
  std::string message_, textProblem_, frameProblem_;
  bool messageIsError_ = false, joins_ = false, showsPanels_ = true;
  std::optional<TextToWrite> waitsForAnswer_;

  Watch texts_;
  double sinceWatch_ = 0.0, flicker_ = 0.0;
  bool stateChanged_ = true, pictureChanged_ = true;
  std::uint64_t wishes_ = 0, notedFrame_ = 0, notedTimes_ = 0;
  RenderWish asked_;
  RenderedResult rendered_, lastGood_;
  ReferenceResult reference_;
  std::optional<ReferenceWish> referenceWish_;
  std::shared_ptr<const Judged> judged_;
  std::vector<TriedPoint> tried_;
  std::deque<TimedFrame> timedFrames_;
  std::optional<double> firstPicture_;
  Picture picture_;
  double exposure_ = 0.0;

  bool keeping_ = false;
  LiveTechniques techniques_;
  ToolWorker tools_;
  JudgeWorker judge_;
  ReferenceWorker tracer_;
  RenderWorker renderer_;
};

/// The pipeline with the statements of a `set` block added to the block of that pass. Throws DiagnosticsError
/// if its text is then wrong.
Pipeline withPassParameters(const Pipeline& pipeline, const std::string& pass, const dsl::Block& values);
/// The pipeline's text with these values as defaults, in the canonical layout.
std::string textWithDefaults(const Pipeline& pipeline, const ParameterValues& values);

}  // namespace lumivox::viewer
