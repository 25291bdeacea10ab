// The main job: every pipeline at every point of its sweep, error and time apart, one page.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/plugin/loader.h"
#include "lumivox/reference/path_tracer.h"

namespace lumivox {

/// Error of one output against one truth layer.
struct ComponentError {
  std::string output;               ///< name in the pipeline text
  std::string component;            ///< name(Contributes)
  std::string truth;                ///< layer: one_bounce_diffuse (bias) or indirect_diffuse (what the viewer misses), ...
  PictureError error;
  Measured rmseOverSeeds;           ///< spread when several seeds were run
  PictureError errorOfNothing;      ///< of a black picture: what leaving the component out would cost
};

/// One sweep point: both error and time, in one record.
struct ReportPoint {
  std::string scene, pipeline, sweep;
  ParameterValues parameters;
  TimingStatistics frameMs;
  std::map<std::string, TimingStatistics> passDeviceMs, passHostMs;
  std::map<std::string, std::uint64_t> passBytes;
  double frameworkShare = 0.0;      ///< time between passes / frame
  std::uint64_t peakBytes = 0;
  std::vector<ComponentError> errors;
  std::vector<std::string> healthFindings;
  std::string command;              ///< that repeats it
};

struct ReportOptions {
  std::vector<std::filesystem::path> scenes, pipelines;  ///< no pipelines: every committed one that suits the scene
  std::vector<std::string> settings;
  std::filesystem::path output = "out/report/index.html";
  int truthSamples = 0;             ///< 0: chosen per resolution
  int width = 0, height = 0;        ///< 0: the camera's, reduced to at most 160 on a software rasteriser
  int repeats = 5, seeds = 1;
  bool openSweeps = true;           ///< false: only the default point
  std::string commandLine;
};

struct ReportSummary {
  std::vector<ReportPoint> points;
  std::filesystem::path page, csv, json;
};

ReportSummary makeReport(gpu::Device& device, TechniqueSet& techniques, const ReportOptions& options,
                         const std::function<Scene(const std::filesystem::path&)>& loadScene);

/// The truth layer that a component's bias is measured against, and the one for what the viewer misses.
std::pair<std::string, std::string> truthLayers(Contributes component);

}  // namespace lumivox
