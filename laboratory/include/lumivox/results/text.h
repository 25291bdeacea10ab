// Numbers and names as readers see them.
#pragma once

#include <string>

#include "lumivox/measure/metrics.h"
#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

/// Three digits, whole from 100 on: "0.0123", "4.56", "1548".
std::string formatMilliseconds(double milliseconds);
/// "[1.1, 1.4]"; empty: there are none of fewer than kLeastRepeats repeats.
std::string formatQuartiles(const TimingStatistics& time);

/// Three digits and the thousands: "1.23 G", "45.6 k".
std::string formatThousands(double value);

/// A share as "12 %", never "-0 %".
std::string formatPercent(double share);

/// "cones=6 resolution=64", or "default" without parameters.
std::string pointText(const ParameterValues& parameters);

/// "cones 6, resolution 64", or "default".
std::string parametersText(const ParameterValues& values);

/// "cornell" of "scenes/cornell.scene".
std::string shortName(const std::string& file);

}  // namespace lumivox
