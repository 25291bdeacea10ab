// Finds defects of any page of the laboratory in a browser without a network.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/browser.h"

namespace lumivox::test {

struct PageFindings {
  std::size_t canvases = 0, charts = 0, tables = 0, rows = 0, images = 0, links = 0;
  /// The page as it opens, in CSS pixels. height: in a window of 1400 x 900. firstChartEnds, firstImageEnds:
  /// the lower end of the first chart and image, the larger value of the windows 1400 x 900 and 800 x 900;
  /// infinite if there is none or it is folded.
  double height = 0.0, firstChartEnds = 0.0, firstImageEnds = 0.0;
  struct Control {
    std::string name;         ///< its tag and attributes
    bool slider = false;      ///< else a choice
    std::size_t changed = 0;  ///< pixels of the canvases that differ between its ends or choices
  };
  std::vector<Control> controls;
  /// Sentences, each with the element. Scripts and data: an error, a blank canvas, a chart without points, a
  /// table without rows or with a cell like "undefined", an image that does not show, a broken link, an
  /// external request. Layout: a body wider than the window (1400, 800 and 390 pixels, and a sheet of paper),
  /// texts or images that overlap, a text that is cut off, a caption that breaks within a word, too little
  /// contrast of a text (on a light and on a dark page). Use: a control that changes nothing or has no name,
  /// a table head that does not sort, arrow keys that select no point.
  std::vector<std::string> problems;

  bool hasProblem(const std::string& part) const;  ///< whether a sentence contains it
  std::string text() const;                        ///< all problems, one a line
};

/// Opens all details, moves every slider, tries every choice and box, and sorts every table. Does not change
/// the page's file.
PageFindings checkPage(Browser& browser, const std::filesystem::path& page);

/// The first part of the text that would load an external resource; empty if there is none.
std::string externalLoad(const std::string& html);

}  // namespace lumivox::test
