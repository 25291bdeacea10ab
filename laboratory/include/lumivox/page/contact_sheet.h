// Images side by side on one sheet, each with its name.
#pragma once

#include <string>
#include <vector>

#include "lumivox/base/image.h"
#include "lumivox/results/reproduction.h"

namespace lumivox {

struct SheetPanel {
  std::string name;
  ImageBuffer image;  ///< linear, one or three channels; empty where there is none
  Display display;
  std::string whyNot = {};  ///< stands in the place of an image that is not there
};
struct Sheet {
  std::string title;
  std::vector<SheetPanel> panels;
  int columns = 0;  ///< 0: about as many as rows
};

/// Display values in [0,1] for encodePng. What the font lacks is a question mark. Error without panels.
ImageBuffer contactSheet(const Sheet& sheet);
/// The panels of a figure under one exposure, those that are absent with the reason.
ImageBuffer contactSheet(const ReproducedResult& result);

/// For sheets of many images: how wide each of them may be, so that the sheet stays as wide as a screen
/// where that is possible.
int sheetPanelWidth(int panels);
/// The image as it is displayed, reduced to `mostWidth` by means over what each pixel covers, aspect kept;
/// for a panel with the usual display.
ImageBuffer thumbnail(const ImageBuffer& image, const Display& display, int mostWidth);

}  // namespace lumivox
