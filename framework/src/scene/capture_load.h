// Captures of a scene text: where their files are, their frames, and the cameras that stand in their places.
#pragma once

#include <memory>
#include <vector>

#include "lumivox/dsl/document.h"
#include "lumivox/scene/scene.h"
#include "scene/assets.h"
#include "scene/description.h"

namespace lumivox {

/// Reports a capture's folder, or the poses beside its EXR images, if it should be beside the text and is
/// not; with `everywhere` also if it is nowhere.
void findMissingFrames(const dsl::Document& document, const CaptureText& capture, const AssetSearch& assets,
                       bool everywhere, std::vector<Diagnostic>& findings);

/// Finds a capture's files, and reads them and the scene that it stands for. AbsentError if they are nowhere;
/// Error as loadCapture().
std::shared_ptr<const Capture> loadPlacedCapture(const CaptureText& text, const AssetSearch& assets,
                                                 const SceneLoadOptions& options, Hasher& hasher);

/// Gives cameras of captures without a resolution the size of the frames.
void sizeCapturedViews(Scene& scene);

}  // namespace lumivox
