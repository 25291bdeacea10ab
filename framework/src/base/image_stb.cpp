// Reads PNG, JPG and TGA by stb. stb checks neither checksums nor the end of a file, so the containers are
// checked here first: a damaged or truncated file must be refused.
#include <fmt/format.h>
#include <zlib.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include "base/deflate_limit.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_NO_STDIO
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace lumivox {
namespace {

using Bytes = std::basic_string_view<unsigned char>;

[[noreturn]] void refuse(std::string_view what) {
  throw Error(std::string(what));
}

std::uint32_t bigEndian32(Bytes bytes, std::size_t at) {
  return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
         std::uint32_t{bytes[at + 2]} << 8 | bytes[at + 3];
}

/// Checks chunks of length, type, data and checksum up to IEND (PNG specification, Sec. 5.3). Returns
/// keywords and texts of tEXt chunks, which a 0 byte separates (Sec. 11.3.3.2).
std::map<std::string, std::string> checkPng(Bytes bytes) {
  constexpr std::size_t kSignature = 8, kChunkFrame = 12;
  std::map<std::string, std::string> texts;
  for (std::size_t at = kSignature;;) {
    if (bytes.size() - at < kChunkFrame) refuse("the PNG is truncated");
    const std::size_t length = bigEndian32(bytes, at);
    if (length > bytes.size() - at - kChunkFrame) refuse("the PNG is truncated");
    const auto sum = crc32(0, bytes.data() + at + 4, static_cast<uInt>(length + 4));
    if (sum != bigEndian32(bytes, at + 8 + length)) refuse("a chunk of the PNG fails its checksum");
    if (std::memcmp(bytes.data() + at + 4, "IEND", 4) == 0) return texts;
    if (std::memcmp(bytes.data() + at + 4, "tEXt", 4) == 0) {
      const std::string data(bytes.begin() + static_cast<std::ptrdiff_t>(at + 8),
                             bytes.begin() + static_cast<std::ptrdiff_t>(at + 8 + length));
      if (const std::size_t end = data.find('\0'); end != std::string::npos)
        texts[data.substr(0, end)] = data.substr(end + 1);
    }
    at += kChunkFrame + length;
  }
}

/// JPEG (ITU-T T.81, Annex B): marker segments, entropy-coded data after each start of scan, and the
/// end-of-image marker.
void checkJpeg(Bytes bytes) {
  constexpr unsigned kStartOfScan = 0xDA, kEndOfImage = 0xD9, kFirstRestart = 0xD0, kLastRestart = 0xD7,
                     kTemporary = 0x01;
  bool inScan = false;
  for (std::size_t at = 2; at + 1 < bytes.size();) {
    if (bytes[at] != 0xFF) {
      if (!inScan) refuse("the JPEG has no marker where one is due");
      ++at;
      continue;
    }
    const unsigned marker = bytes[at + 1];
    if (marker == kEndOfImage) return;
    if (marker == 0xFF) {  // fill byte
      ++at;
    } else if (marker == 0 || marker == kTemporary || (marker >= kFirstRestart && marker <= kLastRestart)) {
      at += 2;  // a stuffed 0xFF, or a marker without a segment
    } else {
      if (at + 3 >= bytes.size()) break;
      inScan = marker == kStartOfScan;
      at += 2 + (std::size_t{bytes[at + 2]} << 8 | bytes[at + 3]);
    }
  }
  refuse("the JPEG is truncated");
}

/// Truevision TGA 2.0: an 18-byte header, the identification, the palette, then pixels, raw or in run-length
/// packets.
void checkTga(Bytes bytes) {
  constexpr std::size_t kHeader = 18;
  constexpr unsigned kRunLengthCoded = 8;
  if (bytes.size() < kHeader) refuse("is not a PNG, JPG or TGA");
  const auto littleEndian16 = [&](std::size_t at) {
    return std::size_t{bytes[at]} | std::size_t{bytes[at + 1]} << 8;
  };
  std::size_t at = kHeader + bytes[0];
  if (bytes[1] != 0) at += littleEndian16(5) * ((bytes[7] + 7u) / 8);
  const std::size_t pixelBytes = (bytes[16] + 7u) / 8;
  const std::size_t pixels = littleEndian16(12) * littleEndian16(14);
  if ((bytes[2] & kRunLengthCoded) == 0) {
    at += pixels * pixelBytes;
  } else {
    for (std::size_t decoded = 0; decoded < pixels;) {
      if (at >= bytes.size()) refuse("the TGA is truncated");
      const std::size_t run = (bytes[at] & 0x7Fu) + 1;
      at += 1 + ((bytes[at] & 0x80u) != 0 ? pixelBytes : run * pixelBytes);
      decoded += run;
    }
  }
  if (at > bytes.size()) refuse("the TGA is truncated");
}

void requireSmallFile(Bytes bytes) {
  if (bytes.empty()) refuse("the file is empty; expected a PNG, JPG or TGA");
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    refuse("the image file is over 2 GiB");
}

ByteImage decode(Bytes bytes) {
  requireSmallFile(bytes);
  const int size = static_cast<int>(bytes.size());
  ByteImage image;
  if (stbi_info_from_memory(bytes.data(), size, &image.width, &image.height, &image.channels) == 0) {
    refuse(fmt::format("is not a readable PNG, JPG or TGA: {}", stbi_failure_reason()));
  }
  if (bytes[0] == 0x89) {
    checkPng(bytes);
  } else if (bytes[0] == 0xFF && bytes[1] == 0xD8) {
    checkJpeg(bytes);
  } else {
    checkTga(bytes);
  }
  // The decoder holds the unpacked stream and the image at once, up to two bytes a channel.
  const std::uint64_t valueCount = static_cast<std::uint64_t>(image.width) *
                                   static_cast<std::uint64_t>(image.height) *
                                   static_cast<std::uint64_t>(image.channels);
  requireMemory(valueCount * 4, fmt::format("an image of {} x {} pixels", image.width, image.height));
  const std::unique_ptr<stbi_uc, decltype(&std::free)> pixels(
      stbi_load_from_memory(bytes.data(), size, &image.width, &image.height, &image.channels, 0), &std::free);
  if (!pixels) refuse(fmt::format("is not a readable PNG, JPG or TGA: {}", stbi_failure_reason()));
  image.values.assign(pixels.get(), pixels.get() + valueCount);
  return image;
}

}  // namespace

std::map<std::string, std::string> readPngAttributes(const std::filesystem::path& path) {
  const std::string file = readFile(path, kLargestImageFile);
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  try {
    if (file.substr(0, kSignature.size()) != kSignature) refuse("is not a PNG");
    return checkPng({reinterpret_cast<const unsigned char*>(file.data()), file.size()});
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

WordImage decodeGreyPng16(const std::string& file, const std::filesystem::path& path) {
  const Bytes bytes(reinterpret_cast<const unsigned char*>(file.data()), file.size());
  try {
    requireSmallFile(bytes);
    const int size = static_cast<int>(bytes.size());
    WordImage image;
    int channels = 0;
    if (bytes[0] != 0x89 ||
        stbi_info_from_memory(bytes.data(), size, &image.width, &image.height, &channels) == 0)
      refuse("is not a readable PNG; expected a grey PNG of 16 bits");
    checkPng(bytes);
    const bool has16Bits = stbi_is_16_bit_from_memory(bytes.data(), size) != 0;
    if (!has16Bits || channels != 1)
      refuse(fmt::format("has {} bits and {} channel{}; expected a grey PNG of 16 bits", has16Bits ? 16 : 8,
                         channels, channels == 1 ? "" : "s"));
    const std::uint64_t count =
        static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
    if (2 * count / kMostDeflateExpansion > bytes.size())
      refuse(fmt::format("claims {} x {} pixels, more than {} bytes hold", image.width, image.height,
                         bytes.size()));
    requireMemory(count * 6, fmt::format("an image of {} x {} pixels", image.width, image.height));
    const std::unique_ptr<stbi_us, decltype(&std::free)> pixels(
        stbi_load_16_from_memory(bytes.data(), size, &image.width, &image.height, &channels, 0), &std::free);
    if (!pixels) refuse(fmt::format("is not a readable PNG: {}", stbi_failure_reason()));
    image.values.assign(pixels.get(), pixels.get() + count);
    return image;
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

ByteImage readByteImage(const std::filesystem::path& path) {
  return decodeByteImage(readFile(path, kLargestImageFile), path);
}

ByteImage decodeByteImage(const std::string& bytes, const std::filesystem::path& path) {
  try {
    return decode(Bytes(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path.string(), error.what()));
  }
}

}  // namespace lumivox
