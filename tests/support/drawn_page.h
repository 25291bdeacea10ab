// A page drawn without a browser: its scripts run in Node on a small DOM (page_dom.js). It cannot check how
// the page looks; page_test does that where there is a browser.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "support/support.h"

namespace lumivox::test {

inline bool canDrawPages() {
  return std::system("node --version > /dev/null 2>&1") == 0;
}

/// Members: problems, text, html, tables (of rows of cells), links, svgs (plots to save), charts, controls,
/// images, headings.
inline nlohmann::json drawnPage(const std::filesystem::path& page) {
  const CommandResult drawn = runCommand(
      "node '" + (sourceDirectory() / "tests/support/page_dom.js").string() + "' '" + page.string() + "'");
  if (drawn.exitCode != 0) throw std::runtime_error("node: " + drawn.errors);
  return nlohmann::json::parse(drawn.output);
}

/// The JSON of a block of records in a page, by the block's id.
inline nlohmann::json pageRecords(const std::string& page, const std::string& id = "data") {
  const std::string start = "<script type=\"application/json\" id=\"" + id + "\">";
  const std::size_t at = page.find(start);
  if (at == std::string::npos) throw std::runtime_error("the page has no block '" + id + "'");
  return nlohmann::json::parse(
      page.substr(at + start.size(), page.find("</script>", at) - at - start.size()));
}

}  // namespace lumivox::test
