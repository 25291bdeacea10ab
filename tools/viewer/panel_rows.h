// Helpers of the panels' sources that make rows.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "viewer/panels.h"

namespace lumivox::viewer {

Row heading(const std::string& label);
Row text(const std::string& name, const std::string& label, const std::string& value,
         const std::string& tooltip = {});
Row toggle(const std::string& name, const std::string& label, bool on, const std::string& statement,
           const std::string& tooltip = {});
Row button(const std::string& name, const std::string& label, const std::string& statement,
           const std::string& tooltip = {});
Row choice(const std::string& name, const std::string& label, const std::string& value,
           std::vector<std::string> choices, const std::string& statement, const std::string& tooltip = {});
Row number(const std::string& name, const std::string& label, double value, double low, double high,
           bool integer, const std::string& statement, const std::string& tooltip = {});
/// Three numbers in one control, each between the limits.
Row triple(const std::string& name, const std::string& label, const std::array<double, 3>& values, double low,
           double high, const std::string& statement, const std::string& tooltip = {});

// Panels in files of their own.
Panel changePanel(const Session& session);
Panel scenePanel(const Session& session);
Panel timePanel(const Session& session);

}  // namespace lumivox::viewer
