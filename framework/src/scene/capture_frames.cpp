// Captures as numbered files: 7-Scenes, BundleFusion and exported ScanNet; and Redwood's.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "lumivox/base/error.h"
#include "scene/capture_files.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kColourEndings{".png", ".jpg", ".jpeg"};

bool isFolder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

using Numbered = std::vector<std::pair<int, fs::path>>;

/// Frames that have colour and depth, by number.
void join(const Numbered& colours, const Numbered& depths, CaptureListing& listing) {
  std::map<int, fs::path> colourOf(colours.begin(), colours.end());
  for (const auto& [number, depth] : depths) {
    const auto colour = colourOf.find(number);
    if (colour == colourOf.end()) continue;
    ListedFrame frame;
    frame.number = number;
    frame.colour = colour->second;
    frame.depth = depth;
    listing.frames.push_back(std::move(frame));
  }
  const std::size_t alone = depths.size() + colours.size() - 2 * listing.frames.size();
  if (alone > 0)
    listing.remarks.push_back(fmt::format("{} images have no other image of their frame", alone));
}

/// frame-000000.color.png, .depth.png and .pose.txt in one folder; or folders color, depth and pose.
struct FrameFiles {
  Numbered colours, depths, poses;
};

FrameFiles filesOf(const fs::path& folder) {
  if (isFolder(folder / "depth"))
    return {numberedFiles(folder / (isFolder(folder / "color") ? "color" : "rgb"), kColourEndings),
            numberedFiles(folder / "depth", {".png"}), numberedFiles(folder / "pose", {".txt"})};
  return {numberedFiles(folder, {".color.png", ".color.jpg", ".color.jpeg"}),
          numberedFiles(folder, {".depth.png"}), numberedFiles(folder, {".pose.txt"})};
}

}  // namespace

CaptureListing listFrames(const fs::path& folder) {
  const FrameFiles files = filesOf(folder);
  CaptureListing listing;
  join(files.colours, files.depths, listing);
  std::map<int, fs::path> poseOfFrame(files.poses.begin(), files.poses.end());
  for (ListedFrame& frame : listing.frames) {
    const auto file = poseOfFrame.find(frame.number);
    if (file == poseOfFrame.end()) continue;
    listing.texts.push_back(file->second);
    frame.pose = poseOf(matrixOf(file->second, linesOf(file->second), 0));
  }
  return listing;
}

CaptureListing listRedwood(const fs::path& folder) {
  CaptureListing listing;
  join(numberedFiles(folder / (isFolder(folder / "color") ? "color" : "rgb"), kColourEndings),
       numberedFiles(folder / "depth", {".png"}), listing);
  const auto numbersFromZero = [&] {  // the log counts images from 1, whatever their file names say
    int number = 0;
    for (ListedFrame& frame : listing.frames) frame.number = number++;
  };
  numbersFromZero();
  std::vector<fs::path> logs;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".log") logs.push_back(entry.path());
  if (logs.size() != 1)
    throw Error(
        fmt::format("{}: {} files end in .log; expected one trajectory", folder.string(), logs.size()));
  listing.texts = logs;
  const std::vector<TextLine> lines = linesOf(logs.front());
  constexpr std::size_t kItem = 5;  // a line of three numbers, and a matrix
  for (std::size_t i = 0; i < lines.size(); i += kItem) {
    if (lines[i].words.size() != 3)
      refuseLine(logs.front(), lines[i], fmt::format("{} numbers", lines[i].words.size()),
                 "three before each matrix, the third of them the frame from 1");
    const double number = numberOf(logs.front(), lines[i], 2);
    const glm::dmat4 matrix = matrixOf(logs.front(), lines, i + 1);
    const double frame = number - 1.0;
    if (frame >= 0.0 && frame < static_cast<double>(listing.frames.size()))
      listing.frames[static_cast<std::size_t>(frame)].pose = poseOf(matrix);
  }
  return listing;
}

}  // namespace lumivox
