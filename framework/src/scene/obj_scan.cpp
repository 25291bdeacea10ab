#include "scene/obj_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>

#include "lumivox/base/error.h"
#include "scene/limits.h"

namespace lumivox {
namespace {

// Polygons are cut ear by ear, in cubic time.
constexpr std::size_t kMostCorners = 1024;

bool isBlank(char c) {
  return c == ' ' || c == '\t';
}
bool isLineEnd(char c) {
  return c == '\n' || c == '\r';
}

/// Walks over a text line by line; lines that end in a backslash are joined with the next.
class Lines {
 public:
  explicit Lines(std::string& text) : text_(text) {}

  bool next() {
    if (position_ >= text_.size()) return false;
    line_ = nextLine_;
    begin_ = position_;
    for (;;) {
      while (position_ < text_.size() && !isLineEnd(text_[position_])) ++position_;
      const std::size_t end = position_;
      if (position_ < text_.size()) {
        position_ +=
            text_[position_] == '\r' && position_ + 1 < text_.size() && text_[position_ + 1] == '\n' ? 2 : 1;
        ++nextLine_;
      }
      end_ = end;
      const bool continued = end > begin_ && text_[end - 1] == '\\' && position_ < text_.size();
      if (!continued) return true;
      std::fill(text_.begin() + static_cast<std::ptrdiff_t>(end) - 1,
                text_.begin() + static_cast<std::ptrdiff_t>(position_), ' ');
    }
  }

  int line() const { return line_; }
  std::size_t begin() const { return begin_; }
  std::string_view view() const { return std::string_view(text_).substr(begin_, end_ - begin_); }

 private:
  std::string& text_;
  std::size_t position_ = 0, begin_ = 0, end_ = 0;
  int line_ = 1, nextLine_ = 1;
};

/// Takes the next word from the front of a line; empty at its end.
std::string_view takeWord(std::string_view& rest) {
  std::size_t start = 0;
  while (start < rest.size() && isBlank(rest[start])) ++start;
  std::size_t end = start;
  while (end < rest.size() && !isBlank(rest[end])) ++end;
  const std::string_view word = rest.substr(start, end - start);
  rest.remove_prefix(end);
  return word;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
  while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
  return text;
}

/// The trimmed name, without a trailing comment.
std::string_view nameIn(std::string_view rest) {
  for (std::size_t i = 1; i < rest.size(); ++i) {
    if (rest[i] == '#' && isBlank(rest[i - 1])) return trimmed(rest.substr(0, i));
  }
  return trimmed(rest);
}

std::string shown(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string result;
  for (const char c : text.substr(0, kShown)) result += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  return text.size() > kShown ? result + "..." : result;
}

[[noreturn]] void refuse(const std::filesystem::path& file, int line, const std::string& what,
                         const std::string& expected) {
  throw Error(fmt::format("{}:{}: {}; expected {}", file.string(), line, what, expected));
}

enum class Reading { finite, nonFinite, malformed };

Reading readNumber(std::string_view word, double& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  if (result.ptr != word.data() + word.size()) return Reading::malformed;
  if (result.ec == std::errc::result_out_of_range) {
    // An underflow counts as zero; an overflow is not finite.
    return word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos
               ? Reading::finite
               : Reading::nonFinite;
  }
  if (result.ec != std::errc()) return Reading::malformed;
  return std::isfinite(value) && std::abs(value) <= std::numeric_limits<float>::max() ? Reading::finite
                                                                                      : Reading::nonFinite;
}

void replaceBlanksInside(std::string& text, std::string_view name) {
  const auto offset = static_cast<std::size_t>(name.data() - text.data());
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (isBlank(text[offset + i])) text[offset + i] = '_';
  }
}

class ObjScanner {
 public:
  ObjScanner(std::string& text, const std::filesystem::path& file) : text_(text), file_(file), lines_(text) {
    result_.objectNames.emplace_back();
    // Room that is not used is never touched, but a vector that grows is copied. Lines are rarely shorter.
    constexpr std::size_t kBytesPerVector = 24, kBytesPerCorner = 8;
    result_.positions.reserve(text.size() / kBytesPerVector);
    result_.normals.reserve(text.size() / kBytesPerVector);
    result_.texcoords.reserve(text.size() / kBytesPerVector);
    result_.corners.reserve(text.size() / kBytesPerCorner);
    result_.polygons.reserve(text.size() / (3 * kBytesPerCorner));
  }

