// The panels of a figure on one sheet, under one exposure, each with its name.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/page/reproduction_page.h"

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

/// The display value of a paper without anything on it.
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
void draw(ImageBuffer& sheet, int left, int top, int width, int height, const ImageBuffer& image,
          double exposure) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int sourceX = x * image.width() / width, sourceY = y * image.height() / height;
      for (int c = 0; c < sheet.channels(); ++c)
        sheet.at(left + x, top + y, c) =
            static_cast<float>(exposure * image.at(sourceX, sourceY, image.channels() == 1 ? 0 : c));
    }
}

}  // namespace

ImageBuffer contactSheet(const ReproducedResult& result) {
  const int count = static_cast<int>(result.panels.size());
  if (count == 0) throw Error(fmt::format("{}: there are no panels for a sheet", result.published.id));
  int width = kLeast, height = 0;
  for (const ShownPanel& panel : result.panels) {
    width = std::max(width, panel.image.width());
    height = std::max(height, panel.image.height());
  }
  if (height == 0) height = width * 3 / 4;  // nothing but reasons
  const int columns =
      std::min(count, result.published.columns > 0
                          ? result.published.columns
                          : static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count)))));
  const int rows = (count + columns - 1) / columns;
  std::size_t nameLines = 1;
  for (const ShownPanel& panel : result.panels)
    nameLines = std::max(nameLines, lines(panel.name, width).size());
  const int nameHeight = static_cast<int>(nameLines) * kLine;
  const int sheetWidth = columns * (width + kMargin) + kMargin;
  const std::vector<std::string> title = lines(
      fmt::format("{}: {} (exposure {:.3g})", result.published.id, result.published.title, result.exposure),
      sheetWidth - 2 * kMargin);
  const int titleHeight = static_cast<int>(title.size()) * kLine + kMargin;

  constexpr int kChannels = 3;
  ImageBuffer sheet(sheetWidth, titleHeight + rows * (height + nameHeight + 2 * kMargin), kChannels, kPaper);
  for (std::size_t i = 0; i < title.size(); ++i)
    write(sheet, kMargin, kMargin + static_cast<int>(i) * kLine, title[i]);
  for (int i = 0; i < count; ++i) {
    const ShownPanel& panel = result.panels[static_cast<std::size_t>(i)];
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
           static_cast<int>(std::lround(factor * panel.image.height())), panel.image, result.exposure);
      continue;
    }
    fill(sheet, left, top, width, height, kEmpty);
    const std::vector<std::string> why = lines(panel.whyNot, width - 2 * kMargin);
    for (std::size_t line = 0; line < why.size(); ++line)
      write(sheet, left + kMargin, top + kMargin + static_cast<int>(line) * kLine, why[line]);
  }
  return sheet;
}

}  // namespace lumivox
