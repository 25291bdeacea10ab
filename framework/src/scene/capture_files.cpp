// Captures from files: which format it is, its frames within the range, their pixels.
#include "scene/capture_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "scene/limits.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

/// The format of a folder, by the files in it.
std::string formatOf(const fs::path& folder) {
  for (const char* name : {"associations.txt", "associate.txt", "associated.txt", "rgb.txt"})
    if (isThere(folder / name)) return "tum";
  std::error_code error;
  bool hasLog = false, hasDepthTexts = false;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    hasLog = hasLog || entry.path().extension() == ".log";
    hasDepthTexts = hasDepthTexts || entry.path().extension() == ".depth";
  }
  if (hasDepthTexts)
    throw Error(
        fmt::format("{}: texts (.depth) of distances along rays, as ICL-NUIM publishes them beside its TUM "
                    "form; expected that form, whose PNG files hold depths along z",
                    folder.string()));
  if (hasLog && isThere(folder / "depth")) return "redwood";
  if (isThere(folder / "pose") || !numberedFiles(folder, {".depth.png"}).empty()) return "frames";
  throw Error(fmt::format(
      "{}: holds no capture; expected rgb.txt, depth.txt and groundtruth.txt (tum), *.depth.png, *.color.* and "
      "*.pose.txt or folders color, depth and pose (frames), or folders color and depth with a .log (redwood)",
      folder.string()));
}

std::array<float, 256> tableOf(bool linear, double exposure) {
  std::array<float, 256> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float encoded = static_cast<float>(i) / 255.0f;
    table[i] = static_cast<float>(exposure) * (linear ? encoded : srgbToLinear(encoded));
  }
  return table;
}

/// Where a colour is no radiance that products of two hold in single precision, none is known.
float knownRadiance(float radiance) {
  return std::abs(radiance) <= kMostLight ? radiance : std::numeric_limits<float>::quiet_NaN();
}

/// Samples the colour image at the depth's pixels. Precondition: both show the same field of view.
void addColour(const ByteImage& colour, const std::array<float, 256>& linear, CapturedImage& image) {
  const auto channels = static_cast<std::size_t>(colour.channels);
  const auto texel = [&](int x, int y, std::size_t channel) {
    const std::size_t at =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(colour.width) + static_cast<std::size_t>(x);
    return linear[colour.values[at * channels + (channels < 3 ? 0 : channel)]];
  };
  image.colour.reserve(3 * image.depth.size());
  const bool sameSize = colour.width == image.width && colour.height == image.height;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (sameSize) {
        for (std::size_t c = 0; c < 3; ++c) image.colour.push_back(texel(x, y, c));
        continue;
      }
      const auto place = [](int index, int from, int to) {
        return std::clamp((index + 0.5) * to / from - 0.5, 0.0, to - 1.0);
      };
      const double px = place(x, image.width, colour.width), py = place(y, image.height, colour.height);
      const int x0 = static_cast<int>(px), y0 = static_cast<int>(py);
      const int x1 = std::min(x0 + 1, colour.width - 1), y1 = std::min(y0 + 1, colour.height - 1);
      const auto fx = static_cast<float>(px - x0), fy = static_cast<float>(py - y0);
      for (std::size_t c = 0; c < 3; ++c)
        image.colour.push_back(std::lerp(std::lerp(texel(x0, y0, c), texel(x1, y0, c), fx),
                                         std::lerp(texel(x0, y1, c), texel(x1, y1, c), fx), fy));
    }
  }
  image.saturation = linear.back();
}

/// Frames of pairs of 8-bit colours and 16-bit depths.
class ImagePairs : public CaptureSource {
 public:
  ImagePairs(std::vector<ListedFrame> frames, const std::array<float, 256>& linear, double depthScale)
      : frames_(std::move(frames)), linear_(linear), metres_(1.0 / depthScale) {}

  CapturedImage read(std::size_t frame) const override {
    const ListedFrame& files = frames_.at(frame);
    const WordImage depth = decodeGreyPng16(readFile(files.depth, kLargestImageFile), files.depth);
    const ByteImage colour = readByteImage(files.colour);
    CapturedImage image;
    requireFrameSize(depth.width, depth.height, files.depth.string());
    image.width = depth.width;
    image.height = depth.height;
    image.depth.reserve(depth.values.size());
    constexpr std::uint16_t kHole = 0, kNoReturn = 65535;
    for (const std::uint16_t units : depth.values)
      image.depth.push_back(units == kHole || units == kNoReturn ? 0.0f
                                                                 : static_cast<float>(metres_ * units));
    constexpr double kSameShape = 0.01;
    const double shape =
        static_cast<double>(colour.width) * depth.height / (static_cast<double>(colour.height) * depth.width);
    if (std::abs(shape - 1.0) > kSameShape)
      throw Error(
          fmt::format("{}: a colour image of {} x {} beside depths of {} x {}; expected the same shape",
                      files.colour.string(), colour.width, colour.height, depth.width, depth.height));
    addColour(colour, linear_, image);
    return image;
  }

 private:
  std::vector<ListedFrame> frames_;
  std::array<float, 256> linear_;
  double metres_;
};

