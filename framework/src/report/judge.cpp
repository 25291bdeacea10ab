// When a published table counts as reproduced.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lumivox/report/changes.h"
#include "lumivox/report/reproduce.h"

namespace lumivox {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

bool isTime(PublishedQuantity quantity) {
  return quantity == PublishedQuantity::time || quantity == PublishedQuantity::frameRate;
}

bool sameMeasure(PublishedQuantity a, PublishedQuantity b) {
  return a == b || (isTime(a) && isTime(b));
}

/// The published number as what is measured: a rate as the time of a frame.
double comparable(const MeasuredRow& row) {
  constexpr double kMillisecondsPerSecond = 1000.0;
  return row.quantity == PublishedQuantity::frameRate ? kMillisecondsPerSecond / row.published
                                                      : row.published;
}

bool usable(const MeasuredRow& row) {
  return row.measured && row.measured->median > 0.0;
}

/// What a row is divided by: the first comparable one of its measure, else the first that was measured at
/// all.
const MeasuredRow* referenceOf(const std::vector<MeasuredRow>& rows, PublishedQuantity quantity) {
  for (const bool strict : {true, false})
    for (const MeasuredRow& row : rows)
      if (sameMeasure(row.quantity, quantity) && usable(row) && (!strict || row.whyNot.empty())) return &row;
  return nullptr;
}

JudgedRow judgeRow(const MeasuredRow& row, const MeasuredRow* reference) {
  JudgedRow judged{Verdict::notComparable, kNothing, kNothing, kNothing, kNothing, row.whyNot};
  if (reference != nullptr) judged.publishedRatio = comparable(row) / comparable(*reference);
  if (!usable(row)) {
    if (judged.why.empty()) judged.why = "it was not measured";
    return judged;
  }
  if (reference == &row) {
    judged.ratio = judged.lowRatio = judged.highRatio = 1.0;
    if (row.whyNot.empty()) judged.verdict = Verdict::reference;
    return judged;
  }
  const Measured above = medianOf(*row.measured), below = medianOf(*reference->measured);
  judged.ratio = above.value / below.value;
  const double reach =
      kReproducedSigmas * std::hypot(above.uncertainty / above.value, below.uncertainty / below.value);
  judged.lowRatio = judged.ratio * std::max(0.0, 1.0 - reach);
  judged.highRatio = judged.ratio * (1.0 + reach);
  if (!row.whyNot.empty()) return judged;
  const double least = judged.publishedRatio / kReproducedFactor,
               most = judged.publishedRatio * kReproducedFactor;
  if (judged.lowRatio >= least && judged.highRatio <= most)
    judged.verdict = Verdict::reproduced;
  else if (judged.highRatio < least || judged.lowRatio > most)
    judged.verdict = Verdict::notReproduced;
  else
    judged.why = fmt::format("the uncertainty of the measurement reaches across the limit, {:.3g} to {:.3g}",
                             judged.lowRatio, judged.highRatio);
  return judged;
}

/// Two comparable rows that stand in the other order than published by more than their uncertainty; empty:
/// none.
std::string brokenOrder(const std::vector<MeasuredRow>& rows) {
  for (const MeasuredRow& one : rows)
    for (const MeasuredRow& other : rows) {
      if (!sameMeasure(one.quantity, other.quantity) || !one.whyNot.empty() || !other.whyNot.empty() ||
          !usable(one) || !usable(other))
        continue;
      const Measured first = medianOf(*one.measured), second = medianOf(*other.measured);
      const double apart = kReproducedSigmas * std::hypot(first.uncertainty, second.uncertainty);
      if (comparable(one) < comparable(other) && first.value - second.value > apart)
        return fmt::format("'{}' is above '{}', in the other order than published", one.name, other.name);
    }
  return {};
}

}  // namespace

const char* name(PublishedQuantity quantity) {
  switch (quantity) {
    case PublishedQuantity::time:
      return "time";
    case PublishedQuantity::frameRate:
      return "frame_rate";
    case PublishedQuantity::fragments:
      return "fragments";
    case PublishedQuantity::memory:
      return "memory";
  }
  return "";
}

const char* unit(PublishedQuantity quantity) {
  switch (quantity) {
    case PublishedQuantity::time:
      return "ms";
    case PublishedQuantity::frameRate:
      return "1/s";
    case PublishedQuantity::fragments:
      return "";
    case PublishedQuantity::memory:
      return "MB";
  }
  return "";
}

const char* name(Verdict verdict) {
  switch (verdict) {
    case Verdict::reference:
      return "reference";
    case Verdict::reproduced:
      return "reproduced";
    case Verdict::notReproduced:
      return "not reproduced";
    case Verdict::notComparable:
      return "not comparable";
  }
  return "";
}

JudgedTable judge(const std::vector<MeasuredRow>& rows) {
  JudgedTable table;
  std::size_t reproduced = 0, missed = 0;
  for (const MeasuredRow& row : rows) {
    table.rows.push_back(judgeRow(row, referenceOf(rows, row.quantity)));
    reproduced += table.rows.back().verdict == Verdict::reproduced ? 1u : 0u;
    missed += table.rows.back().verdict == Verdict::notReproduced ? 1u : 0u;
  }
  const std::string order = brokenOrder(rows);
  const std::string count = fmt::format("{} of {} comparable rows within a factor of {}", reproduced,
                                        reproduced + missed, kReproducedFactor);
  if (missed > 0 || !order.empty()) {
    table.verdict = Verdict::notReproduced;
    table.why = order.empty() ? count : count + "; " + order;
  } else if (reproduced > 0) {
    table.verdict = Verdict::reproduced;
    table.why = count + ", in the published order";
  } else {
    table.why = "no row but the reference can be compared";
  }
  return table;
}

}  // namespace lumivox
