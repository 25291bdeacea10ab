// Reads Radiance images (.hdr): Ward 1991, "Real pixels", and the format's description with Radiance. The
// runs have to be walked to tell a whole file from a truncated one, and that is most of decoding them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"

namespace lumivox {
namespace {

class HdrReader {
 public:
  explicit HdrReader(std::string_view bytes) : bytes_(bytes) {}

  ImageBuffer read(std::uint64_t mostPixels) {
    readHeader();
    const std::uint64_t pixels = static_cast<std::uint64_t>(width_) * static_cast<std::uint64_t>(height_);
    const std::string claim = fmt::format("{} x {} pixels", width_, height_);
    if (pixels > mostPixels)
      throw Error(fmt::format("has {}, {} as floats; expected at most {} pixels", claim,
                              formatBytes(pixels * 3 * sizeof(float)), mostPixels));
    // The longest run takes two bytes for 127 values, of four components a pixel. Runs of the old kind may
    // pack more; such images are refused.
    const std::uint64_t leastBytes = pixels * 4 * 2 / 128;
    if (leastBytes > bytes_.size())
      throw Error(fmt::format("claims {}, more than {} bytes hold", claim, bytes_.size()));
    requireMemory(pixels * 3 * sizeof(float), "a Radiance image of " + claim);
    ImageBuffer image(width_, height_, 3);
    std::vector<Pixel> row(static_cast<std::size_t>(width_));
    float* value = image.values().data();
    for (row_ = 0; row_ < height_; ++row_) {
      readRow(row);
      for (const Pixel& pixel : row)
        for (const float channel : linear(pixel)) *value++ = channel;
    }
    return image;
  }

 private:
  using Pixel = std::array<unsigned char, 4>;  // red, green, blue and their common exponent

  std::string_view line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) throw Error("is not a Radiance image: its header has no end");
    std::string_view text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }

  /// Lines of variables up to an empty one, then the size: "-Y height +X width", rows from the top.
  void readHeader() {
    if (bytes_.substr(0, 2) != "#?") throw Error("is not a Radiance image: expected it to begin with '#?'");
    bool known = false;
    for (std::string_view text = line(); !text.empty(); text = line()) {
      constexpr std::string_view kFormat = "FORMAT=", kExposure = "EXPOSURE=";
      if (text.starts_with(kFormat)) {
        known = text.substr(kFormat.size()) == "32-bit_rle_rgbe";
        if (!known)
          throw Error(
              fmt::format("has the format '{}'; expected 32-bit_rle_rgbe", text.substr(kFormat.size())));
      } else if (text.starts_with(kExposure)) {
        text.remove_prefix(std::min(text.find_first_not_of(' ', kExposure.size()), text.size()));
        float exposure = 0.0f;
        std::from_chars(text.data(), text.data() + text.size(), exposure);
        if (!(exposure > 0.0f) || !std::isfinite(exposure))
          throw Error(fmt::format("has the exposure '{}'; expected a positive number", text));
        exposure_ *= exposure;
        if (!(exposure_ > 0.0f) || !std::isfinite(exposure_))
          throw Error("has exposures whose product is no positive number; expected one");
      }
    }
    if (!known) throw Error("names no format; expected a line FORMAT=32-bit_rle_rgbe");
    const std::string size(line());
    char end = 0;
    if (std::sscanf(size.c_str(), "-Y %7d +X %7d%c", &height_, &width_, &end) != 2 || height_ < 1 ||
        width_ < 1)
      throw Error(fmt::format("has the size '{}'; expected -Y HEIGHT +X WIDTH of 1 to 9999999 each",
                              size.substr(0, 64)));
  }

  unsigned char byte() {
    if (at_ >= bytes_.size())
      throw Error(fmt::format("is truncated: it ends in row {} of {}", row_ + 1, height_));
    return static_cast<unsigned char>(bytes_[at_++]);
  }

  void readRow(std::vector<Pixel>& row) {
    // A row of runs begins with 2, 2 and its width in 15 bits.
    constexpr int kNarrowest = 8, kWidest = 32767;
    const std::string_view start = bytes_.substr(std::min(at_, bytes_.size()), 4);
    if (width_ < kNarrowest || width_ > kWidest || start.size() < 4 || start[0] != 2 || start[1] != 2 ||
        (static_cast<unsigned char>(start[2]) & 0x80u) != 0)
      return readPixels(row);
    const int width = static_cast<unsigned char>(start[2]) << 8 | static_cast<unsigned char>(start[3]);
    if (width != width_)
      throw Error(fmt::format("is damaged: row {} has {} pixels of {}", row_ + 1, width, width_));
    at_ += 4;
    for (std::size_t component = 0; component < 4; ++component) {
      for (std::size_t x = 0; x < row.size();) {
        const unsigned code = byte();
        const bool isRun = code > 128;
        const std::size_t count = isRun ? code - 128 : code;
        if (count == 0 || count > row.size() - x)
          throw Error(fmt::format("is damaged: a run in row {} has {} of {} values", row_ + 1, count,
                                  row.size() - x));
        unsigned char value = isRun ? byte() : 0;
        for (std::size_t i = 0; i < count; ++i, ++x) row[x][component] = isRun ? value : (value = byte());
      }
    }
  }

  /// Pixels one by one; (1, 1, 1, n) repeats the last one n times, and such pixels in a row are digits of 8
  /// bits.
  void readPixels(std::vector<Pixel>& row) {
    unsigned shift = 0;
    for (std::size_t x = 0; x < row.size();) {
      const Pixel pixel{byte(), byte(), byte(), byte()};
      if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
        row[x++] = pixel;
        shift = 0;
        continue;
      }
      const std::size_t count = shift < 24 ? std::size_t{pixel[3]} << shift : row.size();
      if (x == 0 || count > row.size() - x)
        throw Error(fmt::format("is damaged: a run in row {} goes beyond its end", row_ + 1));
      for (std::size_t i = 0; i < count; ++i, ++x) row[x] = row[x - 1];
      shift += 8;
    }
  }

  /// (m + 1/2) / 256 * 2^(e - 128), the middle of what the bytes stand for; black where the exponent is 0.
  std::array<float, 3> linear(const Pixel& pixel) const {
    if (pixel[3] == 0) return {};
    const float unit = std::ldexp(1.0f, pixel[3] - (128 + 8)) / exposure_;
    return {(pixel[0] + 0.5f) * unit, (pixel[1] + 0.5f) * unit, (pixel[2] + 0.5f) * unit};
  }

  std::string_view bytes_;
  std::size_t at_ = 0;
  int width_ = 0, height_ = 0, row_ = 0;
  float exposure_ = 1.0f;
};

}  // namespace

ImageBuffer readHdr(const std::filesystem::path& path, std::uint64_t mostPixels) {
  const std::string bytes = readFile(path, kLargestExrFile);
  try {
    return HdrReader(bytes).read(mostPixels);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace lumivox
