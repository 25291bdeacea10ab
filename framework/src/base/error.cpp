#include "lumivox/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

namespace lumivox {

std::string SourcePlace::text() const {
  if (line <= 0) return file;
  if (column <= 0) return fmt::format("{}:{}", file, line);
  return fmt::format("{}:{}:{}", file, line, column);
}

std::string Diagnostic::text() const {
  std::string result = place.text();
  result += severity == Severity::warning ? ": warning: " : ": ";
  result += what;
  if (!expected.empty()) result += "; expected " + expected;
  if (!suggestion.empty()) result += "; did you mean '" + suggestion + "'?";
  if (sourceLine.empty()) return result;
  // The caret line repeats tabs, so that the caret stands under its column whatever the width of a tab.
  std::string lead;
  for (int i = 0; i + 1 < place.column && i < static_cast<int>(sourceLine.size()); ++i) {
    lead += sourceLine[static_cast<std::size_t>(i)] == '\t' ? '\t' : ' ';
  }
  result += "\n  " + sourceLine + "\n  " + lead + '^';
  if (length > 1) result += std::string(static_cast<std::size_t>(length - 1), '~');
  return result;
}

namespace {
std::string joined(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (!text.empty()) text += '\n';
    text += diagnostic.text();
  }
  return text;
}

/// Checks run one after the other over the whole text; a reader goes from top to bottom. Files keep the order
/// in which they came up.
std::vector<Diagnostic> inTextOrder(std::vector<Diagnostic> diagnostics) {
  std::map<std::string, std::size_t> fileOrder;
  for (const Diagnostic& diagnostic : diagnostics) fileOrder.emplace(diagnostic.place.file, fileOrder.size());
  std::stable_sort(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& a, const Diagnostic& b) {
    return std::tuple(fileOrder[a.place.file], a.place.line, a.place.column) <
           std::tuple(fileOrder[b.place.file], b.place.line, b.place.column);
  });
  return diagnostics;
}
}  // namespace

DiagnosticsError::DiagnosticsError(std::vector<Diagnostic> diagnostics)
    : Error(joined(inTextOrder(diagnostics))), diagnostics_(inTextOrder(std::move(diagnostics))) {}

std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates) {
  // Edit distance with neighbouring letters swapped counted as one slip (optimal string alignment).
  const auto distance = [](const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
      for (std::size_t j = 1; j <= b.size(); ++j) {
        const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
        d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
          d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
    return d[a.size()][b.size()];
  };
  if (word.empty() || word.size() > 64) return {};
  std::string best;
  // A slip of the pen changes at most a third of the letters.
  std::size_t bestDistance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    if (candidate == word || candidate.size() > 64) continue;
    const std::size_t d = distance(word, candidate);
    if (d < bestDistance && d < std::max(word.size(), candidate.size())) {
      bestDistance = d;
      best = candidate;
    }
  }
  if (!best.empty()) return best;
  // The beginning of one is the other: "degrees" for "deg".
  constexpr std::size_t kLeastBeginning = 3;
  const auto isBeginning = [&](const std::string& candidate) {
    const std::size_t common = std::min(word.size(), candidate.size());
    return candidate != word && common >= kLeastBeginning &&
           word.compare(0, common, candidate, 0, common) == 0;
  };
  if (std::count_if(candidates.begin(), candidates.end(), isBeginning) != 1) return {};
  return *std::find_if(candidates.begin(), candidates.end(), isBeginning);
}

}  // namespace lumivox