/// Frames of EXR images with linear colour and Z.
class FloatImages : public CaptureSource {
 public:
  FloatImages(std::vector<ListedFrame> frames, double exposure)
      : frames_(std::move(frames)), exposure_(static_cast<float>(exposure)) {}

  CapturedImage read(std::size_t frame) const override {
    const fs::path& file = frames_.at(frame).colour;
    const LayeredImage layers = readExr(file);
    const auto colour = layers.layers.find(""), depth = layers.layers.find("Z");
    if (colour == layers.layers.end() || colour->second.channels() < 3 || depth == layers.layers.end())
      throw Error(fmt::format("{}: lacks {}; expected channels R, G, B of linear radiance and Z in metres",
                              file.string(), depth == layers.layers.end() ? "the channel Z" : "colours"));
    CapturedImage image;
    image.width = colour->second.width();
    image.height = colour->second.height();
    requireFrameSize(image.width, image.height, file.string());
    image.depth = depth->second.values();
    for (float& z : image.depth)
      if (!(z >= 0.0f && z <= kFarthestCaptured)) z = 0.0f;
    const auto channels = static_cast<std::size_t>(colour->second.channels());
    image.colour.reserve(3 * image.depth.size());
    for (std::size_t i = 0; i < image.depth.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c)
        image.colour.push_back(knownRadiance(exposure_ * colour->second.values()[i * channels + c]));
    image.saturation = std::numeric_limits<float>::infinity();
    return image;
  }

 private:
  std::vector<ListedFrame> frames_;
  float exposure_;
};

/// Frames of a .sens file.
class SensorRecords : public CaptureSource {
 public:
  SensorRecords(std::shared_ptr<const SensFile> file, std::vector<ListedFrame> frames,
                const std::array<float, 256>& linear)
      : file_(std::move(file)), frames_(std::move(frames)), linear_(linear) {}
  CapturedImage read(std::size_t frame) const override { return file_->decode(frames_.at(frame), linear_); }

 private:
  std::shared_ptr<const SensFile> file_;
  std::vector<ListedFrame> frames_;
  std::array<float, 256> linear_;
};

/// The bytes of frames: for the hash, and for the limit on their size.
struct FrameBytes {
  std::function<std::uint64_t(const ListedFrame&)> size;
  std::function<std::string(const ListedFrame&)> read;
};

FrameBytes bytesOfFiles() {
  const auto filesOf = [](const ListedFrame& frame) {
    return frame.colour == frame.depth ? std::vector{frame.depth} : std::vector{frame.colour, frame.depth};
  };
  return {[filesOf](const ListedFrame& frame) {
            std::uint64_t bytes = 0;
            std::error_code error;
            for (const fs::path& file : filesOf(frame)) {
              const std::uintmax_t size = fs::file_size(file, error);
              bytes += error ? 0 : size;
            }
            return bytes;
          },
          [filesOf](const ListedFrame& frame) {
            std::string bytes;
            for (const fs::path& file : filesOf(frame)) bytes += readFile(file, kLargestExrFile);
            return bytes;
          }};
}

/// Frames within the range; Error where there are none.
std::vector<ListedFrame> within(const CaptureListing& listing, const CaptureText& text,
                                const fs::path& place) {
  std::vector<ListedFrame> frames;
  for (const ListedFrame& frame : listing.frames)
    if (!text.range || (frame.number >= text.range->first && frame.number <= text.range->second))
      frames.push_back(frame);
  if (frames.empty() && !listing.frames.empty())
    throw Error(fmt::format("{}: no frame from {} to {}; expected a range within {} to {}", place.string(),
                            text.range->first, text.range->second, listing.frames.front().number,
                            listing.frames.back().number));
  return frames;
}

void requireFewBytes(const std::vector<ListedFrame>& frames, const FrameBytes& bytes, const fs::path& place) {
  constexpr std::uint64_t kMostBytes = std::uint64_t{512} << 20;
  std::uint64_t total = 0;
  std::size_t fitting = 0;
  for (const ListedFrame& frame : frames) {
    total += bytes.size(frame);
    fitting += total <= kMostBytes;
  }
  if (total > kMostBytes)
    throw Error(
        fmt::format("{}: {} frames of {}, all of which would be read; expected a range of at most {} frames",
                    place.string(), frames.size(), formatBytes(total), fitting));
}

/// Moves a pose of the capture's world to ours. A negative focal length along y belongs to a left-handed
/// world with y up: both its cameras and its world are mirrored along y.
CapturePose placed(CapturePose pose, const CaptureText& text, bool mirrored) {
  if (mirrored) {
    pose.rotation = glm::dquat(pose.rotation.w, -pose.rotation.x, pose.rotation.y, -pose.rotation.z);
    pose.eye.y = -pose.eye.y;
  }
  return {glm::normalize(text.rotation * pose.rotation), text.rotation * pose.eye + text.translation};
}

struct Reader {
  CaptureListing listing;
  FrameBytes bytes = bytesOfFiles();
  std::shared_ptr<const SensFile> sens;
};

