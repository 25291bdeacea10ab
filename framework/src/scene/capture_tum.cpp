// Captures in the layout of the TUM RGB-D benchmark, and poses of that form for EXR images.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

#include "lumivox/base/error.h"
#include "scene/capture_files.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

constexpr double kMostBetweenImages = 0.02;  // s, from a depth image to its colour image
constexpr double kMostToPose = 0.05;         // s, from a frame to the poses around it

struct TimedFile {
  double time = 0.0;
  std::string name;
};

struct TimedPose {
  double time = 0.0;
  CapturePose pose;
};

double timeOf(const fs::path& file, const TextLine& line, std::size_t word) {
  constexpr double kLatest = 1e12;  // s: a double tells times apart there by a tenth of a millisecond
  const double time = numberOf(file, line, word);
  if (!(std::abs(time) <= kLatest))
    refuseLine(file, line, fmt::format("a time of {:g} s", time),
               fmt::format("seconds, at most {:g}", kLatest));
  return time;
}

std::vector<TimedFile> timedFiles(const fs::path& file) {
  std::vector<TimedFile> result;
  for (const TextLine& line : linesOf(file)) {
    if (line.words.size() < 2) refuseLine(file, line, "one column", "a time and a file name");
    result.push_back({timeOf(file, line, 0), line.words[1]});
  }
  return result;
}

/// "depth/1305031102.160407.png" names a depth image by its folder.
bool namesDepth(const std::string& name) {
  return name.find("depth") != std::string::npos;
}

/// Four columns, either order of the pair; lines of which one name is missing are left out.
void addAssociated(const fs::path& file, const fs::path& folder, CaptureListing& listing) {
  int missing = 0;
  for (const TextLine& line : linesOf(file)) {
    if (line.words.size() < 4) {
      ++missing;
      continue;
    }
    const bool depthFirst = namesDepth(line.words[1]);
    if (depthFirst == namesDepth(line.words[3]))
      refuseLine(file, line, "the line names no depth image beside a colour image",
                 "a time, an image, a time and an image, one of them in a folder named depth");
    ListedFrame frame;
    frame.time = timeOf(file, line, depthFirst ? 0 : 2);
    frame.depth = folder / line.words[depthFirst ? 1 : 3];
    frame.colour = folder / line.words[depthFirst ? 3 : 1];
    listing.frames.push_back(std::move(frame));
  }
  if (missing > 0)
    listing.remarks.push_back(
        fmt::format("{} lines of {} do not name a pair", missing, file.filename().string()));
}

/// Joins each depth image with the colour image nearest in time, nearest pairs first, each image once. The
/// nearest two of the images left are always neighbours in the order of times.
void addNearest(const fs::path& folder, CaptureListing& listing) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  struct Image {
    TimedFile file;
    bool isDepth, isTaken = false;
    std::size_t before = kNone, after = kNone;  ///< neighbours among the images left
  };
  std::vector<Image> images;
  for (const bool isDepth : {true, false})
    for (TimedFile& file : timedFiles(folder / (isDepth ? "depth.txt" : "rgb.txt")))
      images.push_back({std::move(file), isDepth});
  const auto depthCount = static_cast<std::size_t>(
      std::count_if(images.begin(), images.end(), [](const Image& one) { return one.isDepth; }));
  std::stable_sort(images.begin(), images.end(),
                   [](const Image& a, const Image& b) { return a.file.time < b.file.time; });
  using Pair =
      std::tuple<double, std::size_t, std::size_t>;  // seconds apart, the earlier and the later image
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> pairs;
  const auto join = [&](std::size_t earlier, std::size_t later) {
    if (earlier != kNone) images[earlier].after = later;
    if (later != kNone) images[later].before = earlier;
    if (earlier == kNone || later == kNone) return;
    const double apart = images[later].file.time - images[earlier].file.time;
    if (images[earlier].isDepth != images[later].isDepth && apart <= kMostBetweenImages)
      pairs.emplace(apart, earlier, later);
  };
  for (std::size_t i = 1; i < images.size(); ++i) join(i - 1, i);
  while (!pairs.empty()) {
    const auto [apart, earlier, later] = pairs.top();
    pairs.pop();
    if (images[earlier].isTaken || images[later].isTaken) continue;
    images[earlier].isTaken = images[later].isTaken = true;
    join(images[earlier].before, images[later].after);
    const Image &depth = images[images[earlier].isDepth ? earlier : later],
                &colour = images[images[earlier].isDepth ? later : earlier];
    ListedFrame frame;
    frame.time = depth.file.time;
    frame.depth = folder / depth.file.name;
    frame.colour = folder / colour.file.name;
    listing.frames.push_back(std::move(frame));
  }
  if (const std::size_t left = depthCount - listing.frames.size(); left > 0)
    listing.remarks.push_back(
        fmt::format("{} depth images have no colour image within {:g} ms", left, 1e3 * kMostBetweenImages));
}

