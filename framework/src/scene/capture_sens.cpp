// ScanNet's .sens files, version 4. All numbers are little-endian, matrices are rows of floats.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "lumivox/base/deflate.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "scene/capture_files.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

enum class ColourKind { raw = 0, png = 1, jpeg = 2 };
enum class DepthKind { raw = 0, zlib = 1, occi = 2 };

constexpr std::uint32_t kVersion = 4;
constexpr std::uint64_t kMatrixBytes = 16 * sizeof(float);
constexpr std::uint64_t kRecordHeadBytes = kMatrixBytes + 4 * sizeof(std::uint64_t);

/// Reads numbers from bytes in order.
class Cursor {
 public:
  Cursor(std::string_view bytes, const fs::path& file) : bytes_(bytes), file_(file) {}
  template <class T>
  T take() {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, text(sizeof(T)).data(), sizeof(T));
    return value;
  }
  std::string_view text(std::uint64_t size) {
    if (size > bytes_.size() - at_)
      throw Error(fmt::format("{}: ends within its header, at byte {}; expected a .sens file of version {}",
                              file_.string(), bytes_.size(), kVersion));
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }
  glm::dmat4 matrix() {
    glm::dmat4 result;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) result[column][row] = static_cast<double>(take<float>());
    return result;
  }
  std::uint64_t at() const { return at_; }

 private:
  std::string_view bytes_;
  const fs::path& file_;
  std::uint64_t at_ = 0;
};

CaptureCamera cameraOf(const glm::dmat4& intrinsic) {
  CaptureCamera camera;
  camera.focal = {intrinsic[0][0], intrinsic[1][1]};
  camera.centre = {intrinsic[2][0], intrinsic[2][1]};
  return camera;
}

void takeSize(Cursor& cursor, CaptureCamera& camera, const char* what, const fs::path& file) {
  const auto width = cursor.take<std::uint32_t>(), height = cursor.take<std::uint32_t>();
  requireFrameSize(width, height, fmt::format("{}, {} images", file.string(), what));
  constexpr double kShortest = 1e-3, kFarthest = 1e6;  // pixels, as `focal` and `centre` of texts
  const auto isLength = [](double focal) { return focal >= kShortest && focal <= kFarthest; };
  if (!isLength(camera.focal.x) || !isLength(camera.focal.y) || !(std::abs(camera.centre.x) <= kFarthest) ||
      !(std::abs(camera.centre.y) <= kFarthest))
    throw Error(fmt::format(
        "{}: {} images with focal lengths of {:g} and {:g} and the centre {:g} {:g}; expected lengths from "
        "{:g} to {:g} pixels, and a centre within them",
        file.string(), what, camera.focal.x, camera.focal.y, camera.centre.x, camera.centre.y, kShortest,
        kFarthest));
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
}

std::string frameName(const fs::path& file, const ListedFrame& frame) {
  return fmt::format("{}, frame {}", file.string(), frame.number);
}

std::vector<std::uint16_t> depthsOf(std::string_view bytes, DepthKind kind, std::size_t pixels,
                                    const std::string& name) {
  const std::size_t size = pixels * sizeof(std::uint16_t);
  std::string unpacked;
  if (kind == DepthKind::zlib) {
    try {
      unpacked = Deflated{bytes, size, nullptr}.expanded();
    } catch (const Error& error) {
      throw Error(fmt::format("{}: its depths: {}", name, error.what()));
    }
    bytes = unpacked;
  }
  if (bytes.size() != size)
    throw Error(fmt::format("{}: {} bytes of depths; expected {}", name, bytes.size(), size));
  std::vector<std::uint16_t> depths(pixels);
  std::memcpy(depths.data(), bytes.data(), size);
  return depths;
}

}  // namespace

struct SensFile::RecordHead {
  glm::dmat4 pose{1.0};
  std::uint64_t colourBytes = 0, depthBytes = 0;
};

