// The time of a frame in the window against the same frame of `render`, in turns: from a camera turn to the
// finished picture, with panels hidden and no reference. The window's drawing is not counted.
// usage: bench_viewer [--quick | SIZE [REPEATS]] (default: 256 41), from the project's folder. --quick:
// seconds of work, whose figures mean nothing, for the tests.
#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "../spread.h"
#include "lumivox/base/error.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/scene/free_camera.h"
#include "viewer/session.h"

namespace {

using namespace lumivox;
using namespace lumivox::viewer;
using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// The session of a window, with the wait from which its workers wake it.
class Viewed {
 public:
  Viewed(const char* scene, const std::string& pipeline, int size)
      : session_(
            [&] {
              SessionOptions options;
              options.scene = scene;
              options.pipelines = {pipeline};
              options.width = options.height = size;
              options.techniques = TechniqueSet::defaultDirectories({});
              return options;
            }(),
            [this] {
              const std::lock_guard lock(mutex_);
              woken_ = true;
              changed_.notify_all();
            }) {
    session_.showPanels(false);
    session_.perform("reference off");
    frame();
  }

  /// Waits until the frame for the last statement is a picture.
  void frame() {
    const RenderedResult before = session_.rendered();
    for (session_.step(0.0); session_.rendered() == before; session_.step(0.0)) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return woken_; });
      woken_ = false;
    }
  }
  void turn() { session_.perform("turn 0.01 rad 0 rad"); }
  const Session& session() const { return session_; }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool woken_ = false;
  Session session_;
};

void measure(const std::string& name, int size, int repeats) {
  const char* const scene = "scenes/cornell.scene";
  const std::string pipeline = "scenes/pipelines/" + name + ".pipeline";
  Viewed viewed(scene, pipeline, size);
  gpu::Device device;
  TechniqueSet techniques(TechniqueSet::defaultDirectories({}));
  const Scene loaded = loadScene(scene);
  const Pipeline text = Pipeline::load(pipeline);
  RenderOptions options;
  options.interactive = true;
  PipelineExecutor executor(device, techniques, loaded, text, options);
  std::vector<double> inWindow, rendered, differences;
  for (int i = -1; i < repeats; ++i) {  // the first warms up
    const auto start = Clock::now();
    viewed.turn();
    viewed.frame();
    const double window = millisecondsSince(start);
    const auto again = Clock::now();
    executor.render(snapshotFrom(loaded, 0.0, *viewed.session().state().free, size, size), 0,
                    PipelineExecutor::Images::yes);
    const double alone = millisecondsSince(again);
    if (i < 0) continue;
    inWindow.push_back(window);
    rendered.push_back(alone);
    differences.push_back(window - alone);
  }
  const Spread difference = spreadOf(differences);
  const double allowed = 1.0 + 0.05 * spreadOf(rendered).median;
  fmt::print("{:<28} {:>12.2f} {:>12.2f} {:>8.2f} [{:.2f}, {:.2f}] {:>10.2f}\n", name,
             spreadOf(rendered).median, spreadOf(inWindow).median, difference.median, difference.lower,
             difference.upper, allowed);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    const int size = quick ? 16 : argc > 1 ? std::atoi(argv[1]) : 256;
    const int repeats = quick ? 1 : argc > 2 ? std::atoi(argv[2]) : 41;
    if (size < 1 || repeats < 1) throw Error("SIZE and REPEATS are numbers from 1");
    fmt::print("medians of {} frames of {} x {} pixels; difference of each pair with its quartiles\n",
               repeats, size, size);
    fmt::print("{:<28} {:>12} {:>12} {:>22} {:>10}\n", "pipeline", "render, ms", "window, ms", "more, ms",
               "allowed");
    for (const char* name : {"direct_lighting", "reflective_shadow_maps", "voxel_cone_tracing"})
      measure(name, size, repeats);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_viewer: {}\n", error.what());
    return 2;
  }
  return 0;
}
