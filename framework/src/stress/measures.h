// What cases measure: differences from an equivalent scene, light where none may be, and the distance to the
// truth.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stress/case_tools.h"

namespace lumivox::stress {

/// Whether an output of this frame holds indirect light.
bool makesIndirect(const Frame& frame);
/// Sum of the outputs that hold indirect light; empty when there is none.
Picture indirectOf(const Frame& frame);

/// Voxels that are set but not touched or touched but not set, as a share of those that are touched; 0 where
/// both sets are empty.
double wrongShare(const VoxelError& error);

/// The picture of `changed` against that of `scene`, which must be the same: their RMS difference over the
/// mean. For a pipeline of voxels how much larger the share of wrong voxels is. Nullopt where the pipeline
/// makes neither. Shows the picture of `changed`.
std::optional<Finding> sameAs(Bench& bench, const Scene& scene, const Scene& changed, double limit,
                              const std::string& what, const Shot& shot = {});

/// The truth of what the pipeline's outputs hold together (bias: one bounce for indirect light).
TruthLayer truthOf(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot);

/// Mean of the truth (one bounce) of those outputs that hold indirect light.
double indirectTruth(Bench& bench, const Scene& scene, const Frame& frame, const Shot& shot = {});

/// How far the mean of the whole picture is from the truth's, as a share of it, with the truth's noise as
/// uncertainty; in `detail` the same of every output, and the RMSE. Nullopt for a pipeline without pictures.
std::optional<Finding> againstTruth(Bench& bench, const Scene& scene, double limit, const Shot& shot = {});

/// Light where the truth has none: the mean of the picture of `dark` over the mean of that of `lit`.
std::optional<Finding> leak(Bench& bench, const Scene& dark, const Shot& darkShot, const Scene& lit,
                            const Shot& litShot, const std::string& what, double limit);

}  // namespace lumivox::stress