SensFile::SensFile(fs::path path) : path_(std::move(path)) {
  constexpr std::uint64_t kLongestName = 1 << 16;
  requireRegularFile(path_);
  fileBytes_ = fs::file_size(path_);
  const std::string start = readFileStart(path_, kLongestName + 1024);
  Cursor cursor(start, path_);
  if (const auto version = cursor.take<std::uint32_t>(); version != kVersion)
    throw Error(fmt::format("{}: is of version {}; expected a .sens file of version {}", path_.string(),
                            version, kVersion));
  const auto nameBytes = cursor.take<std::uint64_t>();
  if (nameBytes > kLongestName)
    throw Error(fmt::format("{}: claims a name of {} bytes; expected at most {}", path_.string(), nameBytes,
                            kLongestName));
  cursor.text(nameBytes);
  colour_ = cameraOf(cursor.matrix());
  const glm::dmat4 colourPose = cursor.matrix();
  depth_ = cameraOf(cursor.matrix());
  const glm::dmat4 depthPose = cursor.matrix();
  const auto identityIfEmpty = [](const glm::dmat4& matrix) {
    return glm::determinant(matrix) == 0.0 ? glm::dmat4(1.0) : matrix;
  };
  depthToColour_ = glm::inverse(identityIfEmpty(colourPose)) * identityIfEmpty(depthPose);
  colourKind_ = cursor.take<std::int32_t>();
  depthKind_ = cursor.take<std::int32_t>();
  if (colourKind_ != static_cast<int>(ColourKind::png) && colourKind_ != static_cast<int>(ColourKind::jpeg))
    throw Error(fmt::format("{}: colours are compressed as kind {}{}; expected PNG (1) or JPEG (2)",
                            path_.string(), colourKind_, colourKind_ == 0 ? " (raw)" : ""));
  if (depthKind_ != static_cast<int>(DepthKind::raw) && depthKind_ != static_cast<int>(DepthKind::zlib))
    throw Error(fmt::format("{}: depths are compressed as kind {}{}; expected raw (0) or zlib (1)",
                            path_.string(), depthKind_, depthKind_ == 2 ? " (OCCI)" : ""));
  takeSize(cursor, colour_, "colour", path_);
  takeSize(cursor, depth_, "depth", path_);
  const auto shift = static_cast<double>(cursor.take<float>());
  constexpr double kFewest = 1e-3, kMost = 1e9;  // as `depth_scale` of texts
  if (!(shift >= kFewest && shift <= kMost))
    throw Error(fmt::format("{}: a depth shift of {:g}; expected the units in a metre, from {:g} to {:g}",
                            path_.string(), shift, kFewest, kMost));
  metres_ = 1.0 / shift;
  const auto count = cursor.take<std::uint64_t>();
  if (count > (fileBytes_ - std::min(fileBytes_, cursor.at())) / kRecordHeadBytes)
    throw Error(fmt::format("{}: claims {} frames; {} bytes hold fewer", path_.string(), count, fileBytes_));
  std::uint64_t at = cursor.at();
  for (std::uint64_t i = 0; i < count; ++i) {
    ListedFrame frame;
    frame.number = static_cast<int>(i);
    frame.offset = at;
    if (fileBytes_ - at < kRecordHeadBytes) {
      listing_.remarks.push_back(fmt::format("the file ends before its frame {} of {}", i, count));
      break;
    }
    const RecordHead head = headOf(frame);
    const std::uint64_t room = fileBytes_ - at - kRecordHeadBytes;
    if (head.colourBytes > room || head.depthBytes > room - head.colourBytes) {
      listing_.remarks.push_back(fmt::format("the file ends within its frame {} of {}", i, count));
      break;
    }
    frame.pose = poseOf(head.pose);
    at += kRecordHeadBytes + head.colourBytes + head.depthBytes;
    listing_.frames.push_back(std::move(frame));
  }
}

