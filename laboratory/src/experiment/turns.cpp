#include "experiment/turns.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <utility>

#include "base/process.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "pipeline/pool.h"

namespace lumivox::experiment {
namespace {

/// A point that holds its resources between its turns.
struct Held {
  Turn* turn;
  std::optional<TimedPoint> point;  ///< empty once it failed
};

/// Takes points from the front while they fit beside each other; the first one in any case.
std::vector<Held> holdTogether(gpu::Device& device, std::deque<Turn*>& waiting) {
  const auto memory = std::make_shared<TransientMemory>(device);
  std::vector<Held> held;
  while (!waiting.empty()) {
    Turn* turn = waiting.front();
    const std::string why = whyFailed([&] { held.push_back({turn, turn->open(memory)}); });
    if (!why.empty() && !held.empty()) {
      logInformation("{}: timed after the {} points before it, since it fails beside them: {}", turn->name,
                     held.size(), why);
      break;
    }
    waiting.pop_front();
    if (!why.empty()) turn->failure = why;
  }
  std::uint64_t alone = 0;
  for (const Held& one : held) alone += one.point->executor().memory().bytes;
  if (held.size() > 1)
    logDetails("{} points hold {} of textures and buffers together; each alone, they would hold {}",
               held.size(), formatBytes(device.allocatedBytes()), formatBytes(alone));
  return held;
}

/// Gives each point one turn. A failing point releases its resources and is appended to `failed` with the
/// reason.
template <class Work>
void forEach(std::vector<Held>& held, std::vector<Turn*>& failed, const Work& work) {
  for (Held& one : held) {
    if (!one.point) continue;
    one.turn->failure = whyFailed([&] { work(one); });
    if (one.turn->failure.empty()) continue;
    one.point.reset();
    failed.push_back(one.turn);
  }
}

}  // namespace

void timeInTurns(gpu::Device& device, std::vector<Turn>& turns, int repeats, int nextFrames) {
  const MachineLock alone(MachineLock::For::timing);
  std::deque<Turn*> waiting;
  for (Turn& turn : turns) waiting.push_back(&turn);
  std::vector<Turn*> again;  // failed beside others
  const auto time = [&](std::deque<Turn*>& some) {
    std::vector<Held> held = holdTogether(device, some);
    std::vector<Turn*> failed;
    for (int repeat = 0; repeat < repeats; ++repeat)
      forEach(held, failed, [](Held& one) {
        if (!one.point->isSettled()) one.point->timeFrame();
      });
    forEach(held, failed, [](Held& one) {
      one.point->finish();
      if (one.turn->read) one.turn->read(*one.point);
    });
    for (int frame = 0; frame < nextFrames; ++frame)
      forEach(held, failed, [](Held& one) { one.point->timeNextFrame(); });
    // Following frames need no more repeats than a claim does.
    const int parts = std::min(nextFrames, kLeastRepeats);
    for (int frame = 0; frame < parts; ++frame)
      forEach(held, failed, [](Held& one) { one.point->timeStillFrame(); });
    for (int frame = 0; frame < parts; ++frame)
      forEach(held, failed, [](Held& one) { one.point->timeMovedFrame(); });
    forEach(held, failed, [](Held& one) { one.point->finish(); });
    if (held.size() > 1) again.insert(again.end(), failed.begin(), failed.end());
  };
  while (!waiting.empty()) time(waiting);
  for (Turn* turn : std::exchange(again, {})) {
    logInformation("{}: timed again, alone: {}", turn->name, turn->failure);
    std::deque<Turn*> one{turn};
    time(one);
  }
}

}  // namespace lumivox::experiment
