// The technique's passes, one source file each.
#pragma once

#include <optional>

#include "captured_frames_port.h"
#include "captured_frames_shaders.h"
#include "lumivox/plugin/technique.h"

namespace lumivox::captured_frames {

/// A frame's pixels and the pose that they were seen from.
struct PosedImage {
  const CapturedImage& image;
  const CaptureFrame& pose;
};
/// Brightness of the later frame over that of the earlier one: the median over points of surfaces that both
/// see. Nothing if they see too few together.
std::optional<double> brightnessOver(const CaptureCamera& camera, const PosedImage& later,
                                     const PosedImage& earlier);

void addRead(TechniqueRegistry& registry);
void addLights(TechniqueRegistry& registry);
void addSurfaces(TechniqueRegistry& registry);
void addRelight(TechniqueRegistry& registry);
void addComposite(TechniqueRegistry& registry);

}  // namespace lumivox::captured_frames
