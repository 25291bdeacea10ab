#include "stress/cards.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "lumivox/base/file.h"

namespace lumivox::stress {
namespace {

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t`"), last = text.find_last_not_of(" \t`");
  return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

/// The text without surrounding white space.
std::string trimmedLine(const std::string& line) {
  const std::size_t first = line.find_first_not_of(" \t\r"), last = line.find_last_not_of(" \t\r");
  return first == std::string::npos ? std::string() : line.substr(first, last - first + 1);
}

/// The text without a full stop at its end.
std::string withoutPoint(const std::string& text) {
  return !text.empty() && text.back() == '.' ? text.substr(0, text.size() - 1) : text;
}

/// "`case`, `pipeline/case_*`: what happens. *Why:* the reason." as a row; without names it speaks of no
/// case.
CardRow rowOf(const std::string& item) {
  static const std::string kNamesEnd = "`: ", kWhy = "*Why:*";
  CardRow row;
  const std::size_t colon = item.find(kNamesEnd), why = item.find(kWhy);
  const std::size_t from = colon == std::string::npos ? 0 : colon + kNamesEnd.size();
  if (colon != std::string::npos) {
    std::istringstream names(item.substr(0, colon + 1));
    for (std::string name; std::getline(names, name, ',');) row.cases.push_back(trimmed(name));
  }
  row.what = withoutPoint(trimmedLine(item.substr(from, why == std::string::npos ? why : why - from)));
  if (why != std::string::npos) row.why = withoutPoint(trimmedLine(item.substr(why + kWhy.size())));
  row.numbers = boldNumbers(row.what);
  return row;
}

/// A number that fills the text, and the value of one in its last written digit; nullopt where it is not a
/// number.
struct WrittenNumber {
  double value = 0.0, lastDigit = 0.0;
};
std::optional<WrittenNumber> numberIn(const std::string& text) {
  char* end = nullptr;
  WrittenNumber number;
  number.value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(number.value)) return std::nullopt;
  const std::size_t exponent = std::min(text.find_first_of("eE"), text.size());
  const std::size_t point = text.find('.');
  const double decimals = point < exponent ? static_cast<double>(exponent - point - 1) : 0.0;
  const double scale = exponent < text.size() ? std::strtod(text.c_str() + exponent + 1, nullptr) : 0.0;
  number.lastDigit = std::pow(10.0, scale - decimals);
  return number;
}

std::optional<CardNumber> cardNumberIn(const std::string& text) {
  constexpr double kSpread = 0.05;  // drivers round differently, and cards write two or three digits
  static const std::string kBetween = "..", kPlusMinus = "±";
  const auto part = [&](std::size_t from, std::size_t count) {
    return numberIn(trimmed(text.substr(from, count)));
  };
  if (const std::size_t at = text.find(kBetween); at != std::string::npos) {
    const auto low = part(0, at), high = part(at + kBetween.size(), std::string::npos);
    // Written digits are rounded, so that the ends may be half a digit beyond.
    if (!low || !high || low->value > high->value) return std::nullopt;
    return CardNumber{low->value - 0.5 * low->lastDigit, high->value + 0.5 * high->lastDigit, text};
  }
  if (const std::size_t at = text.find(kPlusMinus); at != std::string::npos) {
    const auto middle = part(0, at), spread = part(at + kPlusMinus.size(), std::string::npos);
    if (!middle || !spread) return std::nullopt;
    return CardNumber{middle->value - spread->value, middle->value + spread->value, text};
  }
  const auto number = numberIn(trimmed(text));
  if (!number) return std::nullopt;
  const double spread = std::max(kSpread * std::abs(number->value), number->lastDigit);
  return CardNumber{number->value - spread, number->value + spread, text};
}

}  // namespace

bool CardNumber::admits(const Measured& measured) const {
  constexpr double kSigmas = 3.0;
  const double own = std::isfinite(measured.uncertainty) ? kSigmas * measured.uncertainty : 0.0;
  return measured.value >= low - own && measured.value <= high + own;
}

