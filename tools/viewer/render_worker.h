// The frames of the viewer: the device, the techniques and the executors, on a thread of their own, so that
// the window goes on while a frame takes long. The device is the one that renders without a window.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/gpu/device.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/scene/scene.h"
#include "viewer/latest_worker.h"
#include "viewer/pass_work.h"
#include "viewer/port_view.h"

namespace lumivox::viewer {

/// One of the two that are rendered in the same frame.
struct Side {
  std::shared_ptr<const Pipeline> pipeline;
  ParameterValues values;  ///< over the defaults
};

struct RenderWish {
  std::uint64_t number = 0;  ///< larger for later ones
  std::shared_ptr<const Scene> scene;
  Camera camera;
  double time = 0.0;
  int width = 0, height = 0;
  std::uint64_t seed = 1;
  bool keepEverything = false, timesPasses = false, countsWork = false;
  std::vector<Side> sides;
  std::optional<PortChoice> port;  ///< of the first side
  /// Where technique libraries are sought; another list opens them anew.
  std::vector<std::filesystem::path> techniques;
};

/// A parameter of a pass as its technique declares it.
struct PassParameter {
  std::string name, meaning, unit, value, defaultText;
  std::vector<std::string> choices;  ///< of words and switches
  bool number = false, integer = false;
  double low = 0.0, high = 0.0;
};
struct PassContract {
  std::string name, technique, pass, meaning;
  std::vector<PassParameter> parameters;
  struct Port {
    std::string name, kind;
    std::vector<std::string> textures, fields;  ///< fields: drawnFields()
  };
  std::vector<Port> outputs;
};

/// When a pass runs, by what it and the passes before it read: once; when time goes on, so that something may
/// move; whenever the camera moves, too.
enum class RunsWhen { once, somethingMoves, everyFrame };
const char* wordOf(RunsWhen when);  ///< "once", "when something moves", "when the camera moves"

struct RenderedSide {
  FrameResult frame;
  Explanation explanation;
  std::map<std::string, int> bounces;  ///< of the outputs
  std::vector<PassContract> contracts;
  std::map<std::string, RunsWhen> runs;  ///< of passes
  std::uint64_t bytes = 0;
  std::vector<PassRecord> times;  ///< of the last frame whose passes were timed
  bool timed = false;             ///< they are of this one
  FrameWork work;                 ///< with RenderWish::countsWork
  std::string error;              ///< why there is no frame; empty: there is one
};
struct Rendered {
  RenderWish wish;
  std::vector<RenderedSide> sides;
  PortPicture port;                     ///< of RenderWish::port
  std::string portError, device;        ///< device: its renderer and how programs reach it
  std::vector<std::string> techniques;  ///< that are there
  std::string skipped;                  ///< libraries that do not fit, and why: another one, or none, serves
  bool software = false;
};

using RenderWorker = LatestWorker<RenderWish, Rendered>;

/// The work of such a worker. A device that cannot be opened is an error of every frame.
RenderWorker::Work makeRenderWork(const gpu::DeviceOptions& options);

}  // namespace lumivox::viewer
