#include "lumivox/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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
  for (std::size_t i = 0; i < shownFindings(diagnostics.size()); ++i) {
    if (!text.empty()) text += '\n';
    text += diagnostics[i].text();
  }
  const std::string more = moreFindingsText(diagnostics.size());
  return more.empty() ? text : text + '\n' + more;
}

/// Sorts findings by line, since each check runs over the whole text but a reader goes from top to bottom.
/// Files keep their order of appearance.
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

std::size_t shownFindings(std::size_t count) {
  // If only one more is left, it is shown, not counted.
  return count <= kMostFindingsShown + 1 ? count : kMostFindingsShown;
}

std::string moreFindingsText(std::size_t count) {
  const std::size_t shown = shownFindings(count);
  return shown == count ? std::string()
                        : fmt::format("and {} more findings; the first {} are shown", count - shown, shown);
}

std::string listed(const std::vector<std::string>& words) {
  constexpr std::size_t kMostListed = 100;
  if (words.size() <= kMostListed + 1) return fmt::format("{}", fmt::join(words, ", "));
  return fmt::format("{}, ... and {} more",
                     fmt::join(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(kMostListed), ", "),
                     words.size() - kMostListed);
}

namespace {

constexpr std::size_t kLongestWord = 64;  ///< longest word for which similar words are searched

/// Edit distance in which a swap of neighbouring letters counts as one edit (optimal string alignment).
/// Distances above `limit` give some larger number. Words have at most kLongestWord letters.
std::size_t slipsBetween(const std::string& a, const std::string& b, std::size_t limit) {
  const std::size_t more = limit + 1;
  if (std::max(a.size(), b.size()) - std::min(a.size(), b.size()) > limit) return more;
  // The current row of the table and the two before it. Outside of the band around the diagonal all distances
  // exceed the limit.
  std::array<std::array<std::size_t, kLongestWord + 1>, 3> rows;
  for (auto& row : rows) row.fill(more);
  for (std::size_t j = 0; j <= std::min(b.size(), limit); ++j) rows[0][j] = j;
  std::size_t leastBefore = 0;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    auto& row = rows[i % 3];
    const auto &before = rows[(i + 2) % 3], &beforeThat = rows[(i + 1) % 3];
    const std::size_t first = i > limit ? i - limit : 0, last = std::min(b.size(), i + limit);
    std::size_t least = more;
    if (first > 0) row[first - 1] = more;
    if (last < b.size()) row[last + 1] = more;
    for (std::size_t j = first; j <= last; ++j) {
      if (j == 0) {
        row[0] = i;
      } else {
        const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
        row[j] = std::min({before[j] + 1, row[j - 1] + 1, before[j - 1] + change});
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
          row[j] = std::min(row[j], beforeThat[j - 2] + 1);
      }
      least = std::min(least, row[j]);
    }
    // A swap skips a row and costs one edit.
    if (least > limit && leastBefore >= limit) return more;
    leastBefore = least;
  }
  return rows[a.size() % 3][b.size()];
}

}  // namespace

std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates) {
  if (word.empty() || word.size() > kLongestWord) return {};
  std::string best;
  // A typing error changes at most a third of the letters.
  std::size_t bestDistance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    if (bestDistance == 1) break;  // no word can be nearer
    if (candidate == word || candidate.size() > kLongestWord) continue;
    const std::size_t d = slipsBetween(word, candidate, bestDistance - 1);
    if (d < bestDistance && d < std::max(word.size(), candidate.size())) {
      bestDistance = d;
      best = candidate;
    }
  }
  if (!best.empty()) return best;
  // One word is the beginning of the other: "degrees" for "deg".
  constexpr std::size_t kLeastBeginning = 3;
  const auto isBeginning = [&](const std::string& candidate) {
    const std::size_t common = std::min(word.size(), candidate.size());
    return candidate != word && common >= kLeastBeginning &&
           word.compare(0, common, candidate, 0, common) == 0;
  };
  if (std::count_if(candidates.begin(), candidates.end(), isBeginning) != 1) return {};
  return *std::find_if(candidates.begin(), candidates.end(), isBeginning);
}

std::string suggestionFor(const std::vector<Diagnostic>& findings, const std::string& word,
                          const std::vector<std::string>& candidates) {
  return findings.size() > kMostFindingsShown ? std::string() : nearestWord(word, candidates);
}

}  // namespace lumivox
