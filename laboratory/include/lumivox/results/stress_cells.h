// Cells of the stress battery, as JSON and CSV.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/measure/metrics.h"

namespace lumivox {

/// The outcome of one pipeline on one stress case.
enum class StressOutcome {
  stable,         ///< healthy, and within the case's limit
  biased,         ///< healthy, bounded, and beyond the limit: `value` says by how much
  diverges,       ///< finite, but it grows without bound or does not converge where it should
  refused,        ///< a clear message in place of an image
  notApplicable,  ///< the case asks for something that the pipeline does not have
  broken          ///< NaN, infinite, negative radiance, a crash or a hang: never acceptable
};
const char* name(StressOutcome outcome);  ///< "not_applicable"
std::optional<StressOutcome> stressOutcomeNamed(const std::string& name);

/// One cell of the stress battery's matrix, with everything that it depends on.
struct StressCell {
  std::int64_t id = 0;
  std::string created, version;
  std::string family, name;  ///< of the case
  std::string pipeline;      ///< file as given
  std::string technique;     ///< the technique that the pipeline represents
  std::string size;          ///< "quick" or "full"
  StressOutcome outcome = StressOutcome::stable;
  std::string measure, unit;  ///< of value and limit; empty when only health was looked at
  Measured value;
  double limit = 0.0;
  std::string detail;       ///< the first bad pass, port and voxel or pixel; the refusal; more numbers
  std::string explanation;  ///< of a property of the published method, from the technique's card
  std::string image;        ///< file beside the page; empty: none
  std::string command;      ///< repeats it
  double seconds = 0.0;
  std::string pipelineHash, framework;            ///< content hashes
  std::map<std::string, std::string> techniques;  ///< name to hash of library and shader pack
  std::string device, driver, shaderInput, host;

  std::string key() const;       ///< 32 hexadecimal digits
  std::string anywhere() const;  ///< the same for whatever machine runs it
};

/// One cell as a JSON object in one line, and back. Error for a text that is none.
std::string stressCellJson(const StressCell& cell);
StressCell stressCellFrom(const std::string& json);
/// All of them as an indented list, and one row each (RFC 4180).
std::string stressCellsJson(const std::vector<StressCell>& cells);
std::string stressCellsCsv(const std::vector<StressCell>& cells);

/// The newest cell of each pipeline and case, a quick one only where there is no full one.
std::vector<StressCell> newestCells(const std::vector<StressCell>& cells);

/// "biased 0.031": the outcome with its number, as matrices show it; the outcome alone without one.
std::string stressValueText(const StressCell& cell);

}  // namespace lumivox
