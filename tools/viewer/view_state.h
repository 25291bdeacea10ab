// The state of the view: the scene's and the pipelines' settings, and how they are shown.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"
#include "lumivox/scene/scene.h"
#include "viewer/picture.h"
#include "viewer/render_worker.h"
#include "viewer/scene_edits.h"

namespace lumivox::viewer {

/// Which of picture, second picture, reference and error map are shown, and how.
enum class Layout { picture, reference, split, sideBySide, flicker, error };
/// The words for these in scripts, in the order of the values.
const std::vector<std::string>& layoutWords();
const std::vector<std::string>& errorMapWords();
const std::vector<std::string>& curveWords();

struct ViewState {
  std::string camera;          ///< name of a camera of the edited scene
  std::optional<Camera> free;  ///< replaces `camera` once it was moved
  double time = 0.0, speed = 1.0;
  double loop = 0.0;  ///< s, after which playing starts again; 0: never
  bool plays = false;
  int width = 0, height = 0;
  std::vector<Side> sides;  ///< one or two
  std::string output;
  std::optional<PortChoice> port;
  double seeThrough = 0.0;  ///< share of the picture that shows through voxels
  Layout layout = Layout::picture;
  ErrorMap errorMap = ErrorMap::relative;
  double split = 0.5;
  std::optional<double> exposure;  ///< EV; nothing: from the picture
  Curve curve = Curve::filmic;
  bool keepEverything = false, timesPasses = true, countsWork = false, traces = true;
  int samples = 1024;
  std::uint64_t seed = 1;
  SceneEdits edits;
};

/// The camera of the view; one with keys is placed at the view's time.
Camera cameraOf(const ViewState& state, const Scene& scene);

/// Changes of a free camera: moved right, up and forward by metres; turned about its eye or about its target,
/// right and up by radians, never over the pole; brought nearer to its target by a factor.
Camera moved(Camera camera, const glm::dvec3& by);
Camera turned(Camera camera, double right, double up);
Camera orbited(Camera camera, double right, double up);
Camera zoomed(Camera camera, double factor);

}  // namespace lumivox::viewer
