// Tools shared by several families of cases.
#pragma once

#include <map>
#include <string>

#include "lumivox/experiment/report.h"
#include "stress/cases.h"

namespace lumivox::stress {

/// A committed room in which every output of the technique that the pipeline stands for can be seen: the
/// plainest that will do, with something glossy or with a medium where one is needed.
Scene suitableScene(Bench& bench);

/// Whether a pass of the pipeline reads the camera.
bool seesCamera(Bench& bench);

bool makesImages(const Bench& bench);

/// Share of the occupied voxels that no triangle touches; 0 for a pipeline that makes none.
double spuriousShare(Bench& bench, const Scene& scene, const Shot& shot);

double meanOf(const ImageBuffer& image);
double largestOf(const ImageBuffer& image);
bool hasComponent(const FrameResult& frame, Contributes component);

/// RMSE against a reference without the part that is the reference's own noise, divided by the reference's
/// mean (by 1 where that is black); the uncertainty is that noise, divided likewise.
Measured differenceFromReference(const ImageBuffer& image, const ReferenceLayer& reference);

/// The case says nothing about this pipeline, and why.
Finding notApplicable(std::string why);
/// The same where the case is about light, and none of the pipeline's outputs is.
Finding withoutLight();

/// RMSE of every output as a share of the RMSE of leaving it out, by its name; outputs that the reference is
/// black in are passed over.
std::map<std::string, Measured> ratiosToNothing(Bench& bench, const Scene& scene, const Shot& shot,
                                                int referenceSamples);

}  // namespace lumivox::stress
