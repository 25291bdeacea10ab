// The protocol of all timing: the frames of several points take turns, so that a drifting machine biases
// none.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiment/measure.h"

namespace lumivox::experiment {

/// A point that takes turns.
struct Turn {
  std::string name;  ///< for messages
  /// Renders the warm-up. All points that take turns share the transient memory.
  std::function<TimedPoint(const std::shared_ptr<TransientMemory>&)> open;
  std::function<void(TimedPoint&)> read = {};  ///< called before the following frames; may be empty
  std::string failure = {};                    ///< why it could not be timed, even alone; empty when it was
};

/// Times, in turns, at most `repeats` frames of each point in which every kept pass runs (fewer once
/// TimedPoint::isSettled()); then `nextFrames` frames
/// 1/60 s apart; then as many, at most kLeastRepeats, while nothing moves, and while camera and lights move.
/// As many points are held at once as fit into memory. A point that fails beside others is retried after
/// them, in the end alone, so that a failure is its own. All points share the scene and the transient memory.
/// Other processes are held back in the meantime. A wrong text throws.
void timeInTurns(gpu::Device& device, std::vector<Turn>& turns, int repeats, int nextFrames);

}  // namespace lumivox::experiment
