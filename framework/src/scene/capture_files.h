// The files of captures: one lister for each format, and what they share.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/scene/capture.h"
#include "scene/description.h"

namespace lumivox {

inline constexpr double kFarthestCaptured = 1e9;  ///< m, as kFarthestPlace of texts

struct CapturePose {
  glm::dquat rotation{1, 0, 0, 0};  ///< camera to the capture's world, unit length
  glm::dvec3 eye{0};                ///< m
};

/// A pose from numbers of a file. None if they are not finite or no rotation: trackers mark lost frames so.
/// Both forms of one pose give the same bits.
std::optional<CapturePose> poseOf(const glm::dquat& rotation, const glm::dvec3& eye);
std::optional<CapturePose> poseOf(const glm::dmat4& cameraToWorld);

/// A frame as its format lists it, before its images are opened.
struct ListedFrame {
  int number = 0;     ///< as `range` and messages count
  double time = 0.0;  ///< s, by the capture's own clock
  std::optional<CapturePose> pose;
  std::filesystem::path colour, depth;  ///< the same for images that hold both; empty for .sens files
  std::uint64_t offset = 0;             ///< of its record in a .sens file, bytes
};

struct CaptureListing {
  std::vector<ListedFrame> frames;           ///< in the order of their numbers
  bool hasTimes = false;                     ///< ListedFrame::time is set
  std::vector<std::filesystem::path> texts;  ///< files that poses and names come from
  std::vector<std::string> remarks;          ///< what was left out before poses were read
};

CaptureListing listTum(const std::filesystem::path& folder);
CaptureListing listFrames(const std::filesystem::path& folder);
CaptureListing listRedwood(const std::filesystem::path& folder);
/// `pattern` has #### in the place of the frame's number.
CaptureListing listExr(const std::filesystem::path& pattern);

/// Gives each frame its pose from groundtruth.txt (time tx ty tz qx qy qz qw): the pose at its time, or the
/// slerp of the poses around it if both are within 50 ms.
void givePoses(const std::filesystem::path& groundtruth, std::vector<ListedFrame>& frames);

/// A .sens file (ScanNet, version 4): its frames, and what its header says of its cameras.
class SensFile {
 public:
  explicit SensFile(std::filesystem::path path);
  const CaptureListing& listing() const { return listing_; }
  const CaptureCamera& depthCamera() const { return depth_; }
  /// Bytes of a frame's record.
  std::uint64_t recordBytes(const ListedFrame& frame) const;
  std::string record(const ListedFrame& frame) const;
  /// Depth with the colour where each of its points projects: NaN where another point is nearer, or outside.
  /// `linear`: of bytes 0 to 255.
  CapturedImage decode(const ListedFrame& frame, const std::array<float, 256>& linear) const;

 private:
  struct RecordHead;
  RecordHead headOf(const ListedFrame& frame) const;
  std::filesystem::path path_;
  std::uint64_t fileBytes_ = 0;
  CaptureCamera depth_, colour_;
  glm::dmat4 depthToColour_{1.0};
  int colourKind_ = 0, depthKind_ = 0;
  double metres_ = 1e-3;  ///< of a unit of depth
  CaptureListing listing_;
};

/// Error if a frame has no pixels or too many. `name` says which frame of which file.
void requireFrameSize(std::int64_t width, std::int64_t height, const std::string& name);

/// Whether a file or a folder is there.
bool isThere(const std::filesystem::path& path);

/// The lines of a text without comments (#), carriage returns and empty ones, with their numbers.
struct TextLine {
  int number = 0;
  std::vector<std::string> words;
};
std::vector<TextLine> linesOf(const std::filesystem::path& file);
/// Error with file and line where a word is no number; NaN and infinities are numbers.
double numberOf(const std::filesystem::path& file, const TextLine& line, std::size_t word);
[[noreturn]] void refuseLine(const std::filesystem::path& file, const TextLine& line, std::string_view what,
                             std::string_view expected);
/// A 4 x 4 matrix of 16 numbers in rows, from `first` on.
glm::dmat4 matrixOf(const std::filesystem::path& file, const std::vector<TextLine>& lines, std::size_t first);

/// The files of a folder with this beginning and one of these endings, sorted by the last number between.
/// Error if two have the same number.
std::vector<std::pair<int, std::filesystem::path>> numberedFiles(const std::filesystem::path& folder,
                                                                 const std::vector<std::string>& endings,
                                                                 const std::string& begin = {});

/// Reads a capture from where `place` says: a folder, a .sens file or a pattern of EXR images. Error names
/// file and line or frame. `hasher` takes the texts and the frames of the range.
std::shared_ptr<Capture> loadCapture(const CaptureText& text, const std::filesystem::path& place,
                                     Hasher& hasher);

}  // namespace lumivox
