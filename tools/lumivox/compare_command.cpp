// compare: errors of an EXR file against a reference.
#include <fmt/format.h>

#include <cmath>
#include <span>

#include "command.h"
#include "common/display_options.h"
#include "common/outputs.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "lumivox/measure/exposure.h"
#include "lumivox/measure/metrics.h"
#include "lumivox/page/contact_sheet.h"

namespace lumivox::command {
namespace {

struct CompareCommand {
  std::filesystem::path image, reference;
  std::vector<std::string> layers;
  std::filesystem::path sheet;
  DisplayOptions display;
  bool json = false;
  double rmseAtMost = -1.0;
};

/// A layer of the image and the layer of the reference that it is compared with.
using LayerPair = std::pair<std::string, std::string>;

constexpr double kLargestError = 1e37;
constexpr const char* kMainLayer = "main";  // the command line's word for the layer without a name
constexpr const char* kVariance = ".variance";

std::string shown(const std::string& layer) {
  return layer.empty() ? kMainLayer : layer;
}
bool isVariance(const std::string& layer) {
  return layer.size() > 9 && layer.rfind(kVariance) == layer.size() - 9;
}

std::vector<std::string> namesIn(const LayeredImage& file) {
  std::vector<std::string> names;
  for (const auto& [name, image] : file.layers)
    if (!isVariance(name)) names.push_back(shown(name));
  return names;
}

const ImageBuffer& layerIn(const LayeredImage& file, const std::filesystem::path& path,
                           const std::string& layer) {
  const auto found = file.layers.find(layer == kMainLayer && file.layers.count(layer) == 0 ? "" : layer);
  if (found != file.layers.end()) return found->second;
  const std::vector<std::string> names = namesIn(file);
  const std::string nearest = nearestWord(layer, names);
  throw Error(fmt::format("{}: no layer '{}'; expected one of {}{}", path.string(), shown(layer),
                          fmt::join(names, ", "),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

std::vector<LayerPair> pairsOf(const CompareCommand& command, const LayeredImage& image,
                               const LayeredImage& reference) {
  std::vector<LayerPair> pairs;
  for (const std::string& layer : command.layers) {
    const std::size_t equals = layer.find('=');
    const std::string own = layer.substr(0, equals);
    pairs.emplace_back(own, equals == std::string::npos ? own : layer.substr(equals + 1));
  }
  if (!pairs.empty()) return pairs;
  for (const auto& [name, values] : image.layers)
    if (!isVariance(name) && reference.layers.count(name) != 0) pairs.emplace_back(name, name);
  if (pairs.empty())
    throw Error(fmt::format(
        "{} and {} have no layer in common; choose with --layer A=B; the first has {}; the second has {}",
        command.image.string(), command.reference.string(), fmt::join(namesIn(image), ", "),
        fmt::join(namesIn(reference), ", ")));
  return pairs;
}

/// The image without its fourth channel, which is coverage, not radiance.
ImageBuffer withoutAlpha(const ImageBuffer& image) {
  if (image.channels() != 4) return image;
  ImageBuffer rgb(image.width(), image.height(), 3);
  for (std::size_t pixel = 0; pixel < image.pixelCount(); ++pixel)
    for (std::size_t channel = 0; channel < 3; ++channel)
      rgb.values()[3 * pixel + channel] = image.values()[4 * pixel + channel];
  rgb.setRadiance(image.isRadiance());
  return rgb;
}

Json toJson(const Measured& measured) {
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  return {{"value", number(measured.value)}, {"uncertainty", number(measured.uncertainty)}};
}

Json toJson(const LayerPair& pair, const ImageError& error) {
  return {{"layer", shown(pair.first)},
          {"reference_layer", shown(pair.second)},
          {"rmse", toJson(error.rmse)},
          {"relative_mse", toJson(error.relativeMse)},
          {"mean_ratio", toJson(error.meanRatio)},
          {"mean_difference", toJson(error.bias)},
          {"percentile_95", error.percentile95},
          {"ssim", error.ssim},
          {"flip_hdr", error.flip},
          {"flip_ldr", error.flipLdr},
          {"exposure_ev", error.exposure},
          {"reference_noise", error.noiseFloor},
          {"non_finite_image", error.nonFiniteImage},
          {"non_finite_reference", error.nonFiniteReference}};
}

/// The exposure of all layers, and its source: that of the layer of all light, if the reference has it.
FoundExposure exposureOf(const CompareCommand& command, const LayeredImage& reference,
                         const std::vector<LayerPair>& pairs) {
  if (const auto given = command.display.given()) return {*given, "--exposure"};
  const std::string& first = pairs.front().second;
  return command::exposureOf(command.reference, reference,
                             first == kMainLayer && reference.layers.count(first) == 0 ? "" : first);
}

std::string text(const Measured& measured) {
  if (!std::isfinite(measured.value)) return "-";
  return measured.uncertainty > 0.0 ? fmt::format("{:.4g} ± {:.1g}", measured.value, measured.uncertainty)
                                    : fmt::format("{:.4g}", measured.value);
}

constexpr int kPanelsOfLayer = 3;
void addPanels(Sheet& sheet, const LayerPair& pair, const ImageBuffer& image, const ImageBuffer& reference,
               const ImageBuffer& flipMap, const Display& display) {
  sheet.panels.push_back({shown(pair.first), withoutAlpha(image), display});
  sheet.panels.push_back({"reference: " + shown(pair.second), withoutAlpha(reference), display});
  sheet.panels.push_back({"FLIP (HDR), 0 to 1", falseColour(flipMap), {}});
}

void refusePng(const std::filesystem::path& file) {
  if (file.extension() == ".png")
    throw Error(fmt::format(
        "{}: a PNG holds colours for a display, no linear radiance; expected an EXR file, as `lumivox render` and "
        "`lumivox reference` write with -o NAME.exr",
        file.string()));
}

int compareFiles(const CompareCommand& command) {
  for (const auto& file : {command.image, command.reference}) refusePng(file);
  Outputs().add("--sheet", command.sheet, {".png"}).check({command.image, command.reference});
  const LayeredImage image = readExr(command.image), reference = readExr(command.reference);
  const std::vector<LayerPair> pairs = pairsOf(command, image, reference);
  const FoundExposure display = exposureOf(command, reference, pairs);
  Sheet sheet{fmt::format("{} against {} ({}, {})", command.image.filename().string(),
                          command.reference.filename().string(), exposureText(display.exposure),
                          command.display.tone),
              {},
              kPanelsOfLayer};
  Json list = Json::array();
  std::vector<std::vector<std::string>> rows{{"Layer", "RMSE", "Relative MSE", "Mean ratio",
                                              "Mean difference", "95 %", "SSIM", "FLIP", "FLIP LDR",
                                              "Reference's noise", "NaN or Inf"}};
  bool good = true, asTheyAre = false;
  for (const LayerPair& pair : pairs) {
    const ImageBuffer& own = layerIn(image, command.image, pair.first);
    const ImageBuffer& other = layerIn(reference, command.reference, pair.second);
    const bool alpha = own.channels() + other.channels() == 7;  // RGBA with RGB
    const ImageBuffer left = alpha ? withoutAlpha(own) : own, right = alpha ? withoutAlpha(other) : other;
    if (!left.sameShape(right))
      throw Error(fmt::format(
          "layer '{}' of {} has {} x {} pixels of {} channels, layer '{}' of {} has {} x {} of {}",
          shown(pair.first), command.image.string(), left.width(), left.height(), left.channels(),
          shown(pair.second), command.reference.string(), right.width(), right.height(), right.channels()));
    const auto variance = reference.layers.find((pair.second == kMainLayer ? "" : pair.second) + kVariance);
    const bool known = variance != reference.layers.end() && variance->second.sameShape(right);
    // Values that are not radiance are displayed without exposure.
    const bool asItIs = !(left.isRadiance() && right.isRadiance()) && !command.display.isGiven();
    asTheyAre = asTheyAre || asItIs;
    const Display layerDisplay = asItIs ? Display{} : Display{display.exposure, command.display.toneCurve()};
    SeedsError compared = compareSeeds(std::span(&left, 1), right, known ? variance->second : ImageBuffer{},
                                       layerDisplay.exposure);
    const ImageError& error = compared.mean;
    if (!command.sheet.empty()) addPanels(sheet, pair, left, right, compared.flipMap, layerDisplay);
    // Pixels that are left out of all numbers would pass any limit.
    if (error.nonFiniteImage > 0)
      logWarning("{}: {} of {} pixels of layer '{}' are NaN or infinite; the numbers leave them out",
                 command.image.string(), error.nonFiniteImage, left.pixelCount(), shown(pair.first));
    if (command.rmseAtMost >= 0.0 && (error.nonFiniteImage > 0 || !(error.rmse.value <= command.rmseAtMost)))
      good = false;
    list.push_back(toJson(pair, error));
    rows.push_back(
        {pair.first == pair.second ? shown(pair.first) : shown(pair.first) + " = " + shown(pair.second),
         text(error.rmse), text(error.relativeMse), text(error.meanRatio), text(error.bias),
         threeDigits(error.percentile95), fmt::format("{:.4f}", error.ssim),
         fmt::format("{:.4f}", error.flip), fmt::format("{:.4f}", error.flipLdr),
         threeDigits(error.noiseFloor),
         fmt::format("{}", error.nonFiniteImage) +
             (error.nonFiniteReference > 0 ? fmt::format(", reference {}", error.nonFiniteReference) : "")});
  }
  if (!command.sheet.empty()) writePng(command.sheet, contactSheet(sheet));
  if (command.json)
    printJson({{"image", command.image.string()},
               {"reference", command.reference.string()},
               {"exposure_ev", display.exposure},
               {"exposure_from", display.from},
               {"layers", list}});
  else
    print(textTable(rows) + fmt::format("SSIM and FLIP LDR are taken at {} ({}){}\n",
                                        exposureText(display.exposure), display.from,
                                        asTheyAre ? "; layers that are no radiance as they are" : ""));
  return good ? kGood : kNotGood;
}

}  // namespace

void addCompareCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "compare", "measures the difference between two images; NaN and Inf are counted, not propagated");
  auto options = std::make_shared<CompareCommand>();
  command->add_option("IMAGE", options->image, "an EXR file")->required();
  command
      ->add_option("REFERENCE", options->reference,
                   "an EXR file; its layers NAME.variance give the uncertainties")
      ->required();
  addRepeatable(
      *command, "--layer", options->layers,
      "this layer of both, or A=B: A of the first with B of the second; 'main' is the layer without a name "
      "(default: all that both have)");
  command
      ->add_option("--rmse-at-most", options->rmseAtMost,
                   "exit code 1 when an RMSE is larger, or the image holds NaN or Inf")
      ->check(numberBetween(0.0, kLargestError));
  options->display.addTo(*command);
  command->add_option("--sheet", options->sheet,
                      "a .png with image, reference and FLIP map of every layer side by side");
  command->add_flag("--json", options->json, "print JSON");
  commands.onChosen(command, [=] { return compareFiles(*options); });
}

}  // namespace lumivox::command