std::vector<CardNumber> boldNumbers(const std::string& text) {
  static const std::string kStars = "**";
  std::vector<CardNumber> numbers;
  for (std::size_t open = text.find(kStars); open != std::string::npos;) {
    const std::size_t close = text.find(kStars, open + kStars.size());
    if (close == std::string::npos) break;
    if (auto number = cardNumberIn(text.substr(open + kStars.size(), close - open - kStars.size())))
      numbers.push_back(std::move(*number));
    open = text.find(kStars, close + kStars.size());
  }
  return numbers;
}

std::vector<CardRow> whereItBreaks(const std::string& card) {
  std::vector<CardRow> rows;
  std::istringstream lines(card);
  std::string item;
  const auto finish = [&] {
    if (!item.empty()) rows.push_back(rowOf(item));
    item.clear();
  };
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    const bool begins = line.rfind("- ", 0) == 0, goesOn = line.rfind("  ", 0) == 0 && !item.empty();
    if (!goesOn) finish();
    if (line.rfind("# ", 0) == 0) inside = false;  // the card of the next chapter
    if (line.rfind("## ", 0) == 0) inside = trimmed(line.substr(3)) == "Where it breaks";
    if (inside && (begins || goesOn)) item += (item.empty() ? "" : " ") + trimmedLine(line.substr(2));
  }
  finish();
  return rows;
}

const CardRow* rowFor(const std::vector<CardRow>& rows, const std::string& pipelineStem,
                      const std::string& caseName) {
  for (const bool namesPipeline : {true, false}) {
    const std::string subject = namesPipeline ? pipelineStem + "/" + caseName : caseName;
    for (const CardRow& row : rows)
      for (const std::string& pattern : row.cases)
        if ((pattern.find('/') != std::string::npos) == namesPipeline &&
            fnmatch(pattern.c_str(), subject.c_str(), 0) == 0)
          return &row;
  }
  return nullptr;
}

CardAnswer answerOf(const CardRow& row, const StressCell& cell) {
  const std::string explanation = row.what + ": " + row.why;
  // A cell without a number has nothing to compare.
  if (cell.measure.empty() || !std::isfinite(cell.value.value)) return {explanation, {}};
  if (row.numbers.empty())
    return {{}, fmt::format("the card's row for it names no measured number in bold: '{}'", row.what)};
  if (std::any_of(row.numbers.begin(), row.numbers.end(),
                  [&](const CardNumber& number) { return number.admits(cell.value); }))
    return {explanation, {}};
  std::string said;
  for (const CardNumber& number : row.numbers) said += (said.empty() ? "" : ", ") + number.text;
  return {{},
          fmt::format("{:.3g} is none of the numbers that the card's row for it names: {}", cell.value.value,
                      said)};
}

CardAnswer explanationOf(const StressCell& cell, const Pipeline& pipeline, TechniqueSource& techniques) {
  if (cell.outcome != StressOutcome::biased && cell.outcome != StressOutcome::diverges) return {};
  std::vector<std::string> names = pipeline.techniques();
  std::stable_partition(names.begin(), names.end(),
                        [&](const std::string& name) { return name == cell.technique; });
  std::vector<CardRow> rows;
  for (const std::string& name : names) {
    const Technique* technique = techniques.technique(name);
    if (technique == nullptr) continue;
    const std::filesystem::path file = technique->library.parent_path() / (name + ".md");
    std::error_code failure;
    if (!std::filesystem::exists(file, failure)) continue;
    for (CardRow& row : whereItBreaks(readFile(file))) rows.push_back(std::move(row));
  }
  const CardRow* row = rowFor(rows, pipeline.file.stem().string(), cell.name);
  return row == nullptr ? CardAnswer{} : answerOf(*row, cell);
}

}  // namespace lumivox::stress
