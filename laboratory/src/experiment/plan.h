// The pipelines and points that a report measures.
#pragma once

#include <string>
#include <vector>

#include "lumivox/experiment/report.h"
#include "lumivox/results/report_record.h"

namespace lumivox::experiment {

struct PlannedPoint {
  std::string sweep;
  ParameterValues parameters;
  bool isDefault = false;
  std::vector<std::uint64_t> seeds =
      {};  ///< each a run of its own; empty: one run with the seeds of the command line
};

/// The default point and the points of every sweep, each once. Settings pin their axes. A point of several
/// sweeps has the seeds of all of them. A progressive pipeline also has its default point after 2, 4 ..
/// `frames` frames; other pipelines drop an axis of frames.
std::vector<PlannedPoint> plannedPoints(const Pipeline& pipeline, const ParameterValues& settings,
                                        bool openSweeps, bool progressive = false, int frames = 1);
/// The points of these sweeps alone.
std::vector<PlannedPoint> pointsOfSweeps(const Pipeline& pipeline, const ParameterValues& settings,
                                         const std::vector<Sweep>& sweeps, bool progressive);
/// "pipeline "X" does not accumulate and is measured without the axis 'frames'", where a sweep has that axis;
/// else empty.
std::string withoutFrames(const Pipeline& pipeline, const std::vector<Sweep>& sweeps, bool progressive);

/// Those assignments "name=value" whose parameter the pipeline has.
std::vector<std::string> settingsFor(const Pipeline& pipeline, const std::vector<std::string>& assignments);

/// A path as one would type it: relative where it lies below the working directory.
std::string shownPath(const std::filesystem::path& path);

/// Quotes an argument for a POSIX shell where it needs it.
std::string shellQuoted(const std::string& argument);

/// The command that repeats one point.
std::string repeatingCommand(const ReportOptions& options, const std::string& scene,
                             const std::string& pipeline, const ParameterValues& parameters, int width,
                             int height, int samples);

}  // namespace lumivox::experiment
