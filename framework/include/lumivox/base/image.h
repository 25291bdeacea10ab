// Images in main memory: linear radiance in 32-bit floats, row 0 at the top, and the files that hold them.
#pragma once

#include <cassert>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "lumivox/base/display.h"

namespace lumivox {

/// A float image. Pixels are stored row by row from the top, the channels of a pixel side by side.
class ImageBuffer {
 public:
  ImageBuffer() = default;
  ImageBuffer(int width, int height, int channels,
              float value = 0.0f);  // Error (before allocation) when it does not fit in memory

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  bool empty() const { return values_.empty(); }
  std::size_t pixelCount() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }

  float& at(int x, int y, int channel) { return values_[index(x, y, channel)]; }
  float at(int x, int y, int channel) const { return values_[index(x, y, channel)]; }
  std::vector<float>& values() { return values_; }
  const std::vector<float>& values() const { return values_; }

  /// Whether the values are radiance, which is exposed for display. By default images of one channel
  /// (occlusion and other fractions) are not, and all others are.
  bool isRadiance() const { return radiance_; }
  void setRadiance(bool radiance) { radiance_ = radiance; }

  bool sameShape(const ImageBuffer& other) const {
    return width_ == other.width_ && height_ == other.height_ && channels_ == other.channels_;
  }

 private:
  std::size_t index(int x, int y, int channel) const {
    assert(x >= 0 && x < width_ && y >= 0 && y < height_ && channel >= 0 && channel < channels_);
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) *
               static_cast<std::size_t>(channels_) +
           static_cast<std::size_t>(channel);
  }
  int width_ = 0, height_ = 0, channels_ = 0;
  bool radiance_ = true;
  std::vector<float> values_;
};

/// Several images of one size under names, and text attributes: what one EXR file holds. The layer "" is
/// the file's main layer (channels R, G, B without prefix); three channels are named R G B, four R G B A, one
/// Y (a layer "Z" is the channel Z, as depths are named), two X Y. Layers that are no radiance although they
/// have several channels are named in an attribute.
struct LayeredImage {
  std::map<std::string, ImageBuffer> layers;
  std::map<std::string, std::string> attributes;
};

/// Reads a scanline or tiled EXR (half, float or uint channels, data window as the image). Error names the
/// file on anything malformed, and if it has more pixels than the limit.
LayeredImage readExr(const std::filesystem::path& path,
                     std::uint64_t mostPixels = std::numeric_limits<std::uint64_t>::max());
/// Reads a Radiance image (.hdr, RGBE): three channels, divided by the exposure that its header names. Error
/// as above.
ImageBuffer readHdr(const std::filesystem::path& path, std::uint64_t mostPixels);
/// The text attributes of its first part alone, without its pixels.
std::map<std::string, std::string> readExrAttributes(const std::filesystem::path& path);
/// Writes 32-bit float ZIP-compressed scanlines, atomically.
void writeExr(const std::filesystem::path& path, const LayeredImage& image);

/// Writes a three- or one-channel linear image as an 8-bit PNG, atomically, exposed and tone-mapped. Values
/// clip at 1; NaN is magenta. `attributes`: keywords (Latin letters, 1 to 79) and texts that the file
/// carries.
void writePng(const std::filesystem::path& path, const ImageBuffer& linear, const Display& display = {},
              const std::map<std::string, std::string>& attributes = {});
/// The bytes of that PNG, for embedding into pages.
std::string encodePng(const ImageBuffer& linear, const Display& display = {},
                      const std::map<std::string, std::string>& attributes = {});
/// The text attributes of a PNG (its tEXt chunks), without its pixels. Error when it is none or damaged.
std::map<std::string, std::string> readPngAttributes(const std::filesystem::path& path);
/// Its pixels before they are packed: red, green and blue of each, row by row from the top.
std::vector<unsigned char> displayBytes(const ImageBuffer& linear, const Display& display = {});

/// An 8-bit image as stored (no transfer function applied).
struct ByteImage {
  int width = 0, height = 0, channels = 0;
  std::vector<unsigned char> values;
};
/// Reads PNG, JPG or TGA (stb). Error names the file.
ByteImage readByteImage(const std::filesystem::path& path);
/// The same of a file that was read before.
ByteImage decodeByteImage(const std::string& bytes, const std::filesystem::path& path);

/// A grey image of 16 bits as stored: depths of sensors.
struct WordImage {
  int width = 0, height = 0;
  std::vector<std::uint16_t> values;
};
/// Decodes a grey PNG of 16 bits. Error names the file, also for one of 8 bits, which holds no depths.
WordImage decodeGreyPng16(const std::string& bytes, const std::filesystem::path& path);
/// Writes it, atomically.
void writeGreyPng16(const std::filesystem::path& path, const WordImage& image);
/// Writes bytes of three channels as they are, atomically.
void writeBytePng(const std::filesystem::path& path, const ByteImage& image);

/// The sRGB transfer functions (IEC 61966-2-1), value in [0,1].
float srgbToLinear(float encoded);
float linearToSrgb(float linear);

}  // namespace lumivox
