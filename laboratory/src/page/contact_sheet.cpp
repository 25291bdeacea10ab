#include "lumivox/page/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/measure/exposure.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wcast-align"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

namespace lumivox {
namespace {

constexpr int kLine =
    16;  // pixels from one line of text to the next: letters of stb_easy_font are up to 12 high
constexpr int kMargin = 6;   // around panels and text
constexpr int kLeast = 160;  // width of a panel below which its name would not fit
constexpr float kPaper = 1.0f, kInk = 0.0f, kEmpty = 0.8f;  // display values

/// The text with question marks for characters that the font lacks.
std::string printable(const std::string& text) {
  std::string result;
  for (const char c : text)
    if ((static_cast<unsigned char>(c) & 0xC0u) != 0x80u)  // one for each UTF-8 sequence
      result += c >= ' ' && c <= '~' ? c : '?';
  return result;
}

/// The words broken into lines that are at most so many pixels wide.
std::vector<std::string> lines(const std::string& text, int width) {
  std::vector<std::string> result{""};
  std::istringstream words(printable(text));
  for (std::string word; words >> word;) {
    std::string longer = result.back().empty() ? word : result.back() + " " + word;
    if (!result.back().empty() && stb_easy_font_width(longer.data()) > width)
      result.push_back(word);
    else
      result.back() = std::move(longer);
  }
  return result;
}

/// Fills a rectangle, clipped to the sheet, with a display value.
void fill(ImageBuffer& sheet, int left, int top, int width, int height, float value) {
  for (int y = std::max(0, top); y < std::min(sheet.height(), top + height); ++y)
    for (int x = std::max(0, left); x < std::min(sheet.width(), left + width); ++x)
      for (int c = 0; c < sheet.channels(); ++c) sheet.at(x, y, c) = value;
}

void write(ImageBuffer& sheet, int left, int top, std::string text) {
  constexpr std::size_t kQuadFloats = 4 * 4;  // four corners of x, y, z and a colour
  // stb_easy_font asks for 270 bytes a letter on the average; a letter has at most 24 quads.
  std::vector<float> quads(text.size() * 24 * kQuadFloats + kQuadFloats);
  const int count =
      stb_easy_font_print(static_cast<float>(left), static_cast<float>(top), text.data(), nullptr,
                          quads.data(), static_cast<int>(quads.size() * sizeof(float)));
  for (std::size_t quad = 0; quad < static_cast<std::size_t>(count); ++quad) {
    const float* first = quads.data() + quad * kQuadFloats;
    const float* third = first + 2 * kQuadFloats / 4;  // the opposite corner
    fill(sheet, static_cast<int>(std::lround(first[0])), static_cast<int>(std::lround(first[1])),
         static_cast<int>(std::lround(third[0] - first[0])),
         static_cast<int>(std::lround(third[1] - first[1])), kInk);
  }
}

/// Enlarged or reduced to the nearest texel, so that what is coarse looks coarse.
void draw(ImageBuffer& sheet, int left, int top, int width, int height, const SheetPanel& panel) {
  const ImageBuffer& image = panel.image;
  const float factor = panel.display.factor();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int sourceX = x * image.width() / width, sourceY = y * image.height() / height;
      for (int c = 0; c < sheet.channels(); ++c)
        sheet.at(left + x, top + y, c) = toneMapped(
            factor * image.at(sourceX, sourceY, image.channels() == 1 ? 0 : c), panel.display.tone);
    }
}

int columnsOf(int panels, int wanted) {
  return std::min(panels,
                  wanted > 0 ? wanted : static_cast<int>(std::ceil(std::sqrt(static_cast<double>(panels)))));
}

}  // namespace

int sheetPanelWidth(int panels) {
  constexpr int kScreen = 1920;
  const int columns = columnsOf(panels, 0);
  return std::max(kLeast, (kScreen - kMargin) / columns - kMargin);
}

