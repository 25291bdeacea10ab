// Tools for several families of cases.
#pragma once

#include <map>
#include <string>

#include "lumivox/experiment/report.h"
#include "stress/cases.h"

namespace lumivox::stress {

/// The simplest committed room in which every output of the technique that the pipeline stands for is
/// visible; with something glossy or a medium where needed.
Scene suitableScene(Bench& bench);

/// Whether a pass of the pipeline reads the camera.
bool seesCamera(Bench& bench);

bool makesImages(const Bench& bench);

/// Share of occupied voxels that no triangle touches; 0 for a pipeline without voxels.
double spuriousShare(Bench& bench, const Scene& scene, const Shot& shot);

double meanOf(const ImageBuffer& image);
double largestOf(const ImageBuffer& image);
bool hasComponent(const FrameResult& frame, Contributes component);

/// RMSE against a reference less the reference's noise, divided by the reference's mean (by 1 where that is
/// black). The uncertainty is that noise, divided likewise.
Measured differenceFromReference(const ImageBuffer& image, const ReferenceLayer& reference);

/// The finding of a case that does not apply to the pipeline, with the reason.
Finding notApplicable(std::string why);
/// The same for a case about light where no output is light.
Finding withoutLight();

/// RMSE of every output over the RMSE of leaving it out, by name. Outputs with a black reference are skipped.
std::map<std::string, Measured> ratiosToNothing(Bench& bench, const Scene& scene, const Shot& shot,
                                                int referenceSamples);

}  // namespace lumivox::stress
