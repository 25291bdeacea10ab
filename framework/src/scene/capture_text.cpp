// Texts of captures: lines of numbers, poses, numbered files.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "scene/capture_files.h"

namespace lumivox {

namespace fs = std::filesystem;

bool isThere(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

std::vector<TextLine> linesOf(const fs::path& file) {
  const std::string text = readFile(file);
  std::vector<TextLine> lines;
  std::istringstream stream(text);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    line.resize(std::min(line.size(), line.find('#')));
    // Commas separate the columns of some exports; the stream skips carriage returns with other space.
    std::replace(line.begin(), line.end(), ',', ' ');
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    std::istringstream words(line);
    TextLine parsed{number, {}};
    for (std::string word; words >> word;) parsed.words.push_back(std::move(word));
    if (!parsed.words.empty()) lines.push_back(std::move(parsed));
  }
  return lines;
}

void refuseLine(const fs::path& file, const TextLine& line, std::string_view what,
                std::string_view expected) {
  throw Error(fmt::format("{}:{}: {}; expected {}", file.string(), line.number, what, expected));
}

double numberOf(const fs::path& file, const TextLine& line, std::size_t word) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  if (word >= line.words.size())
    refuseLine(file, line, fmt::format("{} numbers", line.words.size()),
               fmt::format("at least {}", word + 1));
  std::string text = line.words[word];
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  if (text.find("nan") != std::string::npos || text.find("#ind") != std::string::npos) return kNaN;
  if (text.find("inf") != std::string::npos) return std::numeric_limits<double>::infinity();
  const char* begin = text.data() + (text.front() == '+' ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  if (end != text.data() + text.size() || (error != std::errc() && error != std::errc::result_out_of_range))
    refuseLine(file, line, fmt::format("'{}' is no number", line.words[word]), "a number");
  return error == std::errc() ? value : kNaN;
}

glm::dmat4 matrixOf(const fs::path& file, const std::vector<TextLine>& lines, std::size_t first) {
  glm::dmat4 matrix;
  for (int row = 0; row < 4; ++row) {
    if (first + static_cast<std::size_t>(row) >= lines.size())
      throw Error(
          fmt::format("{}: the matrix ends after {} rows; expected 4 rows of 4 numbers", file.string(), row));
    const TextLine& line = lines[first + static_cast<std::size_t>(row)];
    if (line.words.size() != 4)
      refuseLine(file, line, fmt::format("{} numbers in the row of a matrix", line.words.size()), "4");
    for (int column = 0; column < 4; ++column)
      matrix[column][row] = numberOf(file, line, static_cast<std::size_t>(column));
  }
  return matrix;
}

std::optional<CapturePose> poseOf(const glm::dquat& rotation, const glm::dvec3& eye) {
  const double length = glm::length(rotation);
  const bool isFinite =
      std::isfinite(length) && std::isfinite(eye.x) && std::isfinite(eye.y) && std::isfinite(eye.z);
  if (!isFinite || length < 0.5 || length > 2.0 ||
      std::max({std::abs(eye.x), std::abs(eye.y), std::abs(eye.z)}) > kFarthestCaptured)
    return std::nullopt;
  glm::dquat unit = rotation / length;
  if (unit.w < 0.0) unit = -unit;
  // Cuts off digits in which a matrix of the same rotation rounds differently, far below the precision of any
  // tracker.
  constexpr double kSteps = 1099511627776.0;  // 2^40
  const auto rounded = [](double value) { return std::nearbyint(value * kSteps) / kSteps; };
  return CapturePose{glm::dquat(rounded(unit.w), rounded(unit.x), rounded(unit.y), rounded(unit.z)), eye};
}

std::optional<CapturePose> poseOf(const glm::dmat4& cameraToWorld) {
  const glm::dmat3 rotation(cameraToWorld);
  const glm::dmat3 product = glm::transpose(rotation) * rotation;
  constexpr double kNotARotation = 1e-2;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      if (!(std::abs(product[column][row] - (column == row ? 1.0 : 0.0)) <= kNotARotation))
        return std::nullopt;
  if (!(glm::determinant(rotation) > 0.0)) return std::nullopt;
  return poseOf(glm::quat_cast(rotation), glm::dvec3(cameraToWorld[3]));
}

std::vector<std::pair<int, fs::path>> numberedFiles(const fs::path& folder,
                                                    const std::vector<std::string>& endings,
                                                    const std::string& begin) {
  std::vector<std::pair<int, fs::path>> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const auto ending = std::find_if(endings.begin(), endings.end(), [&](const std::string& one) {
      return name.size() > one.size() && name.ends_with(one);
    });
    if (ending == endings.end() || !name.starts_with(begin)) continue;
    const std::string stem =
        name.substr(begin.size(), name.size() - std::min(name.size(), begin.size() + ending->size()));
    const std::size_t last = stem.find_last_of("0123456789");
    if (last == std::string::npos) continue;
    const std::size_t before = stem.find_last_not_of("0123456789", last);
    const std::size_t first = before == std::string::npos ? 0 : before + 1;
    int number = 0;
    const char* end = stem.data() + last + 1;
    if (std::from_chars(stem.data() + first, end, number).ec == std::errc())
      files.emplace_back(number, entry.path());
  }
  std::sort(files.begin(), files.end());
  const auto doubled = std::adjacent_find(files.begin(), files.end(),
                                          [](const auto& a, const auto& b) { return a.first == b.first; });
  if (doubled != files.end())
    throw Error(fmt::format("{} and {} have the same number; expected one file for each frame",
                            doubled->second.string(), std::next(doubled)->second.filename().string()));
  return files;
}

}  // namespace lumivox