  ObjScan run() {
    while (lines_.next()) readLine();
    bool broken = false;
    for (const Face& face : waiting_) {
      if (isBeyond(face)) {
        breakFace(face.begin, face.line);
        result_.polygons[face.polygon].corners = 0;
        broken = true;
      }
    }
    if (broken)
      std::erase_if(result_.polygons, [](const ObjPolygon& polygon) { return polygon.corners == 0; });
    result_.faces = result_.polygons.size();
    return std::move(result_);
  }

 private:
  struct Face {
    std::size_t begin;
    int line;
    long position, texcoord, normal;  // the largest index of each, from 1
    std::size_t polygon;              // its number among the polygons
  };

  bool isBeyond(const Face& face) const {
    return face.position > positions() || face.texcoord > static_cast<long>(result_.texcoords.size()) ||
           face.normal > static_cast<long>(result_.normals.size());
  }
  long positions() const { return static_cast<long>(result_.positions.size()); }

  void comment(std::size_t at) { text_[at] = '#'; }

  void breakFace(std::size_t begin, int line) {
    result_.brokenFaces.add(line);
    comment(begin);
  }

  void readLine() {
    std::string_view rest = lines_.view();
    const std::string_view word = takeWord(rest);
    if (word.empty() || word.front() == '#') return;
    const auto begin = static_cast<std::size_t>(word.data() - text_.data());
    if (word == "v") {
      glm::vec3 position(0.0f);
      if (!readNumbers(word, rest, 3, position))
        result_.nonFinitePositions.push_back(static_cast<std::uint32_t>(positions()));
      result_.positions.push_back(position);
    } else if (word == "vn") {
      glm::vec3 normal(0.0f);
      readNumbers(word, rest, 3, normal);
      result_.normals.push_back(normal);
    } else if (word == "vt") {
      glm::vec3 texcoord(0.0f);
      readNumbers(word, rest, 1, texcoord);
      result_.texcoords.emplace_back(texcoord);
    } else if (word == "f") {
      readFace(rest, begin);
    } else if (word == "usemtl") {
      readMaterialName(nameIn(rest));
    } else if (word == "mtllib") {
      result_.materialFiles.emplace_back(nameIn(rest));
    } else if (word == "g" || word == "o") {
      // A statement without a name names nothing. Several groups are one object with all their names.
      if (!rest.empty()) nameObject(word == "o" ? std::string(trimmed(rest)) : joinedWords(rest));
    } else if (word != "s") {
      readOther(word);
    }
  }

  static std::string joinedWords(std::string_view rest) {
    std::string names;
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) {
      if (!names.empty()) names += ' ';
      names += word;
    }
    return names;
  }

  void nameObject(std::string name) {
    if (result_.objectNames.back() != name) result_.objectNames.push_back(std::move(name));
  }

  bool readNumbers(std::string_view statement, std::string_view rest, int required, glm::vec3& values) {
    bool finite = true;
    int count = 0;
    for (std::string_view word = takeWord(rest); !word.empty() && count < 3; word = takeWord(rest), ++count) {
      double value = 0;
      const Reading reading = readNumber(word, value);
      if (reading == Reading::malformed) {
        refuse(file_, lines_.line(),
               fmt::format("'{}' in statement '{}' is not a number", shown(word), statement), "numbers");
      }
      finite = finite && reading == Reading::finite;
      values[count] = reading == Reading::finite ? static_cast<float>(value) : 0.0f;
    }
    if (count < required) {
      refuse(file_, lines_.line(), fmt::format("statement '{}' has {} numbers", statement, count),
             fmt::format("at least {} (is the file truncated?)", required));
    }
    if (!finite) result_.nonFinite.add(lines_.line());
    return finite;
  }

