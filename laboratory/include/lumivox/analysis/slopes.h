// How fast errors fall and times grow with a parameter: the slopes of a sweep.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lumivox/measure/power_law.h"
#include "lumivox/results/records.h"

namespace lumivox {

/// One quantity of one pipeline over one parameter, all others fixed.
struct SweepSlope {
  std::string pipeline, parameter, others;  ///< file; name; "cones 6" or empty
  std::string output, quantity;             ///< output empty for times; "bias", "misses", "noise", "time"
  double low = 0.0, high = 0.0;             ///< of the parameter
  PowerLaw law;
};

/// For every numeric parameter that takes three values or more while the others stay. Errors are RMSE without
/// the reference's noise, and noise is the image's own; points at which nothing is left are left out.
std::vector<SweepSlope> slopesOf(const std::vector<const ReportPoint*>& points);

nlohmann::ordered_json toJson(const std::vector<SweepSlope>& slopes);

}  // namespace lumivox
