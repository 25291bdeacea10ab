// Defects of a page, as a browser without a network sees it: any page of the laboratory.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/browser.h"

namespace lumivox::test {

struct PageFindings {
  std::size_t canvases = 0, charts = 0, tables = 0, rows = 0, images = 0, links = 0;
  /// Of the page as it opens: its height in a window of 1400 x 900, and where the first chart and the first
  /// image end there or in one of 800 x 900, whichever is later, CSS pixels; infinite when there is none or
  /// it is folded.
  double height = 0.0, firstChartEnds = 0.0, firstImageEnds = 0.0;
  struct Control {
    std::string name;         ///< its tag and attributes
    bool slider = false;      ///< else a choice
    std::size_t changed = 0;  ///< pixels of the canvases that were other ones at its ends or other choices
  };
  std::vector<Control> controls;
  /// Sentences, each with the element: a script's error, a blank canvas, a chart without a point in it, a
  /// control that changes nothing, a table without rows or with a cell like "undefined", an image that does
  /// not show, a link to nowhere, a request to elsewhere, a body wider than the window (1400, 800 and 390
  /// pixels, and a sheet of paper), texts or images that lie upon each other, a text that is cut, a caption
  /// that is broken within a word, a head that
  /// does not sort, arrow keys that tell no point, a control without a name, a text that is hardly darker or
  /// lighter than what is behind it (on a light and on a dark page).
  std::vector<std::string> problems;

  bool hasProblem(const std::string& part) const;  ///< some sentence contains it
  std::string text() const;                        ///< all problems, one a line
};

/// Opens all details, moves every slider, tries every choice and box and sorts every table. The page's file
/// stays as it is.
PageFindings checkPage(Browser& browser, const std::filesystem::path& page);

/// The first place of the text where it would load something from elsewhere; empty: nowhere.
std::string externalLoad(const std::string& html);

}  // namespace lumivox::test
