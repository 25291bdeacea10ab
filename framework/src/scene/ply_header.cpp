#include "scene/ply_header.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <limits>

#include "lumivox/base/error.h"

namespace lumivox {
namespace {

std::optional<PlyScalar> scalarNamed(std::string_view name) {
  constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                   {"uchar", "uint8"},
                                                                   {"short", "int16"},
                                                                   {"ushort", "uint16"},
                                                                   {"int", "int32"},
                                                                   {"uint", "uint32"},
                                                                   {"float", "float32"},
                                                                   {"double", "float64"}}};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (name == kNames[i][0] || name == kNames[i][1]) return static_cast<PlyScalar>(i);
  return std::nullopt;
}

class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::filesystem::path& file) : text_(text), file_(file) {}

  PlyHeader run() {
    if (nextLine() != "ply") refuse("does not begin with 'ply'", "a PLY file");
    bool hasFormat = false;
    for (;;) {
      const std::vector<std::string_view> words = plyWordsOf(nextLine());
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format") {
        readFormat(words);
        hasFormat = true;
      } else if (words[0] == "element") {
        readElement(words);
      } else if (words[0] == "property") {
        readProperty(words);
      } else {
        refuse(fmt::format("unknown word '{}' in the header", legible(words[0])),
               "format, comment, element, property or end_header");
      }
    }
    if (!hasFormat) refuse("the header has no format", "format ascii 1.0 or a binary one");
    header_.dataAt = at_;
    header_.lines = line_;
    return std::move(header_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what, const std::string& expected) const {
    throw Error(fmt::format("{}:{}: {}; expected {}", file_.string(), line_, what, expected));
  }

  std::string_view nextLine() {
    constexpr std::size_t kLongestLine = 4096;
    ++line_;
    const std::size_t end = text_.find('\n', at_);
    if (end == std::string_view::npos || end - at_ > kLongestLine)
      refuse("the header does not end", "a line end_header (is this a PLY file?)");
    std::string_view line = text_.substr(at_, end - at_);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    at_ = end + 1;
    return line;
  }

  void readFormat(const std::vector<std::string_view>& words) {
    constexpr std::array<std::string_view, 3> kNames{"ascii", "binary_little_endian", "binary_big_endian"};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      if (words.size() == 3 && words[1] == kNames[i] && words[2] == "1.0") {
        header_.format = static_cast<PlyFormat>(i);
        return;
      }
    }
    refuse("unknown format", "format ascii, binary_little_endian or binary_big_endian, and 1.0");
  }

  void readElement(const std::vector<std::string_view>& words) {
    constexpr std::size_t kMostElements = 64;
    PlyElement element;
    if (words.size() != 3 ||
        std::from_chars(words[2].data(), words[2].data() + words[2].size(), element.count).ptr !=
            words[2].data() + words[2].size() ||
        element.count > std::numeric_limits<std::uint32_t>::max() || header_.elements.size() >= kMostElements)
      refuse("malformed element", "element NAME COUNT, with a count below 2^32, and at most 64 elements");
    element.name = words[1];
    header_.elements.push_back(std::move(element));
  }

  void readProperty(const std::vector<std::string_view>& words) {
    constexpr std::size_t kMostProperties = 256;
    const std::string expected = "property TYPE NAME or property list TYPE TYPE NAME";
    if (header_.elements.empty()) refuse("a property before the first element", "an element first");
    std::vector<PlyProperty>& properties = header_.elements.back().properties;
    PlyProperty property;
    const bool isList = words.size() == 5 && words[1] == "list";
    const auto type = scalarNamed(words.size() < 3 ? "" : words[words.size() - 2]);
    if ((!isList && words.size() != 3) || !type || properties.size() >= kMostProperties)
      refuse("malformed property", expected);
    property.name = words.back();
    property.type = *type;
    if (isList) {
      property.listCount = scalarNamed(words[2]);
      if (!property.listCount || *property.listCount >= PlyScalar::float32)
        refuse("a list whose length is no whole number", expected);
    }
    properties.push_back(std::move(property));
  }

  std::string_view text_;
  const std::filesystem::path& file_;
  PlyHeader header_;
  std::size_t at_ = 0;
  int line_ = 0;
};

}  // namespace

std::size_t sizeOf(PlyScalar type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

PlyHeader readPlyHeader(std::string_view bytes, const std::filesystem::path& file) {
  return HeaderReader(bytes, file).run();
}

bool isPlySeparator(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

std::vector<std::string_view> plyWordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < line.size();) {
    while (at < line.size() && isPlySeparator(line[at])) ++at;
    const std::size_t begin = at;
    while (at < line.size() && !isPlySeparator(line[at])) ++at;
    if (at > begin) words.push_back(line.substr(begin, at - begin));
  }
  return words;
}

std::string legible(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string result;
  for (const char c : text.substr(0, kShown)) result += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  return text.size() > kShown ? result + "..." : result;
}

}  // namespace lumivox
