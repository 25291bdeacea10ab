#include "lumivox/base/video.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <optional>
#include <span>
#include <string>

#include "base/child.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestVideo = std::uint64_t{16} << 30;

/// A temporary folder, removed with its owner.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "lumivox-video-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw Error(fmt::format("{}: no folder can be made there for a video while it is encoded",
                              fs::temp_directory_path().string()));
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

fs::path ffmpegProgram() {
  return programOnPath("ffmpeg", "which encodes videos", "ffmpeg", "write numbered images");
}

struct VideoWriter::State {
  fs::path file, program;
  double framesPerSecond;
  TemporaryFolder folder;
  int width = 0, height = 0;
  std::optional<Child> encoder;

  fs::path encoded() const { return folder.path() / "video.mp4"; }

  void start() {
    // The prefix file: keeps ffmpeg from reading a protocol out of a name with a colon.
    encoder.emplace(
        std::vector<std::string>{program.string(),
                                 "-hide_banner",
                                 "-loglevel",
                                 "error",
                                 "-nostats",
                                 "-y",
                                 "-f",
                                 "rawvideo",
                                 "-pixel_format",
                                 "rgb24",
                                 "-video_size",
                                 fmt::format("{}x{}", width, height),
                                 "-framerate",
                                 fmt::format("{}", framesPerSecond),
                                 "-i",
                                 "pipe:0",
                                 "-an",
                                 "-vf",
                                 "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
                                 "-pix_fmt",
                                 "yuv420p",
                                 "-colorspace",
                                 "bt709",
                                 "-color_primaries",
                                 "bt709",
                                 "-color_trc",
                                 "iec61966-2-1",
                                 "-movflags",
                                 "+faststart",
                                 "-f",
                                 "mp4",
                                 "file:" + encoded().string()},
        std::vector<std::string>{});
  }

  /// Call it after the last frame, or when the encoder no longer reads.
  void requireSuccess() {
    while (encoder->receive(3600.0).state != Child::State::ended) {
    }
    if (encoder->succeeded()) return;
    const std::string words = encoder->lastWords();
    throw Error(fmt::format("{}: ffmpeg {}{}", file.string(), encoder->ending(),
                            words.empty() ? ", without a word" : ": " + words));
  }
};

VideoWriter::VideoWriter(fs::path file, double framesPerSecond)
    : state_(new State{std::move(file), ffmpegProgram(), framesPerSecond, {}, 0, 0, {}}) {}
VideoWriter::~VideoWriter() = default;

void VideoWriter::add(const ImageBuffer& linear, const Display& display) {
  State& s = *state_;
  const std::vector<unsigned char> bytes = displayBytes(linear, display);
  if (!s.encoder) {
    s.width = linear.width();
    s.height = linear.height();
    s.start();
  }
  if (linear.width() != s.width || linear.height() != s.height)
    throw Error(fmt::format("{}: a frame has {} x {} pixels; expected {} x {} like the first one",
                            s.file.string(), linear.width(), linear.height(), s.width, s.height));
  if (s.encoder->write(std::as_bytes(std::span(bytes)))) return;
  s.requireSuccess();
  throw Error(fmt::format("{}: ffmpeg ended before the last frame", s.file.string()));
}

void VideoWriter::finish() {
  State& s = *state_;
  if (!s.encoder) throw Error(fmt::format("{}: a video needs at least one frame", s.file.string()));
  s.encoder->closeInput();
  s.requireSuccess();
  if (!fs::exists(s.encoded())) throw Error(fmt::format("{}: ffmpeg wrote no video", s.file.string()));
  writeFileAtomically(s.file, readFile(s.encoded(), kLargestVideo));
}

}  // namespace lumivox
