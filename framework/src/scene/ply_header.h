// The header of a PLY file: which elements with which properties follow, and in which form.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lumivox {

enum class PlyScalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// In bytes.
std::size_t sizeOf(PlyScalar type);

struct PlyProperty {
  std::string name;
  PlyScalar type = PlyScalar::float32;
  std::optional<PlyScalar> listCount;  ///< type of the length of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyFormat { ascii, littleEndian, bigEndian };

/// The texts before the data, and where these begin.
struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t dataAt = 0;  ///< byte
  int lines = 0;
};

/// Error names the file and the line.
PlyHeader readPlyHeader(std::string_view bytes, const std::filesystem::path& file);

/// Words between blanks and line ends.
bool isPlySeparator(char c);
std::vector<std::string_view> plyWordsOf(std::string_view line);
/// The beginning of a text from a file, fit for a message.
std::string legible(std::string_view text);

}  // namespace lumivox