ImageBuffer thumbnail(const ImageBuffer& image, const Display& display, int mostWidth) {
  const int width = std::min(image.width(), mostWidth);
  const int height =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(image.height()) * width / image.width())));
  ImageBuffer result(width, height, image.channels());
  const float factor = display.factor();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // Whole pixels; each belongs to one of the result where that is smaller.
      const int left = x * image.width() / width, right = (x + 1) * image.width() / width;
      const int top = y * image.height() / height, bottom = (y + 1) * image.height() / height;
      for (int c = 0; c < image.channels(); ++c) {
        float sum = 0.0f;
        for (int sourceY = top; sourceY < bottom; ++sourceY)
          for (int sourceX = left; sourceX < right; ++sourceX)
            sum += toneMapped(factor * image.at(sourceX, sourceY, c), display.tone);
        result.at(x, y, c) = sum / static_cast<float>((right - left) * (bottom - top));
      }
    }
  return result;
}

ImageBuffer contactSheet(const Sheet& wanted) {
  const int count = static_cast<int>(wanted.panels.size());
  if (count == 0) throw Error(fmt::format("{}: there are no panels for a sheet", wanted.title));
  int widest = 0, height = 0;
  for (const SheetPanel& panel : wanted.panels) {
    widest = std::max(widest, panel.image.width());
    height = std::max(height, panel.image.height());
  }
  const int width = std::max(kLeast, widest);
  if (widest > 0) height = height * width / widest;  // small images are enlarged
  if (height == 0) height = width * 3 / 4;           // nothing but reasons
  const int columns = columnsOf(count, wanted.columns);
  const int rows = (count + columns - 1) / columns;
  std::size_t nameLines = 1;
  for (const SheetPanel& panel : wanted.panels)
    nameLines = std::max(nameLines, lines(panel.name, width).size());
  const int nameHeight = static_cast<int>(nameLines) * kLine;
  const int sheetWidth = columns * (width + kMargin) + kMargin;
  const std::vector<std::string> title = lines(wanted.title, sheetWidth - 2 * kMargin);
  const int titleHeight = static_cast<int>(title.size()) * kLine + kMargin;

  constexpr int kChannels = 3;
  ImageBuffer sheet(sheetWidth, titleHeight + rows * (height + nameHeight + 2 * kMargin), kChannels, kPaper);
  for (std::size_t i = 0; i < title.size(); ++i)
    write(sheet, kMargin, kMargin + static_cast<int>(i) * kLine, title[i]);
  for (int i = 0; i < count; ++i) {
    const SheetPanel& panel = wanted.panels[static_cast<std::size_t>(i)];
    const int left = kMargin + i % columns * (width + kMargin),
              top = titleHeight + kMargin + i / columns * (height + nameHeight + 2 * kMargin);
    std::vector<std::string> name = lines(panel.name, width);
    for (std::size_t line = 0; line < name.size(); ++line)
      write(sheet, left, top + height + 4 + static_cast<int>(line) * kLine, name[line]);
    if (!panel.image.empty()) {
      // Smaller images, of half the resolution say, fill the same space.
      const double factor = std::min(static_cast<double>(width) / panel.image.width(),
                                     static_cast<double>(height) / panel.image.height());
      draw(sheet, left, top, static_cast<int>(std::lround(factor * panel.image.width())),
           static_cast<int>(std::lround(factor * panel.image.height())), panel);
      continue;
    }
    fill(sheet, left, top, width, height, kEmpty);
    const std::vector<std::string> why = lines(panel.whyNot, width - 2 * kMargin);
    for (std::size_t line = 0; line < why.size(); ++line)
      write(sheet, left + kMargin, top + kMargin + static_cast<int>(line) * kLine, why[line]);
  }
  return sheet;
}

ImageBuffer contactSheet(const ReproducedResult& result) {
  Sheet sheet;
  sheet.title =
      fmt::format("{}: {} ({})", result.published.id, result.published.title, exposureText(result.exposure));
  sheet.columns = result.published.columns;
  for (const ShownPanel& panel : result.panels)
    sheet.panels.push_back({panel.name, panel.image,
                            panel.radiance ? Display{result.exposure, kShownTone} : Display{}, panel.whyNot});
  return contactSheet(sheet);
}

}  // namespace lumivox
