// Measures of cases: differences from an equivalent scene, leaked light, and differences from the reference.
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

/// Voxels that are set but not touched or touched but not set, over those that are touched; without touched
/// voxels, the number of set ones.
double wrongShare(const VoxelError& error);

/// Compares the image of `changed` with that of `scene`, which must be the same: RMS difference over the
/// mean. A pipeline of voxels is judged by the growth of the share of wrong voxels. Nullopt where the
/// pipeline makes neither. Shows the image of `changed`.
std::optional<Finding> sameAs(Bench& bench, const Scene& scene, const Scene& changed, double limit,
                              const std::string& what, const Shot& shot = {});

/// The reference layer that judges an output, with as many bounces as it models. Empty without one.
std::string ownLayer(const FrameResult& frame, const std::string& output);

/// The reference of the sum of the pipeline's outputs, with as many bounces as they model.
ReferenceLayer referenceOf(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot);

/// Sum of the references of the outputs that hold indirect light, each with its own bounces. `samples` 0: the
/// battery's number. indirectReference() is the mean of that sum.
ReferenceLayer indirectLayer(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot = {},
                             int samples = 0);
double indirectReference(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot = {});

/// Relative difference of the whole image's mean from the reference's, with the reference's noise as
/// uncertainty. `detail` has the same for every output, and the RMSE. Nullopt for a pipeline without images.
std::optional<Finding> againstReference(Bench& bench, const Scene& scene, double limit,
                                        const Shot& shot = {});

/// Light where the reference has none: the mean of the image of `dark` over the mean of that of `lit`.
std::optional<Finding> leak(Bench& bench, const Scene& dark, const Shot& darkShot, const Scene& lit,
                            const Shot& litShot, const std::string& what, double limit);

}  // namespace lumivox::stress