  /// An index counts from 1, or from the end when it is negative. False when it is broken for sure.
  static bool resolve(long& index, long count) {
    if (index < 0) index = count + index + 1;
    return index > 0;
  }

  void readFace(std::string_view rest, std::size_t begin) {
    Face face{begin, lines_.line(), 0, 0, 0, result_.polygons.size()};
    const std::size_t firstCorner = result_.corners.size();
    std::size_t corners = 0;
    bool whole = true;
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest), ++corners) {
      if (word.front() == '#') break;
      long indices[3] = {0, 0, 0};
      bool given[3] = {false, false, false};
      readCorner(word, indices, given);
      const long counts[3] = {positions(), static_cast<long>(result_.texcoords.size()),
                              static_cast<long>(result_.normals.size())};
      for (int i = 0; i < 3; ++i) {
        if (given[i]) whole = resolve(indices[i], counts[i]) && whole;
      }
      face.position = std::max(face.position, indices[0]);
      face.texcoord = std::max(face.texcoord, indices[1]);
      face.normal = std::max(face.normal, indices[2]);
      const auto fromZero = [&](int i) { return given[i] ? static_cast<int>(indices[i] - 1) : -1; };
      result_.corners.push_back({fromZero(0), fromZero(1), fromZero(2)});
    }
    if (corners < 3) {
      refuse(file_, lines_.line(), fmt::format("a face with {} corners", corners),
             "at least 3 (is the file truncated?)");
    }
    if (corners > kMostCorners) {
      refuse(file_, lines_.line(), fmt::format("a face with {} corners", corners),
             fmt::format("at most {}", kMostCorners));
    }
    if (!whole) {
      result_.corners.resize(firstCorner);
      return breakFace(begin, lines_.line());
    }
    if (result_.corners.size() > std::numeric_limits<std::uint32_t>::max() / 2)
      refuse(file_, lines_.line(), "more corners of faces than can be counted", "fewer than 2^31");
    if (isBeyond(face)) waiting_.push_back(face);
    result_.polygons.push_back({static_cast<std::uint32_t>(firstCorner), static_cast<std::uint32_t>(corners),
                                static_cast<std::uint32_t>(result_.objectNames.size() - 1), material_});
  }

  /// i, i/j, i//k or i/j/k.
  void readCorner(std::string_view word, long* indices, bool* given) {
    const std::string_view whole = word;
    bool good = true;
    for (int i = 0; i < 3 && good; ++i) {
      if (i > 0) {
        if (word.empty()) break;
        good = word.front() == '/';
        word.remove_prefix(1);
        if (good && i == 1 && !word.empty() && word.front() == '/') continue;  // i//k
      }
      good = good && readIndex(word, indices[i]);
      given[i] = good;
    }
    if (!good || !word.empty()) {
      refuse(file_, lines_.line(), fmt::format("malformed corner '{}' of a face", shown(whole)),
             "i, i/j, i//k or i/j/k");
    }
  }

  /// Takes a whole number from the front. A number out of range becomes 0, which is no index.
  static bool readIndex(std::string_view& word, long& index) {
    const auto result = std::from_chars(word.data(), word.data() + word.size(), index);
    constexpr long kLargest = std::numeric_limits<int>::max();
    if (result.ec == std::errc::result_out_of_range || std::abs(index) > kLargest) {
      index = 0;
    } else if (result.ec != std::errc()) {
      return false;
    }
    word.remove_prefix(static_cast<std::size_t>(result.ptr - word.data()));
    return true;
  }

  void readMaterialName(std::string_view name) {
    replaceBlanksInside(text_, name);
    if (name.empty()) refuse(file_, lines_.line(), "usemtl without a name", "the name of a material");
    const std::string text(name);
    const auto [known, isNew] =
        knownMaterials_.emplace(text, static_cast<std::uint32_t>(result_.materialNames.size()));
    if (isNew) result_.materialNames.push_back(text);
    material_ = known->second;
  }

  void readOther(std::string_view word) {
    // Display attributes and lines, which have no surface.
    static const std::set<std::string_view> quiet = {"l",        "p",   "mg",         "bevel",     "c_interp",
                                                     "d_interp", "lod", "shadow_obj", "trace_obj", "vp"};
    if (quiet.count(word) > 0) return;
    const bool isWord = std::all_of(word.begin(), word.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    });
    if (!isWord || (word.front() >= '0' && word.front() <= '9')) {
      refuse(file_, lines_.line(), fmt::format("'{}' is not a statement of an OBJ file", shown(word)),
             "v, vt, vn, f, g, o, usemtl, ...");
    }
    constexpr std::size_t kMostNamed = 16;
    if (result_.unusedStatements.size() < kMostNamed) result_.unusedStatements.emplace(word);
  }

  std::string& text_;
  const std::filesystem::path& file_;
  Lines lines_;
  ObjScan result_;
  std::vector<Face> waiting_;                            // for vertices that may come later in the file
  std::map<std::string, std::uint32_t> knownMaterials_;  // into materialNames
  std::uint32_t material_ = ObjPolygon::kNoMaterial;
};

}  // namespace

