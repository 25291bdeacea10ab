// The block of a capture in a scene text.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/block_reader.h"

namespace lumivox {
namespace {

using dsl::CheckedBlock;
using dsl::Property;

void readFormat(BlockReader& reader, const CheckedBlock& block, CaptureText& text) {
  const Property* property = block.find("format");
  if (property == nullptr) return;
  text.format = block.text("format", "");
  const bool isSens = text.format == "sens", isExr = text.format == "exr";
  if (isSens != text.file.has_value() || isExr != text.files.has_value())
    reader.report(*property,
                  fmt::format("format '{}' beside '{}'", *text.format,
                              text.folder ? "folder"
                              : text.file ? "file"
                                          : "files"),
                  isSens  ? "file \"NAME.sens\""
                  : isExr ? "files \"NAME_####.exr\""
                          : "folder \"FOLDER\"");
}

void readCamera(BlockReader& reader, const CheckedBlock& block, CaptureText& text) {
  const auto pair = [&](const char* word) -> std::optional<glm::dvec2> {
    if (!block.has(word)) return std::nullopt;
    const std::vector<double> values = block.numbers(word, {});
    return glm::dvec2(values.at(0), values.at(1));
  };
  text.focal = pair("focal");
  text.centre = pair("centre");
  constexpr double kShortestFocal = 1e-3;  // pixels
  if (text.focal && (text.focal->x < kShortestFocal || std::abs(text.focal->y) < kShortestFocal))
    reader.report(
        *block.find("focal"), "the focal length is too short, or negative along x",
        fmt::format("two lengths of at least {} pixels; along y it may be negative", kShortestFocal));
  if (text.focal.has_value() != text.centre.has_value())
    reader.report(*block.find(text.focal ? "focal" : "centre"),
                  fmt::format("'{}' alone", text.focal ? "focal" : "centre"), "focal FX FY and centre CX CY");
  if (block.has("depth_scale")) text.depthScale = block.number("depth_scale", 1.0);
  const Property* property = block.find("distortion");
  if (property == nullptr) return;
  const bool numbers =
      std::all_of(property->values.begin(), property->values.end(), [](const dsl::Value& value) {
        return value.kind == dsl::ValueKind::number && !value.unit && std::abs(value.number) <= 1e3;
      });
  if (!numbers || property->values.size() != text.distortion.size()) {
    reader.report(*property, "the distortion is not five numbers", "k1 k2 p1 p2 k3, each from -1000 to 1000");
    return;
  }
  for (std::size_t i = 0; i < text.distortion.size(); ++i) text.distortion[i] = property->values[i].number;
}

}  // namespace

std::optional<CaptureText> describeCapture(BlockReader& reader, const CheckedBlock& block) {
  CaptureText text;
  text.name = block.name();
  text.place = block.block().place;
  text.folder = reader.placed(block, "folder");
  text.file = reader.placed(block, "file");
  text.files = reader.placed(block, "files");
  const int sources = text.folder.has_value() + text.file.has_value() + text.files.has_value();
  if (sources != 1) {
    reader.report(block.block().place, static_cast<int>(block.block().word.size()),
                  sources == 0 ? "the capture names no files" : "the capture names its files twice",
                  "one of folder \"FOLDER\", file \"NAME.sens\" and files \"NAME_####.exr\"");
  }
  if (text.file) reader.requireFormat(*text.file, "capture", kSensorFormats);
  if (text.files) {
    reader.requireFormat(*text.files, "capture", kFloatImageFormats);
    if (text.files->text.find('#') == std::string::npos)
      reader.report(text.files->place, text.files->length, "the file name has no place for the frame number",
                    "a name such as \"room_####.exr\"");
  }
  readFormat(reader, block, text);
  readCamera(reader, block, text);
  text.linear = block.text("transfer", "srgb") == "linear";
  text.exposure = block.number("exposure", 1.0);
  if (block.has("range")) {
    const std::vector<double> range = block.numbers("range", {});
    text.range.emplace(static_cast<int>(range.at(0)), static_cast<int>(range.at(1)));
  }
  text.rate = block.number("rate", text.rate);
  text.translation = reader.vector(block, "translate", glm::dvec3(0));
  if (block.has("rotate"))
    text.rotation =
        glm::angleAxis(block.numbers("rotate", {}).at(3), reader.direction(block, "rotate", {0, 1, 0}));
  text.standsFor = reader.placed(block, "stands_for");
  if (text.standsFor) reader.requireFormat(*text.standsFor, "scene", kSceneFormats);
  return sources == 1 ? std::optional(std::move(text)) : std::nullopt;
}

}  // namespace lumivox