SensFile::RecordHead SensFile::headOf(const ListedFrame& frame) const {
  const std::string bytes = readFilePart(path_, frame.offset, kRecordHeadBytes);
  Cursor cursor(bytes, path_);
  RecordHead head;
  head.pose = cursor.matrix();
  cursor.take<std::uint64_t>();  // times without a unit
  cursor.take<std::uint64_t>();
  head.colourBytes = cursor.take<std::uint64_t>();
  head.depthBytes = cursor.take<std::uint64_t>();
  return head;
}

std::uint64_t SensFile::recordBytes(const ListedFrame& frame) const {
  const RecordHead head = headOf(frame);
  return kRecordHeadBytes + head.colourBytes + head.depthBytes;
}

std::string SensFile::record(const ListedFrame& frame) const {
  return readFilePart(path_, frame.offset, recordBytes(frame));
}

CapturedImage SensFile::decode(const ListedFrame& frame, const std::array<float, 256>& linear) const {
  const std::string name = frameName(path_, frame), bytes = record(frame);
  const RecordHead head = headOf(frame);
  const std::string colourBytes = bytes.substr(kRecordHeadBytes, head.colourBytes);
  const std::string_view depthBytes = std::string_view(bytes).substr(kRecordHeadBytes + head.colourBytes);
  const ByteImage colour = decodeByteImage(colourBytes, name);
  if (colour.width != colour_.width || colour.height != colour_.height)
    throw Error(fmt::format("{}: the colour image is {} x {}; expected {} x {} as the header says", name,
                            colour.width, colour.height, colour_.width, colour_.height));
  CapturedImage image;
  image.width = depth_.width;
  image.height = depth_.height;
  const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const std::vector<std::uint16_t> units =
      depthsOf(depthBytes, static_cast<DepthKind>(depthKind_), pixels, name);
  image.depth.resize(pixels, 0.0f);
  image.colour.assign(3 * pixels, std::numeric_limits<float>::quiet_NaN());
  // Where each point falls in the colour image, and the nearest point of each of its pixels.
  const auto colourPixels = static_cast<std::size_t>(colour.width) * static_cast<std::size_t>(colour.height);
  std::vector<float> nearest(colourPixels, std::numeric_limits<float>::infinity());
  std::vector<std::pair<std::int64_t, float>> places(pixels, {-1, 0.0f});
  for (std::size_t i = 0; i < pixels; ++i) {
    if (units[i] == 0 || units[i] == 65535) continue;
    const double z = metres_ * units[i];
    image.depth[i] = static_cast<float>(z);
    const auto column = static_cast<double>(i % static_cast<std::size_t>(image.width)),
               row = static_cast<double>(i / static_cast<std::size_t>(image.width));
    const glm::dvec2 ray = depth_.ray({column, row});
    const glm::dvec3 point(depthToColour_ * glm::dvec4(ray * z, z, 1.0));
    if (!(point.z > 0.0)) continue;
    const glm::dvec2 pixel = colour_.project(glm::dvec2(point) / point.z) + 0.5;
    if (!(pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < colour.width && pixel.y < colour.height)) continue;
    const std::int64_t place =
        static_cast<std::int64_t>(pixel.y) * colour.width + static_cast<std::int64_t>(pixel.x);
    places[i] = {place, static_cast<float>(point.z)};
    float& first = nearest[static_cast<std::size_t>(place)];
    first = std::min(first, static_cast<float>(point.z));
  }
  constexpr float kBehind = 0.05f;  // of the distance: surfaces, not noise
  const auto channels = static_cast<std::size_t>(colour.channels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto [place, z] = places[i];
    if (place < 0 || z > nearest[static_cast<std::size_t>(place)] * (1.0f + kBehind)) continue;
    const unsigned char* source = colour.values.data() + static_cast<std::size_t>(place) * channels;
    for (std::size_t c = 0; c < 3; ++c) image.colour[3 * i + c] = linear[source[channels < 3 ? 0 : c]];
  }
  image.saturation = linear.back();
  return image;
}

}  // namespace lumivox
