// Records as JSON: the one place that says how each is written.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/results/records.h"
#include "lumivox/results/report_record.h"
#include "lumivox/results/stress_cells.h"
#include "lumivox/results/voxelizers.h"

namespace lumivox {

/// JSON has no NaN and no infinity: null.
nlohmann::ordered_json numberJson(double value);
/// With "replacement characters" for bytes that are no UTF-8; an indent below 0 makes one line.
std::string textOf(const nlohmann::ordered_json& json, int indent);

nlohmann::ordered_json toJson(const Measured& measured);
nlohmann::ordered_json toJson(const TimingStatistics& statistics);
nlohmann::ordered_json toJson(const ParameterValues& values);
/// With number and key in front where it is in a store.
nlohmann::ordered_json toJson(const StoredRun& run);
nlohmann::ordered_json runsJson(const std::vector<StoredRun>& runs);
nlohmann::ordered_json toJson(const PruningRecord& record);
nlohmann::ordered_json toJson(const std::vector<PeakRate>& peakRates);
nlohmann::ordered_json toJson(const std::vector<VoxelizerRecord>& records);
nlohmann::ordered_json toJson(const StressCell& cell);
/// All but its points, prunings and what is found from them.
nlohmann::ordered_json toJson(const SceneRecord& scene);

}  // namespace lumivox
