// The protocol by which all times are taken: the frames of several points take turns, so that a machine that
// drifts biases none.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiment/measure.h"

namespace lumivox::experiment {

/// One of the points that take turns.
struct Turn {
  std::string name;  ///< for messages
  /// Renders the warm-up; memory that no pass uses is that of all points that take turns.
  std::function<TimedPoint(const std::shared_ptr<TransientMemory>&)> open;
  std::function<void(TimedPoint&)> read = {};  ///< called before the frames that follow; may be empty
  std::string failure = {};  ///< why it could not be timed, not even alone; empty when it was
};

/// Times `repeats` frames of each in which every kept pass runs, in turns, and then `nextFrames` that follow
/// 1/60 s after another, and as many, at most kLeastRepeats, while nothing moves, and while the camera and
/// the lights move. As many points are held at once as fit into memory: one that fails beside others is tried
/// after them, in the end alone, so that a failure is its own. What is the same for all of them is there
/// once: the scene, and memory that no pass uses at the moment. Other processes are held back meanwhile. A
/// wrong text throws.
void timeInTurns(gpu::Device& device, std::vector<Turn>& turns, int repeats, int nextFrames);

}  // namespace lumivox::experiment
