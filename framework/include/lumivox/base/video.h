// Frames become a video by ffmpeg, a program that may be absent.
#pragma once

#include <filesystem>
#include <memory>

#include "lumivox/base/image.h"

namespace lumivox {

/// Where ffmpeg is, by $PATH. AbsentError, which says how to go without it, when it is nowhere.
std::filesystem::path ffmpegProgram();

/// An MP4 video (H.264 where ffmpeg has an encoder for it, 4:2:0, Rec. 709), written atomically when it is
/// finished.
class VideoWriter {
 public:
  /// AbsentError without ffmpeg. The name of the file may hold anything that a file's name may.
  VideoWriter(std::filesystem::path file, double framesPerSecond);
  ~VideoWriter();  ///< without finish(): the file stays as it was
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  /// The next frame; all have the size of the first one, which a column or a row of black is added to where
  /// it is odd. Error with ffmpeg's own message when it fails, or when the size differs.
  void add(const ImageBuffer& linear, const Display& display);
  /// Error as for add(), and without any frame.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox
