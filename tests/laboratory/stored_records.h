// Runs and stress cells with every member set, for tests of the results store.
#pragma once

#include <limits>
#include <string>

#include "lumivox/results/store.h"

namespace lumivox::test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

inline ComponentError errorOf(double rmse) {
  ComponentError error;
  error.output = "indirect_diffuse";
  error.component = "indirect_diffuse";
  error.reference = "one_bounce_diffuse";
  error.error.rmse = {rmse, 0.01 * rmse};
  error.error.meanRatio = {0.9, kNan};
  error.error.flip = 0.125;
  error.error.flipUncertainty = 0.001;
  error.error.exposure = -1.25;
  error.error.nonFiniteImage = 7;
  error.seeds = 2;
  error.deterministic = true;
  error.parts.bias = {0.5 * rmse, 0.02};
  error.parts.noise = {kNan, 0.0};
  error.flicker = {0.25, 0.001};
  error.errorOfNothing.rmse.value = 1.0 / 3.0;
  return error;
}

/// Of 100 certain voxels 80 are occupied, and 20 more besides.
inline GatheredVoxels someVoxels() {
  GatheredVoxels voxels;
  voxels.output = "voxels.fragments";
  voxels.kind = "VoxelFragments";
  voxels.resolution = {32, 16, 8};
  voxels.occupied = 103;
  voxels.reference = 100;
  voxels.undecided = 7;
  voxels.error = {80, 20, 20};
  voxels.holes = {400, 10, 300, 3};
  return voxels;
}

/// Runs with other `number`s are other points.
inline StoredRun runNumber(int number) {
  StoredRun run;
  run.identity.sceneHash = "5ce";
  run.identity.pipelineHash = "919e";
  run.identity.techniques = {{"voxel_cone_tracing", "1a"}, {"voxelization", "2b"}};
  run.identity.framework = "f0";
  run.identity.parameters = {{"cones", std::to_string(number)}, {"distribution", "cosine"}};
  run.identity.camera = "main";
  run.identity.time = 0.1;
  run.identity.width = 64;
  run.identity.height = 48;
  run.identity.seed = 0xffffffffffffffffull;
  run.identity.flickerPairs = 4;
  run.identity.kept = {"light.radiance", "voxels.fragments"};
  run.identity.display = "exposure -1.5, tone filmic";
  run.identity.device = "a device, 'quoted'";
  run.identity.host = "a host";
  run.created = "2026-01-31 12:00:00 UTC";
  run.version = "0.1.0";
  run.sceneName = "Cornell box";
  run.pipelineName = "Voxel cone tracing";
  run.isDefault = true;
  run.point.scene = "scenes/cornell.scene";
  run.point.pipeline = "scenes/pipelines/voxel_cone_tracing.pipeline";
  run.point.sweep = "quality";
  run.point.parameters["cones"].number = number;
  run.point.parameters["distribution"].word = "cosine";
  run.point.frameMs = {10.0, 9.5, 10.5, 9.0, 12.0, 5};
  run.point.nextFrameMs = {4.0, 3.9, 4.1, 3.8, 5.0, 5};
  run.point.stillFrameMs = {1.0, 0.9, 1.1, 0.8, 2.0, 5};
  run.point.movedFrameMs = {6.0, 5.9, 6.1, 5.8, 7.0, 5};
  run.point.whyNotCounted = "only this pass";
  run.point.passOrder = {"gbuffer", "gather"};
  run.point.passDeviceMs["gather"] = {6.0, 5.9, 6.1, 5.8, 6.4, 5};
  run.point.passHostMs["gather"] = {6.5, 6.4, 6.6, 6.3, 6.9, 5};
  run.point.passBytes["gather"] = 1u << 20;
  run.point.passWork["gather"] = {{"buffer_reads", 1e12}, {"texture_samples_d3_rgba16f_mips", 3.0}};
  run.point.passWork["gbuffer"] = {{"draws", 1.0}};
  run.point.frameworkShare = kNan;
  run.point.peakBytes = std::uint64_t{5} << 32;
  run.point.errors = {errorOf(0.02 + number)};
  run.point.voxels = someVoxels();
  run.point.healthFindings = {"pass gather, port diffuse: 3 NaN, first at pixel (12, 40)"};
  run.point.command = "lumivox report scenes/cornell.scene";
  return run;
}

/// Cells with other `number`s are of other cases.
inline StressCell cellNumber(int number) {
  StressCell cell;
  cell.created = "2015-10-21 16:29:00 UTC";
  cell.version = "0.1.0";
  cell.family = number % 2 == 0 ? "light" : "geometry";
  cell.name = "case_" + std::to_string(number);
  cell.pipeline = "scenes/pipelines/one.pipeline";
  cell.technique = "one";
  cell.size = "quick";
  cell.outcome = number == 3 ? StressOutcome::broken : StressOutcome::biased;
  cell.measure = "RMSE, of the mean";
  cell.unit = "m";
  cell.value = {0.25 * number, 0.5};
  cell.limit = 0.125;
  cell.detail = "pass a, port b: 1 NaN";
  cell.explanation = "the method has no sides";
  cell.image = "images/a.png";
  cell.command = "lumivox stress --case a";
  cell.seconds = 1.5;
  cell.pipelineHash = "cafe";
  cell.framework = "beef";
  cell.techniques = {{"one", "1+2"}, {"two", "3+4"}};
  cell.device = "a device";
  cell.driver = "a driver";
  cell.shaderInput = "spirv";
  cell.host = "a host";
  return cell;
}

}  // namespace lumivox::test
