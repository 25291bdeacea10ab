// The fields of every record, each listed once. The store's columns, JSON, CSV, the page and the table in
// docs/results.md are derived from these lists. A store without the column of a new field gets it when it is
// opened, with the default of the record.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

#include "lumivox/results/report_record.h"
#include "lumivox/results/runs.h"
#include "lumivox/results/stress_cells.h"
#include "lumivox/results/voxelizers.h"

namespace lumivox::results {

struct Field {
  const char* name;             ///< in JSON
  const char* about = nullptr;  ///< meaning and unit; null: the next field's sentence covers this one too
  const char* csv = nullptr;    ///< column in CSV; null: none
  const char* column = name;    ///< in SQL
};
inline constexpr const char* kCsv = "";  ///< the CSV column has the JSON name

/// T or const T, so that one list serves reading and writing.
template <class A, class T>
concept Is = std::same_as<std::remove_const_t<A>, T>;

// Members that are not written as their type.
template <class T>
struct Derived {  ///< derived from other fields: written, never read, and without a column in the store
  T value;
};
template <class Flag>
struct Against {  ///< "bias" or "misses"
  Flag& bias;
};
template <class Error>
struct Metrics {  ///< by name (metricsOf()); the store has a table of them
  Error& error;
};
template <class Point>
struct Passes {  ///< a list of PassFields
  Point& point;
};

/// All values of a pass. Empty: unknown.
struct PassFields {
  std::string name;
  bool ran = true;  ///< false: its work was counted, but no times were taken yet
  std::optional<TimingStatistics> device, host;
  std::optional<std::uint64_t> bytes;
  std::optional<Work> work;
  std::vector<WorkBound> bounds;
};
struct PrunedPass {
  std::string name;
  std::optional<TimingStatistics> ms, everythingMs;
};
/// In the order of running.
std::vector<PassFields> passesOf(const ReportPoint& point);
std::vector<PrunedPass> passesOf(const PruningRecord& record);
void addPass(ReportPoint& point, PassFields pass);

/// The device and host of a measurement.
void deviceFields(auto& record, const char* csv, auto&& visit) {
  visit({"device", nullptr, csv}, record.device);
  visit({"driver", nullptr, csv}, record.driver);
  visit({"shader_input", nullptr, csv}, record.shaderInput);
  visit({"host",
         "where; `shader_input` is `spirv` or `glsl`, with ` fast` behind it under `--arithmetic fast`", csv},
        record.host);
}

void fields(Is<TimingStatistics> auto& time, auto&& visit) {
  visit({"median"}, time.median);
  visit({"lower_quartile"}, time.lowerQuartile);
  visit({"upper_quartile"}, time.upperQuartile);
  visit({"smallest"}, time.smallest);
  visit({"largest"}, time.largest);
  visit(
      {"repeats", "median of the repeats, its quartiles, the smallest and the largest, and how many repeats"},
      time.repeats);
}

void fields(Is<RunIdentity> auto& identity, auto&& visit) {
  visit({"scene_hash"}, identity.sceneHash);
  visit({"pipeline_hash", "of the texts with all that they include and name"}, identity.pipelineHash);
  visit({"techniques", "name to hash of library and shaders, JSON"}, identity.techniques);
  visit({"framework", "hash of the framework's own libraries"}, identity.framework);
  visit({"parameters", "all of the pipeline, as `--set` reads them, JSON", kCsv}, identity.parameters);
  visit({"camera", nullptr, kCsv}, identity.camera);
  visit({"time", nullptr, kCsv}, identity.time);
  visit({"width", nullptr, kCsv}, identity.width);
  visit({"height", "what the images show; s, pixels", kCsv}, identity.height);
  visit({"seed", nullptr, kCsv}, identity.seed);
  visit({"seeds", nullptr, kCsv}, identity.seeds);
  visit({"repeats", nullptr, kCsv}, identity.repeats);
  visit({"subpixels", nullptr, kCsv}, identity.subpixels);
  visit(
      {"reference_samples",
       "first seed, how many; timed frames; positions in the pixel; the reference's samples per pixel", kCsv},
      identity.referenceSamples);
  visit({"flicker_pairs", "pairs of frames over which flicker was measured; 0 where the scene does not move"},
        identity.flickerPairs);
  visit({"kept", "outputs that stayed alive though no image needs them, JSON"}, identity.kept);
  visit({"display", "an exposure or tone curve that was asked for; else empty"}, identity.display);
  deviceFields(identity, kCsv, visit);
}

void fields(Is<Measured> auto& measured, auto&& visit) {
  visit({"value"}, measured.value);
  visit({"uncertainty"}, measured.uncertainty);
}

void fields(Is<StoredRun> auto& run, auto&& visit) {
  visit({"created", nullptr, kCsv}, run.created);
  visit({"version", "when, by which version"}, run.version);
  visit({"scene", nullptr, kCsv}, run.point.scene);
  visit({"scene_name"}, run.sceneName);
  visit({"pipeline", nullptr, kCsv}, run.point.pipeline);
  visit({"pipeline_name", "files as given, and titles"}, run.pipelineName);
  visit({"sweep", nullptr, kCsv}, run.point.sweep);
  visit({"default", "the sweep's name, empty for the default point; 1 when all parameters are the defaults",
         kCsv, "is_default"},
        run.isDefault);
  fields(run.identity, visit);
  visit(
      {"frame_ms",
       "of frames in which every kept pass runs: median, quartiles, smallest and largest time, ms, and how many",
       kCsv},
      run.point.frameMs);
  visit({"next_frame_ms", "of frames 1/60 s later, in which only what changed runs", kCsv},
        run.point.nextFrameMs);
  visit({"still_frame_ms", "of frames that follow another while nothing moves"}, run.point.stillFrameMs);
  visit({"moved_frame_ms", "of frames before which the camera and every light have moved"},
        run.point.movedFrameMs);
  const CostParts costs = costParts(run.point);
  visit({"once_ms", nullptr, kCsv}, Derived{costs.onceMs});
  visit({"when_moving_ms", nullptr, kCsv}, Derived{costs.movingMs});
  visit({"every_frame_ms", nullptr, kCsv}, Derived{costs.everyFrameMs});
  visit({"framework_share", "host time between the passes / frame time", kCsv}, run.point.frameworkShare);
  visit({"peak_bytes", "of the whole frame, the scene included, whatever else is on the device", kCsv},
        run.point.peakBytes);
  visit({"not_counted", "why the work of the passes was not counted; empty when it was"},
        run.point.whyNotCounted);
  visit({"failure", "why there are no numbers; empty when there are", kCsv}, run.point.failure);
  visit({"command", "repeats the point", kCsv}, run.point.command);
  visit({"node", nullptr, kCsv}, run.node);
  visit({"measuring_seconds",
         "the machine's name in its network; how long it measured, its share of a batch's times included",
         kCsv},
        run.seconds);
  visit({"load_before", nullptr, kCsv}, run.before.load);
  visit({"load_after", nullptr, kCsv}, run.after.load);
  visit({"clock_mhz_before", nullptr, kCsv}, run.before.clockMhz);
  visit({"clock_mhz_after", nullptr, kCsv}, run.after.clockMhz);
  visit({"device_clock_mhz_before", nullptr, kCsv}, run.before.deviceClockMhz);
  visit(
      {"device_clock_mhz_after",
       "around its times: runnable processes, the mean clock of the processors, the GPU's clock; NULL where the system does not say",
       kCsv},
      run.after.deviceClockMhz);
  visit({"voxels"}, run.point.voxels);
  visit({"health_findings", nullptr, kCsv}, run.point.healthFindings);
  visit({"notes"}, run.point.notes);
  visit({"passes"}, Passes{run.point});
  visit({"errors", "JSON, which the views below show as tables"}, run.point.errors);
}

void fields(Is<PassFields> auto& pass, auto&& visit) {
  visit({"name"}, pass.name);
  visit({"ran"}, pass.ran);
  visit({"device_ms"}, pass.device);
  visit({"host_ms"}, pass.host);
  visit({"bytes"}, pass.bytes);
  visit({"work"}, pass.work);
  if (pass.bounds.empty() || !pass.device || !(pass.device->median > 0.0)) return;
  std::map<std::string, double> least;
  for (const WorkBound& bound : pass.bounds) least[bound.resource] = bound.ms;
  visit({"limited_by"}, Derived{pass.bounds.front().resource});
  visit({"of_peak_rate"}, Derived{pass.bounds.front().ms / pass.device->median});
  visit({"at_least_ms"}, Derived{least});
}

void fields(Is<ComponentError> auto& error, auto&& visit) {
  visit({"output", nullptr, kCsv}, error.output);
  visit({"component", nullptr, kCsv}, error.component);
  visit({"reference", "one row per output and reference layer", kCsv}, error.reference);
  visit({"against", "`bias` (the technique's own model) or `misses` (full transport)", kCsv},
        Against{error.bias});
  visit({"seeds", nullptr, kCsv}, error.seeds);
  visit({"enough_seeds"}, Derived{error.enoughSeeds()});
  visit({"deterministic", nullptr, kCsv}, error.deterministic);
  visit(
      {"noise_rmse",
       "seeds that were run; 1 when they are enough for a claim; 1 when they gave the same bits; RMS of the image's own noise"},
      error.noiseRmse);
  visit(
      {"per_seed",
       "1: every metric is the mean over the seeds; 0: from a store of schema 3 or before, where all but the RMSE are of the first "
       "seed and their uncertainties lack the spread"},
      error.everyMetricPerSeed);
  visit({"metrics"}, Metrics{error});
  visit({"ratio_to_nothing", "RMSE / RMSE of a black image"}, Derived{error.ratioToNothing()});
}

void fields(Is<NamedMetric> auto& metric, auto&& visit) {
  fields(metric.measured, visit);
  visit({"of_nothing", "with its standard uncertainty; the same metric of a black image"}, metric.ofNothing);
}

void fields(Is<VoxelError> auto& error, auto&& visit) {
  visit({"true_positive"}, error.truePositive);
  visit({"false_positive"}, error.falsePositive);
  visit({"false_negative"}, error.falseNegative);
  visit({"recall", nullptr, kCsv}, Derived{error.recall()});
  visit({"precision", "as in [the metrics](metrics.md#voxels)", kCsv}, Derived{error.precision()});
}

void fields(Is<RayHoles> auto& holes, auto&& visit) {
  visit({"axis_crossings"}, holes.axisCrossings);
  visit({"axis_holes"}, holes.axisHoles);
  visit({"oblique_crossings"}, holes.obliqueCrossings);
  visit({"oblique_holes"}, holes.obliqueHoles);
  visit({"axis_share", nullptr, "axis_holes"}, Derived{holes.axisShare()});
  visit({"oblique_share", "crossings of rays with the surface; how many are holes, and their share",
         "oblique_holes"},
        Derived{holes.obliqueShare()});
}

/// Comparison of an occupied grid with the exact test.
void judgedFields(auto& voxels, const char* csv, auto&& visit) {
  visit({"occupied", nullptr, csv}, voxels.occupied);
  visit({"reference", nullptr, csv}, voxels.reference);
  visit({"undecided", "voxels that are occupied; that the exact test is certain of; that it leaves undecided",
         csv},
        voxels.undecided);
  fields(voxels.error, visit);
  fields(voxels.holes, visit);
}

void fields(Is<GatheredVoxels> auto& voxels, auto&& visit) {
  visit({"output", nullptr, "voxels"}, voxels.output);
  visit({"kind", "which output of which pass, `voxels.fragments`, and its kind of port"}, voxels.kind);
  visit({"resolution", "voxels of the grid along x, y and z"}, voxels.resolution);
  visit({"why_not", "why they were not judged, there are no numbers then; empty when they were",
         "voxels_not_judged"},
        voxels.whyNot);
  if (voxels.whyNot.empty()) judgedFields(voxels, nullptr, visit);
}

void fields(Is<GridPlacement> auto& grid, auto&& visit) {
  visit({"low_m"}, grid.low);
  visit({"voxel_size_m"}, grid.voxelSize);
  visit({"resolution"}, grid.resolution);
}

void fields(Is<VoxelizerRecord> auto& record, auto&& visit) {
  visit({"scene", nullptr, kCsv}, record.scene);
  visit({"pipeline", nullptr, kCsv}, record.pipeline);
  visit({"default", nullptr, kCsv}, record.isDefault);
  visit({"label", nullptr, kCsv}, Derived{record.label()});
  visit({"output", nullptr, kCsv}, record.output);
  visit({"kind"}, record.kind);
  visit({"resolution", nullptr, kCsv}, record.resolution);
  visit({"triangles", nullptr, kCsv}, record.triangles);
  visit({"subdivisions", nullptr, kCsv}, record.subdivisions);
  visit({"parameters", nullptr, kCsv}, record.parameters);
  visit({"why_not", nullptr, "failure"}, record.whyNot);
  if (!record.whyNot.empty()) return;
  visit({"grid"}, record.grid);
  visit({"frame_ms", nullptr, kCsv}, record.frameMs);
  visit({"repeats", nullptr, kCsv}, Derived{record.frameMs.repeats});
  judgedFields(record, kCsv, visit);
  visit({"fragments", nullptr, kCsv}, record.fragments);
  visit({"bytes", nullptr, kCsv}, record.bytes);
  visit({"allocated_bytes", nullptr, kCsv}, record.allocatedBytes);
  visit({"bytes_per_fragment"}, Derived{record.bytesPerFragment()});
  visit({"bytes_per_voxel"}, Derived{record.bytesPerVoxel()});
}

void fields(Is<LeftOut> auto& left, auto&& visit) {
  visit({"level"}, Derived{name(left.level)});
  visit({"what"}, left.what);
  visit({"why"}, left.why);
  visit({"pass"}, left.pass);
  visit({"saved_bytes"}, left.savedBytes);
  visit({"saved_ms"}, left.savedMs);
}

void fields(Is<StressCell> auto& cell, auto&& visit) {
  visit({"created", nullptr, kCsv}, cell.created);
  visit({"version", "when, by which version", kCsv}, cell.version);
  visit({"family", nullptr, kCsv}, cell.family);
  visit({"case", "of the case (docs/stress.md)", kCsv, "name"}, cell.name);
  visit({"pipeline", nullptr, kCsv}, cell.pipeline);
  visit({"technique", "file as given; the technique that it represents", kCsv}, cell.technique);
  visit({"size", "`quick` or `full`", kCsv}, cell.size);
  visit({"measure", nullptr, kCsv}, cell.measure);
  visit({"unit", "what was measured; both are empty where only health was looked at", kCsv}, cell.unit);
  visit({"detail", "the first bad pass, port and pixel, the refusal, or more numbers", kCsv}, cell.detail);
  visit({"explanation", "a property of the published method, from its paper card", kCsv}, cell.explanation);
  visit({"image", nullptr, kCsv}, cell.image);
  visit({"command", "file beside the page; repeats the cell", kCsv}, cell.command);
  visit({"pipeline_hash", nullptr, kCsv}, cell.pipelineHash);
  visit({"framework", "content hashes", kCsv}, cell.framework);
  deviceFields(cell, kCsv, visit);
  visit({"outcome", "stable, biased, diverges, refused, not_applicable, broken", kCsv}, cell.outcome);
  visit({"value", nullptr, kCsv}, cell.value.value);
  visit({"uncertainty", nullptr, kCsv}, cell.value.uncertainty);
  visit(
      {"limit", "in that unit, with its standard uncertainty; beyond the limit: biased", kCsv, "limit_value"},
      cell.limit);
  visit({"seconds", "how long it took", kCsv}, cell.seconds);
  visit({"techniques", "name to hash of library and shaders, JSON"}, cell.techniques);
}

void fields(Is<PeakRate> auto& rate, auto&& visit) {
  visit({"name"}, rate.name);
  visit({"unit", "the resource whose peak rate was measured (docs/commands.md, `lumivox device`)"},
        rate.unit);
  fields(rate.rate, visit);
  visit({"created"}, rate.created);
  visit({"version", "when, by which version"}, rate.version);
  deviceFields(rate, nullptr, visit);
}

void fields(Is<Explanation> auto& explanation, auto&& visit) {
  visit({"passes_kept"}, explanation.passesKept);
  visit({"passes_total"}, explanation.passesTotal);
  visit({"variants_possible"}, explanation.variantsPossible);
  visit({"variants_compiled"}, explanation.variantsCompiled);
  visit({"variants_needed"}, explanation.variantsNeeded);
  visit({"left_out"}, explanation.leftOut);
}

void fields(Is<PrunedPass> auto& pass, auto&& visit) {
  visit({"name"}, pass.name);
  visit({"ms"}, pass.ms);
  visit({"ms_keep_everything"}, pass.everythingMs);
}

void fields(Is<PruningRecord> auto& record, auto&& visit) {
  const auto timed = [&](const auto& value) {
    return Derived{record.prunedMs.repeats > 0 ? std::optional(value) : std::nullopt};
  };
  visit({"scene"}, record.scene);
  visit({"pipeline"}, record.pipeline);
  fields(record.explanation, visit);
  visit({"frame_ms"}, timed(record.prunedMs));
  visit({"frame_ms_keep_everything"}, timed(record.unprunedMs));
  visit({"saved_share"}, timed(record.savedShare()));
  visit({"next_frame_ms"}, timed(record.nextPrunedMs));
  visit({"next_frame_ms_keep_everything"}, timed(record.nextUnprunedMs));
  visit({"standing_share"}, timed(record.standingShare()));
  visit({"bytes"}, record.prunedBytes);
  visit({"bytes_keep_everything"}, record.unprunedBytes);
  visit({"same_image"}, record.sameImage);
  visit({"passes"}, Derived{passesOf(record)});
}

void fields(Is<ReferenceRecord> auto& reference, auto&& visit) {
  visit({"layer"}, reference.layer);
  visit({"noise"}, reference.noise);
  visit({"mean"}, reference.mean);
  visit({"largest"}, reference.largest);
  visit({"exposure_ev"}, reference.exposure);
}

void fields(Is<LeftOutPoint> auto& point, auto&& visit) {
  visit({"pipeline"}, point.pipeline);
  visit({"sweep"}, point.sweep);
  visit({"parameters"}, point.parameters);
}

template <class T>
concept HasFields = requires(T& record) {
  fields(record, [](const Field&, auto&&) {});
};

}  // namespace lumivox::results
