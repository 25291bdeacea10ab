#include "lumivox/analysis/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lumivox/measure/power_law.h"

namespace lumivox {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

bool isTime(PublishedQuantity quantity) {
  return quantity == PublishedQuantity::time || quantity == PublishedQuantity::frameRate;
}

bool sameMeasure(PublishedQuantity a, PublishedQuantity b) {
  return a == b || (isTime(a) && isTime(b));
}

/// The published number in the measured quantity: a frame rate becomes a frame time.
double comparable(const MeasuredRow& row) {
  constexpr double kMillisecondsPerSecond = 1000.0;
  return row.quantity == PublishedQuantity::frameRate ? kMillisecondsPerSecond / row.published
                                                      : row.published;
}

/// The measured value with its uncertainty. Counts of fragments and bytes are exact.
Measured measuredValue(const MeasuredSetUp& setUp, PublishedQuantity quantity) {
  Measured value = medianOf(*setUp.measured);
  value.enoughRepeats = value.enoughRepeats || !isTime(quantity);
  return value;
}

std::string tooFewRepeats(const MeasuredSetUp& setUp) {
  return fmt::format("{} repeat{} of a time, and a claim takes {} at least", setUp.measured->repeats,
                     setUp.measured->repeats == 1 ? "" : "s", kLeastRepeats);
}

bool usable(const MeasuredRow& row) {
  return row.measured && row.measured->median > 0.0;
}

/// The divisor of a row: the one that it names, else the first comparable row of its quantity, else the first
/// measured one.
const MeasuredRow* referenceOf(const std::vector<MeasuredRow>& rows, const MeasuredRow& divided) {
  if (!divided.over.empty()) {
    for (const MeasuredRow& row : rows)
      if (row.name == divided.over) return usable(row) ? &row : nullptr;
    return nullptr;
  }
  const PublishedQuantity quantity = divided.quantity;
  for (const bool strict : {true, false})
    for (const MeasuredRow& row : rows)
      if (sameMeasure(row.quantity, quantity) && usable(row) && (!strict || row.whyNot.empty())) return &row;
  return nullptr;
}

JudgedRow judgeRow(const MeasuredRow& row, const MeasuredRow* reference) {
  JudgedRow judged{Verdict::notComparable, kNothing, kNothing, kNothing, kNothing, row.whyNot};
  // A quotient is only as comparable as its divisor.
  if (judged.why.empty() && !row.over.empty() && reference != nullptr) judged.why = reference->whyNot;
  if (reference != nullptr) judged.publishedRatio = comparable(row) / comparable(*reference);
  if (!usable(row)) {
    if (judged.why.empty()) judged.why = "it was not measured";
    return judged;
  }
  if (reference == nullptr) {
    if (judged.why.empty()) judged.why = fmt::format("'{}' was not measured", row.over);
    return judged;
  }
  if (reference == &row) {
    judged.ratio = judged.lowRatio = judged.highRatio = 1.0;
    if (row.whyNot.empty()) judged.verdict = Verdict::reference;
    return judged;
  }
  const Measured above = measuredValue(row, row.quantity),
                 below = measuredValue(*reference, reference->quantity);
  judged.ratio = above.value / below.value;
  const double reach =
      kReproducedSigmas * std::hypot(above.uncertainty / above.value, below.uncertainty / below.value);
  judged.lowRatio = judged.ratio * std::max(0.0, 1.0 - reach);
  judged.highRatio = judged.ratio * (1.0 + reach);
  if (!judged.why.empty()) return judged;
  if (!above.enoughRepeats || !below.enoughRepeats) {
    judged.why = tooFewRepeats(above.enoughRepeats ? *reference : row);
    return judged;
  }
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

/// Names two comparable rows whose order differs from the published one by more than their uncertainty; empty
/// if none. Rows with divisors of their own form separate comparisons.
std::string brokenOrder(const std::vector<MeasuredRow>& rows) {
  for (const MeasuredRow& one : rows)
    for (const MeasuredRow& other : rows) {
      if (!sameMeasure(one.quantity, other.quantity) || !one.whyNot.empty() || !other.whyNot.empty() ||
          !usable(one) || !usable(other) || !one.over.empty() || !other.over.empty())
        continue;
      const Measured first = measuredValue(one, one.quantity), second = measuredValue(other, other.quantity);
      if (!first.enoughRepeats || !second.enoughRepeats) continue;
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
    case PublishedQuantity::voxelBytes:
      return "voxel_bytes";
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
    case PublishedQuantity::voxelBytes:
      return "B";
  }
  return "";
}

const char* name(ClaimedQuantity quantity) {
  switch (quantity) {
    case ClaimedQuantity::luminance:
      return "luminance";
    case ClaimedQuantity::colour:
      return "colour";
    case ClaimedQuantity::detail:
      return "detail";
  }
  return "";
}

const char* name(Growth growth) {
  switch (growth) {
    case Growth::unsaid:
      return "unsaid";
    case Growth::sublinear:
      return "sublinear";
    case Growth::linear:
      return "linear";
    case Growth::superlinear:
      return "superlinear";
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
    table.rows.push_back(judgeRow(row, referenceOf(rows, row)));
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

JudgedCurve judgeGrowth(const MeasuredCurve& curve) {
  JudgedCurve judged;
  std::vector<PowerLawPoint> points;
  for (const MeasuredPoint& point : curve.points) {
    if (judged.why.empty()) judged.why = point.whyNot;
    if (!point.measured) continue;
    const Measured value = measuredValue(point, curve.quantity);
    if (judged.why.empty() && !value.enoughRepeats) judged.why = tooFewRepeats(point);
    if (point.x > 0.0) points.push_back({point.x, value});
  }
  const PowerLaw law = fitPowerLaw(points);
  judged.exponent = law.slope;
  if (!std::isfinite(law.slope.value)) {
    if (judged.why.empty()) judged.why = "a growth takes three points of different x at least";
    return judged;
  }
  if (!judged.why.empty()) return judged;
  if (curve.growth == Growth::unsaid) {
    judged.why = "the paper does not say how it grows";
    return judged;
  }
  const auto [first, last] = std::minmax_element(
      points.begin(), points.end(), [](const PowerLawPoint& a, const PowerLawPoint& b) { return a.x < b.x; });
  const double low = law.slope.value - kReproducedSigmas * law.slope.uncertainty,
               high = law.slope.value + kReproducedSigmas * law.slope.uncertainty;
  // (last / first)^p within the factor of last / first.
  const double band = std::log(kReproducedFactor) / std::log(last->x / first->x);
  const double least = curve.growth == Growth::superlinear ? 1.0
                       : curve.growth == Growth::linear    ? 1.0 - band
                                                           : -std::numeric_limits<double>::infinity(),
               most = curve.growth == Growth::sublinear ? 1.0
                      : curve.growth == Growth::linear  ? 1.0 + band
                                                        : std::numeric_limits<double>::infinity();
  if (low >= least && high <= most)
    judged.verdict = Verdict::reproduced;
  else if (high < least || low > most)
    judged.verdict = Verdict::notReproduced;
  else
    judged.why =
        fmt::format("the uncertainty of the exponent reaches across the limit, {:.3g} to {:.3g}", low, high);
  return judged;
}

JudgedClaim judgeClaim(const MeasuredClaim& claim) {
  JudgedClaim judged{Verdict::notComparable, claim.whyNot};
  if (!judged.why.empty()) return judged;
  if (!std::isfinite(claim.lessValue) || !std::isfinite(claim.thanValue)) {
    judged.why = "there are no images to compare";
    return judged;
  }
  judged.verdict =
      claim.lessValue < claim.times * claim.thanValue ? Verdict::reproduced : Verdict::notReproduced;
  return judged;
}

std::vector<ReproducedResult> judged(std::vector<ReproducedResult> results) {
  for (ReproducedResult& result : results) {
    result.judged = judge(result.rows);
    result.judgedCurves.clear();
    for (const MeasuredCurve& curve : result.curves) result.judgedCurves.push_back(judgeGrowth(curve));
    result.judgedClaims.clear();
    for (const MeasuredClaim& claim : result.claims) result.judgedClaims.push_back(judgeClaim(claim));
  }
  return results;
}

}  // namespace lumivox