/// In the order of times, each time once.
void sortByTime(CaptureListing& listing) {
  auto& frames = listing.frames;
  const auto earlier = [](const ListedFrame& a, const ListedFrame& b) { return a.time < b.time; };
  if (!std::is_sorted(frames.begin(), frames.end(), earlier)) {
    std::stable_sort(frames.begin(), frames.end(), earlier);
  }
  const std::size_t before = frames.size();
  frames.erase(std::unique(frames.begin(), frames.end(),
                           [](const ListedFrame& a, const ListedFrame& b) { return a.time == b.time; }),
               frames.end());
  if (before > frames.size())
    listing.remarks.push_back(fmt::format("{} frames have the time of another one", before - frames.size()));
  int number = 0;
  for (ListedFrame& frame : frames) frame.number = number++;
}

/// Poses that are not finite are no poses; the rest in the order of their times.
std::vector<TimedPose> timedPoses(const fs::path& file) {
  std::vector<TimedPose> poses;
  for (const TextLine& line : linesOf(file)) {
    if (line.words.size() < 8)
      refuseLine(file, line, fmt::format("{} columns", line.words.size()), "time tx ty tz qx qy qz qw");
    const auto number = [&](std::size_t word) { return numberOf(file, line, word); };
    const glm::dvec3 eye(number(1), number(2), number(3));
    const glm::dquat rotation(number(7), number(4), number(5), number(6));
    if (const auto pose = poseOf(rotation, eye)) poses.push_back({timeOf(file, line, 0), *pose});
  }
  std::stable_sort(poses.begin(), poses.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.time < b.time; });
  return poses;
}

}  // namespace

void givePoses(const fs::path& groundtruth, std::vector<ListedFrame>& frames) {
  const std::vector<TimedPose> poses = timedPoses(groundtruth);
  for (ListedFrame& frame : frames) {
    const auto after = std::lower_bound(poses.begin(), poses.end(), frame.time,
                                        [](const TimedPose& pose, double time) { return pose.time < time; });
    if (after != poses.end() && after->time == frame.time) {
      frame.pose = after->pose;
      continue;
    }
    if (after == poses.begin() || after == poses.end()) continue;
    const TimedPose& before = *(after - 1);
    if (frame.time - before.time > kMostToPose || after->time - frame.time > kMostToPose) continue;
    const double weight = (frame.time - before.time) / (after->time - before.time);
    frame.pose = poseOf(glm::slerp(before.pose.rotation, after->pose.rotation, weight),
                        glm::mix(before.pose.eye, after->pose.eye, weight));
  }
}

CaptureListing listTum(const fs::path& folder) {
  CaptureListing listing;
  listing.hasTimes = true;
  const fs::path poses = folder / "groundtruth.txt";
  for (const char* name : {"associations.txt", "associate.txt", "associated.txt"}) {
    if (!isThere(folder / name)) continue;
    listing.texts = {folder / name, poses};
    addAssociated(folder / name, folder, listing);
    break;
  }
  if (listing.texts.empty()) {
    listing.texts = {folder / "rgb.txt", folder / "depth.txt", poses};
    addNearest(folder, listing);
  }
  sortByTime(listing);
  givePoses(poses, listing.frames);
  return listing;
}

CaptureListing listExr(const fs::path& pattern) {
  // room_####.exr: the files that begin and end like it, with as many digits or more between.
  const std::string name = pattern.filename().string();
  const std::size_t first = name.find('#'), last = name.find_last_of('#');
  const std::string begin = name.substr(0, first), end = name.substr(last + 1);
  const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
  CaptureListing listing;
  listing.texts = {folder / "groundtruth.txt"};
  for (const auto& [number, path] : numberedFiles(folder, {end}, begin)) {
    if (path.filename().string().size() < name.size()) continue;
    ListedFrame frame;
    frame.number = number;
    frame.colour = frame.depth = path;
    listing.frames.push_back(std::move(frame));
  }
  const fs::path& file = listing.texts.front();
  const std::vector<TextLine> lines = linesOf(file);
  if (lines.size() != listing.frames.size())
    throw Error(fmt::format("{}: {} poses for {} images; expected a line for each image, in their order",
                            file.string(), lines.size(), listing.frames.size()));
  listing.hasTimes = true;
  for (std::size_t i = 0; i < lines.size(); ++i) listing.frames[i].time = timeOf(file, lines[i], 0);
  givePoses(file, listing.frames);
  return listing;
}

}  // namespace lumivox
