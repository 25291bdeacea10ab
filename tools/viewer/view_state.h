// What is looked at, and how: all that an undone action brings back.
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

/// Of picture, second picture, reference and error, what is shown.
enum class Layout { picture, reference, split, sideBySide, flicker, error };
/// The words of scripts for these, in the order of the values.
const std::vector<std::string>& layoutWords();
const std::vector<std::string>& errorMapWords();
const std::vector<std::string>& curveWords();

struct ViewState {
  std::string camera;          ///< of the scene, as it is edited
  std::optional<Camera> free;  ///< in its place, once somebody has moved
  double time = 0.0, speed = 1.0;
  double loop = 0.0;  ///< s, after which playing begins anew; 0: it goes on
  bool plays = false;
  int width = 0, height = 0;
  std::vector<Side> sides;  ///< one or two
  std::string output;
  std::optional<PortChoice> port;
  double seeThrough = 0.0;  ///< share of the picture that is seen behind voxels
  Layout layout = Layout::picture;
  ErrorMap errorMap = ErrorMap::relative;
  double split = 0.5;
  std::optional<double> exposure;  ///< EV; otherwise that of the picture
  Curve curve = Curve::filmic;
  bool keepEverything = false, timesPasses = true, countsWork = false, traces = true;
  int samples = 1024;
  std::uint64_t seed = 1;
  SceneEdits edits;
};

/// The camera that it looks through. Of a camera with keys, where it is at the time.
Camera cameraOf(const ViewState& state, const Scene& scene);

/// A free camera that is moved right, up and forward by metres; turned about its eye, or about its target, by
/// radians to the right and up, never over the pole; nearer to its target by a factor.
Camera moved(Camera camera, const glm::dvec3& by);
Camera turned(Camera camera, double right, double up);
Camera orbited(Camera camera, double right, double up);
Camera zoomed(Camera camera, double factor);

}  // namespace lumivox::viewer
