// Measures of the cases: differences from an equivalent scene, light where none may be, and the distance to
// the reference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stress/case_tools.h"

namespace lumivox::stress {

/// Whether an output of this frame holds indirect light.
bool makesIndirect(const Frame& frame);
/// Sum of the outputs that hold indirect light; empty when there is none.
ImageBuffer indirectOf(const Frame& frame);

/// Voxels that are set but not touched or touched but not set, as a share of those that are touched; 0 where
/// both sets are empty.
double wrongShare(const VoxelError& error);

/// The image of `changed` against that of `scene`, which must be the same: their RMS difference over the
/// mean. For a pipeline of voxels how much larger the share of wrong voxels is. Nullopt where the pipeline
/// makes neither. Shows the image of `changed`.
std::optional<Finding> sameAs(Bench& bench, const Scene& scene, const Scene& changed, double limit,
                              const std::string& what, const Shot& shot = {});

/// The layer of the reference that an output is judged by: of as many bounces as it models. Empty: none.
std::string ownLayer(const FrameResult& frame, const std::string& output);

/// The reference of what the pipeline's outputs hold together (bias: as many bounces as they model).
ReferenceLayer referenceOf(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot);

/// Sum of the references (of their own bounces) of those outputs that hold indirect light, and its mean.
/// `samples` 0: the battery's own.
ReferenceLayer indirectLayer(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot = {},
                             int samples = 0);
double indirectReference(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot = {});

/// How far the mean of the whole image is from the reference's, as a share of it, with the reference's noise
/// as uncertainty; in `detail` the same of every output, and the RMSE. Nullopt for a pipeline without images.
std::optional<Finding> againstReference(Bench& bench, const Scene& scene, double limit,
                                        const Shot& shot = {});

/// Light where the reference has none: the mean of the image of `dark` over the mean of that of `lit`.
std::optional<Finding> leak(Bench& bench, const Scene& dark, const Shot& darkShot, const Scene& lit,
                            const Shot& litShot, const std::string& what, double limit);

}  // namespace lumivox::stress
