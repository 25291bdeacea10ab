// The fields of every stored record, each listed once: the store's columns, JSON, CSV and the table in
// docs/results.md come from these lists. A field that is added here is read from older stores as what the
// record begins with, and needs no new schema.
#pragma once

#include <concepts>
#include <type_traits>

#include "lumivox/results/runs.h"
#include "lumivox/results/stress_cells.h"

namespace lumivox::results {

struct Field {
  const char* name;             ///< in JSON and CSV
  const char* about = nullptr;  ///< with its unit; null: the sentence of the next field is about this one too
  bool csv = false;             ///< has a column in CSV
  const char* column = name;    ///< in SQL
};
inline constexpr bool kCsv = true;

/// T or const T: one list serves reading and writing.
template <class A, class T>
concept Is = std::same_as<std::remove_const_t<A>, T>;

// Members whose JSON is not that of their type.
template <class Flag>
struct Against {  ///< "bias" or "misses"
  Flag& bias;
};
template <class Error>
struct Metrics {  ///< by name, see metricsOf()
  Error& error;
};
template <class Point>
struct Passes {  ///< everything of each pass together, in the order in which they ran
  Point& point;
};

void fields(Is<TimingStatistics> auto& time, auto&& visit) {
  visit(Field{"median"}, time.median);
  visit(Field{"lower_quartile"}, time.lowerQuartile);
  visit(Field{"upper_quartile"}, time.upperQuartile);
  visit(Field{"smallest"}, time.smallest);
  visit(Field{"largest"}, time.largest);
  visit(Field{"repeats",
              "median of the repeats, its quartiles, the smallest and the largest, and how many repeats"},
        time.repeats);
}

void fields(Is<RunIdentity> auto& identity, auto&& visit) {
  visit(Field{"scene_hash"}, identity.sceneHash);
  visit(Field{"pipeline_hash", "of the texts with all that they include and name"}, identity.pipelineHash);
  visit(Field{"techniques"}, identity.techniques);
  visit(Field{"framework", "hash of the framework's own libraries"}, identity.framework);
  visit(Field{"parameters"}, identity.parameters);
  visit(Field{"camera", nullptr, kCsv}, identity.camera);
  visit(Field{"time", nullptr, kCsv}, identity.time);
  visit(Field{"width", nullptr, kCsv}, identity.width);
  visit(Field{"height", "what the images show; s, pixels", kCsv}, identity.height);
  visit(Field{"seed", nullptr, kCsv}, identity.seed);
  visit(Field{"seeds", nullptr, kCsv}, identity.seeds);
  visit(Field{"repeats", nullptr, kCsv}, identity.repeats);
  visit(Field{"subpixels", nullptr, kCsv}, identity.subpixels);
  visit(Field{"reference_samples",
              "first seed, how many; timed frames; positions in the pixel; the reference's samples per pixel",
              kCsv},
        identity.referenceSamples);
  visit(Field{"flicker_pairs",
              "pairs of frames over which flicker was measured; 0 where the scene does not move"},
        identity.flickerPairs);
  visit(Field{"kept"}, identity.kept);
  visit(Field{"display", "an exposure or tone curve that was asked for; else empty"}, identity.display);
  visit(Field{"device", nullptr, kCsv}, identity.device);
  visit(Field{"driver", nullptr, kCsv}, identity.driver);
  visit(Field{"shader_input", nullptr, kCsv}, identity.shaderInput);
  visit(Field{"host",
              "where; `shader_input` is `spirv` or `glsl`, with ` fast` behind it under `--arithmetic fast`",
              kCsv},
        identity.host);
}

void fields(Is<StoredRun> auto& run, auto&& visit) {
  visit(Field{"created", nullptr, kCsv}, run.created);
  visit(Field{"version", "when, by which version"}, run.version);
  visit(Field{"scene", nullptr, kCsv}, run.point.scene);
  visit(Field{"scene_name"}, run.sceneName);
  visit(Field{"pipeline", nullptr, kCsv}, run.point.pipeline);
  visit(Field{"pipeline_name", "files as given, and titles"}, run.pipelineName);
  visit(Field{"sweep", nullptr, kCsv}, run.point.sweep);
  visit(Field{"default",
              "the sweep's name, empty for the default point; 1 when all parameters are the defaults", kCsv,
              "is_default"},
        run.isDefault);
  visit(Field{"identity"}, run.identity);
  visit(Field{"frame", nullptr, kCsv}, run.point.frameMs);
  visit(Field{"next_frame", nullptr, kCsv}, run.point.nextFrameMs);
  visit(Field{"still_frame"}, run.point.stillFrameMs);
  visit(Field{"moved_frame"}, run.point.movedFrameMs);
  visit(Field{"framework_share", "host time between the passes / frame time", kCsv},
        run.point.frameworkShare);
  visit(Field{"peak_bytes", "of the whole frame, the scene included, whatever else is on the device", kCsv},
        run.point.peakBytes);
  visit(Field{"passes"}, Passes{run.point});
  visit(Field{"errors"}, run.point.errors);
  visit(Field{"voxels"}, run.point.voxels);
  visit(Field{"health", nullptr, kCsv}, run.point.healthFindings);
  visit(Field{"notes"}, run.point.notes);
  visit(Field{"not_counted", "why the work of the passes was not counted; empty when it was"},
        run.point.whyNotCounted);
  visit(Field{"failure", "why there are no numbers; empty when there are", kCsv}, run.point.failure);
  visit(Field{"command", "repeats the point"}, run.point.command);
}

void fields(Is<ComponentError> auto& error, auto&& visit) {
  visit(Field{"output", nullptr, kCsv}, error.output);
  visit(Field{"component", nullptr, kCsv}, error.component);
  visit(Field{"reference", "one row per output and reference layer", kCsv}, error.reference);
  visit(Field{"against", "`bias` (the technique's own model) or `misses` (full transport)", kCsv},
        Against{error.bias});
  visit(Field{"seeds", nullptr, kCsv}, error.seeds);
  visit(Field{"deterministic", nullptr, kCsv}, error.deterministic);
  visit(Field{"noise_rmse",
              "seeds that were run; 1 when they gave the same bits; RMS of the image's own noise"},
        error.noiseRmse);
  visit(
      Field{
          "per_seed",
          "1: every metric is the mean over the seeds; 0: from a store of schema 3 or before, where all but the RMSE are of the first "
          "seed and their uncertainties lack the spread"},
      error.everyMetricPerSeed);
  visit(Field{"metrics"}, Metrics{error});
}

void fields(Is<NamedMetric> auto& metric, auto&& visit) {
  visit(Field{"value"}, metric.measured.value);
  visit(Field{"uncertainty"}, metric.measured.uncertainty);
  visit(Field{"of_nothing", "with its standard uncertainty; the same metric of a black image"},
        metric.ofNothing);
}

void fields(Is<RayHoles> auto& holes, auto&& visit) {
  visit(Field{"axis_crossings"}, holes.axisCrossings);
  visit(Field{"axis_holes"}, holes.axisHoles);
  visit(Field{"oblique_crossings"}, holes.obliqueCrossings);
  visit(Field{"oblique_holes", "crossings of rays with the surface, and how many are holes"},
        holes.obliqueHoles);
}

void fields(Is<GatheredVoxels> auto& voxels, auto&& visit) {
  visit(Field{"output"}, voxels.output);
  visit(Field{"kind", "which output of which pass, `voxels.fragments`, and its kind of port"}, voxels.kind);
  visit(Field{"why_not", "why they were not judged, the counts are then 0; empty when they were"},
        voxels.whyNot);
  visit(Field{"resolution", "voxels of the grid along x, y and z"}, voxels.resolution);
  visit(Field{"occupied"}, voxels.occupied);
  visit(Field{"reference"}, voxels.reference);
  visit(Field{"undecided",
              "voxels that are occupied; that the exact test is certain of; that it leaves undecided"},
        voxels.undecided);
  visit(Field{"true_positive"}, voxels.error.truePositive);
  visit(Field{"false_positive"}, voxels.error.falsePositive);
  visit(Field{"false_negative", "as in [the metrics](metrics.md#voxels)"}, voxels.error.falseNegative);
  visit(Field{"holes"}, voxels.holes);
}

void fields(Is<StressCell> auto& cell, auto&& visit) {
  visit(Field{"created", nullptr, kCsv}, cell.created);
  visit(Field{"version", "when, by which version", kCsv}, cell.version);
  visit(Field{"family", nullptr, kCsv}, cell.family);
  visit(Field{"case", "of the case (docs/stress.md)", kCsv, "name"}, cell.name);
  visit(Field{"pipeline", nullptr, kCsv}, cell.pipeline);
  visit(Field{"technique", "file as given; the technique that it represents", kCsv}, cell.technique);
  visit(Field{"size", "`quick` or `full`", kCsv}, cell.size);
  visit(Field{"measure", nullptr, kCsv}, cell.measure);
  visit(Field{"unit", "what was measured; both are empty where only health was looked at", kCsv}, cell.unit);
  visit(Field{"detail", "the first bad pass, port and pixel, the refusal, or more numbers", kCsv},
        cell.detail);
  visit(Field{"explanation", "a property of the published method, from its paper card", kCsv},
        cell.explanation);
  visit(Field{"image", nullptr, kCsv}, cell.image);
  visit(Field{"command", "file beside the page; repeats the cell", kCsv}, cell.command);
  visit(Field{"pipeline_hash", nullptr, kCsv}, cell.pipelineHash);
  visit(Field{"framework", "content hashes", kCsv}, cell.framework);
  visit(Field{"device", nullptr, kCsv}, cell.device);
  visit(Field{"driver", nullptr, kCsv}, cell.driver);
  visit(Field{"shader_input", nullptr, kCsv}, cell.shaderInput);
  visit(Field{"host", "where", kCsv}, cell.host);
  visit(Field{"outcome", "stable, biased, diverges, refused, not_applicable, broken", kCsv}, cell.outcome);
  visit(Field{"value", nullptr, kCsv}, cell.value.value);
  visit(Field{"uncertainty", nullptr, kCsv}, cell.value.uncertainty);
  visit(Field{"limit", "in that unit, with its standard uncertainty; beyond the limit: biased", kCsv,
              "limit_value"},
        cell.limit);
  visit(Field{"seconds", "how long it took", kCsv}, cell.seconds);
  visit(Field{"techniques"}, cell.techniques);
}

void fields(Is<PeakRate> auto& rate, auto&& visit) {
  visit(Field{"name"}, rate.name);
  visit(Field{"unit", "the resource whose peak rate was measured (docs/commands.md, `lumivox device`)"},
        rate.unit);
  fields(rate.rate, visit);
  visit(Field{"created"}, rate.created);
  visit(Field{"version", "when, by which version"}, rate.version);
  visit(Field{"device"}, rate.device);
  visit(Field{"driver"}, rate.driver);
  visit(Field{"shader_input"}, rate.shaderInput);
  visit(Field{"host", "the device that was measured"}, rate.host);
}

template <class T>
concept HasFields = requires(T& record) {
  fields(record, [](const Field&, auto&&) {});
};
template <class T>
concept IsNumber = std::is_arithmetic_v<T> && !std::same_as<T, bool>;

}  // namespace lumivox::results
