// Renders the viewer's frames: device, techniques and executors on a thread of their own, so that a slow
// frame never blocks the window. The device is the same as for rendering without a window.
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

/// One of at most two pipelines that are rendered for the same frame.
struct Side {
  std::shared_ptr<const Pipeline> pipeline;
  ParameterValues values;  ///< override the defaults
};

struct RenderWish {
  std::uint64_t number = 0;  ///< increases with every wish
  std::shared_ptr<const Scene> scene;
  Camera camera;
  double time = 0.0;
  int width = 0, height = 0;
  std::uint64_t seed = 1;
  bool keepEverything = false, timesPasses = false, countsWork = false;
  std::vector<Side> sides;
  std::optional<PortChoice> port;  ///< a port of the first side
  /// Folders with technique libraries; if the list changes, they are opened again.
  std::vector<std::filesystem::path> techniques;
};

/// A parameter of a pass as its technique declares it.
struct PassParameter {
  std::string name, meaning, unit, value, defaultText;
  std::vector<std::string> choices;  ///< for words and switches
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

/// When a pass runs, from all that it and the passes before it read. somethingMoves: when time advances.
/// everyFrame: also when the camera moves.
enum class RunsWhen { once, somethingMoves, everyFrame };
const char* wordOf(RunsWhen when);  ///< "once", "when something moves", "when the camera moves"

struct RenderedSide {
  FrameResult frame;
  Explanation explanation;
  std::map<std::string, int> bounces;  ///< of the outputs
  std::vector<PassContract> contracts;
  std::map<std::string, RunsWhen> runs;  ///< of passes
  std::uint64_t bytes = 0;
  std::vector<PassRecord> times;  ///< of the last timed frame
  bool timed = false;             ///< `times` are of this frame
  FrameWork work;                 ///< with RenderWish::countsWork
  std::string error;              ///< why there is no frame; empty: there is one
};
struct Rendered {
  RenderWish wish;
  std::vector<RenderedSide> sides;
  PortPicture port;                     ///< of RenderWish::port
  std::string portError, device;        ///< device: its renderer and program route
  std::vector<std::string> techniques;  ///< available ones
  std::string skipped;                  ///< unusable libraries with reasons; another copy, or none, is used
  bool software = false;
};

using RenderWorker = LatestWorker<RenderWish, Rendered>;

/// The work of a RenderWorker. If the device cannot be opened, every frame has that error.
RenderWorker::Work makeRenderWork(const gpu::DeviceOptions& options);

}  // namespace lumivox::viewer
