// One self-contained page: records as JSON, and the scripts that draw them (assets/).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lumivox::page {

struct Document {
  std::string title;
  nlohmann::ordered_json data;         ///< the block "data"
  nlohmann::ordered_json images = {};  ///< the block "images", Base64; null: none
  bool charts = false;                 ///< with Chart.js in it
  std::vector<const char*> scripts;    ///< in this order, after kPageJs
};
std::string html(const Document& document);

/// Chart.js of the distribution (package libjs-chart.js). AbsentError names the package and where it was
/// sought.
std::string chartLibrary();

}  // namespace lumivox::page