Reader readerOf(const std::string& format, const fs::path& place) {
  Reader reader;
  if (format == "sens") {
    reader.sens = std::make_shared<const SensFile>(place);
    reader.listing = reader.sens->listing();
    reader.bytes = {[file = reader.sens](const ListedFrame& frame) { return file->recordBytes(frame); },
                    [file = reader.sens](const ListedFrame& frame) { return file->record(frame); }};
  } else {
    const auto list = format == "exr"      ? listExr
                      : format == "tum"    ? listTum
                      : format == "frames" ? listFrames
                                           : listRedwood;
    reader.listing = list(place);
  }
  return reader;
}

}  // namespace

void requireFrameSize(std::int64_t width, std::int64_t height, const std::string& name) {
  constexpr std::int64_t kMostAlongSide = 16384, kMostPixels = std::int64_t{1} << 25;
  if (width < 1 || height < 1 || width > kMostAlongSide || height > kMostAlongSide ||
      width * height > kMostPixels)
    throw Error(
        fmt::format("{}: a frame of {} x {} pixels; expected sides from 1 to {} and at most {} pixels", name,
                    width, height, kMostAlongSide, kMostPixels));
}

std::shared_ptr<Capture> loadCapture(const CaptureText& text, const fs::path& place, Hasher& hasher) {
  const std::string format = text.file     ? "sens"
                             : text.files  ? "exr"
                             : text.format ? *text.format
                                           : formatOf(place);
  const Reader reader = readerOf(format, place);
  if (reader.listing.frames.empty())
    throw Error(
        fmt::format("{}: no frame has both a colour and a depth image; expected one", place.string()));
  std::vector<ListedFrame> frames = within(reader.listing, text, place);
  const std::size_t wanted = frames.size();
  std::erase_if(frames, [](const ListedFrame& frame) { return !frame.pose; });
  std::vector<std::string> remarks = reader.listing.remarks;
  if (const std::size_t lost = wanted - frames.size(); lost > 0)
    remarks.push_back(fmt::format("{} of {} frames have no pose", lost, wanted));
  if (frames.empty())
    throw Error(fmt::format("{}: none of {} frames has a pose{}; expected one", place.string(), wanted,
                            format == "tum" ? " within 50 ms" : ""));
  for (const std::string& remark : remarks) logWarning("{}: {}: left out", place.string(), remark);
  if (!text.range) requireFewBytes(frames, reader.bytes, place);

  Hasher own;
  for (const fs::path& file : reader.listing.texts) own.add(readFile(file));
  for (const ListedFrame& frame : frames) own.add(reader.bytes.read(frame));

  CaptureCamera camera;
  bool mirrored = false;
  if (reader.sens) {
    camera = reader.sens->depthCamera();
  } else if (text.focal) {
    camera.focal = {text.focal->x, std::abs(text.focal->y)};
    camera.centre = *text.centre;
    mirrored = text.focal->y < 0.0;
  } else if (format == "redwood") {
    camera.focal = glm::dvec2(525.0);
    camera.centre = {319.5, 239.5};
  } else {
    throw Error(fmt::format(
        "{}: the camera's focal lengths are not known; expected focal FX FY and centre CX CY in the "
        "block 'capture {}'",
        place.string(), text.name));
  }
  camera.distortion = text.distortion;

  constexpr double kTumScale = 5000.0, kMillimetres = 1000.0;
  const double scale = text.depthScale.value_or(format == "tum" ? kTumScale : kMillimetres);
  const std::array<float, 256> linear = tableOf(text.linear, text.exposure);
  std::unique_ptr<const CaptureSource> source;
  if (reader.sens)
    source = std::make_unique<const SensorRecords>(reader.sens, frames, linear);
  else if (format == "exr")
    source = std::make_unique<const FloatImages>(frames, text.exposure);
  else
    source = std::make_unique<const ImagePairs>(frames, linear, scale);
  if (!reader.sens) {
    const CapturedImage first = source->read(0);
    camera.width = first.width;
    camera.height = first.height;
  }

  std::vector<CaptureFrame> posed;
  for (const ListedFrame& frame : frames) {
    const CapturePose pose = placed(*frame.pose, text, mirrored);
    const double time = reader.listing.hasTimes ? frame.time - frames.front().time
                                                : (frame.number - frames.front().number) / text.rate;
    posed.push_back({time, pose.rotation, pose.eye});
  }
  auto capture = std::make_shared<Capture>(text.name, camera, std::move(posed), std::move(source));
  own.add(text.exposure).add(text.linear).add(scale).add(text.distortion[0]).add(text.distortion[1]);
  own.add(text.distortion[2]).add(text.distortion[3]).add(text.distortion[4]);
  own.add(camera.focal.x).add(camera.focal.y).add(camera.centre.x).add(camera.centre.y).add(mirrored);
  for (const CaptureFrame& frame : capture->frames) {
    own.add(frame.time).add(frame.eye.x).add(frame.eye.y).add(frame.eye.z);
    own.add(frame.rotation.w).add(frame.rotation.x).add(frame.rotation.y).add(frame.rotation.z);
  }
  capture->hash = own.finish();
  hasher.add(capture->hash.high).add(capture->hash.low);
  return capture;
}

}  // namespace lumivox
