// What happens in the viewer, without a window: the state, what is done to it, the workers behind it, and the
// picture that comes of it.
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

/// Times of a pass over the last frames that were timed.
struct PassTimes {
  std::string name;
  TimingStatistics device, host;  ///< ms
  bool onHost = false;
  RunsWhen when = RunsWhen::everyFrame;
};

/// Something that was tried, with what it cost and how wrong it was: a point of the chart.
struct TriedPoint {
  std::string label, key;
  Side side;
  double frameMs = 0.0;
  std::vector<double> times;                              ///< of all frames, of which frameMs is the median
  std::map<std::string, std::vector<PassRecord>> passes;  ///< of the last frames that were timed
  std::optional<Measured> error;                          ///< FLIP of the whole image
};

/// A text for a file that was there already: it is asked for.
struct TextToWrite {
  std::filesystem::path file;
  std::string text;
};

/// The passes of a frame whose passes were timed, of each side.
struct TimedFrame {
  double seconds = 0.0;  ///< since the session began
  std::vector<std::vector<PassRecord>> sides;
};

class Session {
 public:
  /// `wake` is called from other threads when something new is there. Error when a text is wrong.
  Session(const SessionOptions& options, std::function<void()> wake);
  ~Session();

  /// Does statements of the grammar that need no window; returns those that do. What is wrong with them
  /// becomes message(), and nothing of that statement is done.
  std::vector<Action> perform(const std::string& statements);
  /// The same for one; false: it needs the window.
  bool perform(const Action& action);
  /// Goes on: time, files, workers. Whether what is seen has changed.
  bool step(double seconds);

  const ViewState& state() const { return state_; }
  const Scene& scene() const { return *scene_; }  ///< as its text has it
  const Scene& shownScene() const { return *edited_; }
  const std::vector<std::shared_ptr<const Pipeline>>& pipelines() const { return pipelines_; }
  RenderedResult rendered() const { return rendered_; }     ///< the last; null before the first
  ReferenceResult reference() const { return reference_; }  ///< of this view; null while there is none
  std::shared_ptr<const Judged> judged() const { return judged_; }
  const Picture& picture() const { return picture_; }
  const std::vector<TriedPoint>& tried() const { return tried_; }
  static constexpr double kFrameSeconds = 10.0;  ///< that timedFrames() go back
  /// Of the last seconds before the newest, the oldest first.
  const std::deque<TimedFrame>& timedFrames() const { return timedFrames_; }
  /// From the program's start to the first picture; nothing before it.
  std::optional<double> firstPictureSeconds() const { return firstPicture_; }
  /// Of the passes of one side as it is now, in their order.
  std::vector<PassTimes> passTimes(std::size_t side) const;
  const std::map<std::string, std::string>& technicalErrors() const { return techniques_.errors(); }
  const std::string& message() const { return message_; }  ///< the last thing that went wrong or was done
  bool messageIsError() const { return messageIsError_; }
  /// What waits for `answer`, as a sentence; empty: nothing.
  std::string question() const;
  /// Passes are timed while somebody may look at the times.
  void showPanels(bool shown) {
    stateChanged_ = stateChanged_ || shown != showsPanels_;
    showsPanels_ = shown;
  }
  /// Whether changes from now on are one with the change before, to be undone together: those of one
  /// movement of a hand.
  void joinChanges(bool join) { joins_ = join; }
  void say(const std::string& message, bool error);
  /// What is wrong with the texts, the shaders or the frame now, over the last good picture; empty: nothing.
  std::string problem() const;
  double exposure() const { return exposure_; }
  /// The image under a point of the picture, of each output and the reference's: lines of text.
  std::vector<std::string> valuesAt(int x, int y) const;
  /// The command that repeats the picture. Error where the texts do not say what is shown.
  std::string command() const;
  std::vector<std::string> history() const { return log_; }  ///< statements, as a script has them
  std::size_t undoable() const { return undo_.size(); }
  std::size_t redoable() const { return redo_.size(); }
  /// Whether the frame of the present state is there, and judged by what there is of a reference.
  bool settled() const;
  bool judgedNow() const;
  /// Whether something happens by itself: the picture must be asked for again soon.
  bool moves() const;
  bool tracing() const { return tracer_.busy(); }
  bool keeping() const { return keeping_; }  ///< whether a program still writes what was asked for
  /// Gives up whatever is under way; whether it ended before `seconds` were over. What did not can only be
  /// left behind, with the process.
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
  /// Whether the scene has such a part, which then is as its text has it.
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

  static constexpr double kFlickerSeconds = 0.5;  ///< a picture of two that flicker

  SessionOptions options_;
  std::shared_ptr<const Scene> scene_, edited_, editedFrom_;
  std::vector<std::shared_ptr<const Pipeline>> pipelines_;
  ViewState state_;
  SceneEdits applied_;
  SceneEdits refusedWith_;  ///< the edits with which textProblem_ came
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

/// The default of a pipeline's parameter, or what a text makes of a pass's: the pipeline with the statements
/// of a `set` block in the block of that pass. DiagnosticsError when the text is then wrong.
Pipeline withPassParameters(const Pipeline& pipeline, const std::string& pass, const dsl::Block& values);
/// The pipeline's text with these defaults, in the canonical layout.
std::string textWithDefaults(const Pipeline& pipeline, const ParameterValues& values);

}  // namespace lumivox::viewer