ObjScan scanObj(std::string& text, const std::filesystem::path& file) {
  return ObjScanner(text, file).run();
}

int lineOfFace(const std::string& text, int a, int b, int c) {
  std::string copy = text;
  Lines lines(copy);
  long positions = 0;
  while (lines.next()) {
    std::string_view rest = lines.view();
    const std::string_view word = takeWord(rest);
    if (word == "v") ++positions;
    if (word != "f") continue;
    bool found[3] = {false, false, false};
    for (std::string_view corner = takeWord(rest); !corner.empty(); corner = takeWord(rest)) {
      long index = 0;
      std::from_chars(corner.data(), corner.data() + corner.size(), index);
      index = index < 0 ? positions + index : index - 1;
      found[0] = found[0] || index == a;
      found[1] = found[1] || index == b;
      found[2] = found[2] || index == c;
    }
    if (found[0] && found[1] && found[2]) return lines.line();
  }
  return 0;
}

std::set<std::string> scanMtl(std::string& text, const std::filesystem::path& file) {
  if (const std::size_t at = text.find('\0'); at != std::string::npos) {
    throw Error(
        fmt::format("{}: contains a zero byte at offset {}; expected an MTL text", file.string(), at));
  }
  Lines lines(text);
  std::set<std::string> withDiffuse;
  std::string current;
  bool any = false;
  while (lines.next()) {
    std::string_view rest = lines.view();
    const std::string_view word = takeWord(rest);
    if (word.empty() || word.front() == '#') continue;
    const int line = lines.line();
    if (word == "newmtl") {
      const std::string_view name = trimmed(rest);
      if (name.empty()) refuse(file, line, "newmtl without a name", "the name of a material");
      replaceBlanksInside(text, name);
      current = name;
      any = true;
      continue;
    }
    const bool isSpectrum = word == "Kd" || word == "Ks" || word == "Ke";
    const bool isScalar = word == "Ns" || word == "d" || word == "Tr";
    if (!isSpectrum && !isScalar) continue;
    if (!any) refuse(file, line, fmt::format("'{}' before the first newmtl", word), "newmtl NAME");
    if (word == "Kd") withDiffuse.insert(current);
    const int count = isSpectrum ? 3 : 1;
    for (int i = 0; i < count; ++i) {
      const std::string_view number = takeWord(rest);
      double value = 0;
      if (number.empty() || readNumber(number, value) != Reading::finite) {
        refuse(file, line, fmt::format("'{}' of material '{}' is '{}'", word, current, shown(number)),
               count == 3 ? "three numbers" : "a number");
      }
      if (value < 0)
        refuse(file, line, fmt::format("'{}' of material '{}' is negative", word, current),
               "numbers of at least 0");
      const double most = word == "Ke" ? kMostLight : word == "Ns" ? kLargestExponent : kLargestGivenAlbedo;
      if (value > most)
        refuse(file, line, fmt::format("'{}' of material '{}' is {}", word, current, shown(number)),
               fmt::format("at most {:g}", most));
    }
  }
  if (!any)
    throw Error(fmt::format("{}: contains no material; expected an MTL text with newmtl", file.string()));
  return withDiffuse;
}

}  // namespace lumivox
