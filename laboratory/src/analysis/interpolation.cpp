#include "lumivox/analysis/interpolation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lumivox {
namespace {

/// A segment of a Pareto front in log-log space, from x1 to x2; u: relative uncertainties.
struct Segment {
  double x1, x2, y1, y2;
  double ux1, ux2, uy1, uy2;
  bool enoughRepeats;
};

double relative(const Measured& measured) {
  return measured.uncertainty / measured.value;
}

Segment segmentOf(const TradeOff& a, const TradeOff& b) {
  return {std::log(a.timeMs.value),
          std::log(b.timeMs.value),
          std::log(a.error.value),
          std::log(b.error.value),
          relative(a.timeMs),
          relative(b.timeMs),
          relative(a.error),
          relative(b.error),
          decidable(a.timeMs, b.timeMs) && decidable(a.error, b.error)};
}

/// The uncertainty from the slope, at most the segment's whole step.
double throughSlope(double slope, double uncertainty, double step) {
  return std::min(std::abs(slope) * uncertainty, std::abs(step));
}

}  // namespace

const char* name(Reach reach) {
  switch (reach) {
    case Reach::interpolated:
      return "interpolated";
    case Reach::atMost:
      return "at_most";
    case Reach::notReached:
      return "not_reached";
    case Reach::notMeasured:
      break;
  }
  return "not_measured";
}

std::vector<std::size_t> frontByValue(const std::vector<TradeOff>& points) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].timeMs.value > 0.0 && points[i].error.value > 0.0 && std::isfinite(points[i].error.value))
      order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (points[a].timeMs.value != points[b].timeMs.value)
      return points[a].timeMs.value < points[b].timeMs.value;
    return points[a].error.value < points[b].error.value;
  });
  std::vector<std::size_t> front;
  for (const std::size_t index : order)
    if (front.empty() || points[index].error.value < points[front.back()].error.value) front.push_back(index);
  return front;
}

double sigmasApart(const Measured& a, const Measured& b) {
  const double difference = std::abs(a.value - b.value);
  if (difference == 0.0) return 0.0;
  const double uncertainty = std::hypot(a.uncertainty, b.uncertainty);
  return uncertainty > 0.0 ? difference / uncertainty : std::numeric_limits<double>::infinity();
}

bool decidable(const Measured& a, const Measured& b) {
  return a.enoughRepeats && b.enoughRepeats;
}

bool differ(const Measured& a, const Measured& b, double leastShare) {
  return decidable(a, b) && sigmasApart(a, b) > kSignificantSigmas &&
         std::abs(a.value - b.value) > leastShare * std::abs(a.value);
}

bool beats(const TradeOff& a, const TradeOff& b, double timeShare) {
  if (a.timeMs.value > b.timeMs.value || a.error.value > b.error.value) return false;
  return differ(b.timeMs, a.timeMs, timeShare) || differ(b.error, a.error);
}

std::vector<std::optional<std::size_t>> beatenBy(const std::vector<TradeOff>& points, double timeShare) {
  std::vector<std::optional<std::size_t>> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < points.size(); ++j)
      if (beats(points[j], points[i], timeShare) &&
          (!result[i] || points[j].error.value < points[*result[i]].error.value))
        result[i] = j;
  return result;
}

std::optional<std::size_t> leastOf(const std::vector<TradeOff>& points,
                                   const std::vector<std::size_t>& candidates, Measured TradeOff::*number) {
  const auto least = std::min_element(
      candidates.begin(), candidates.end(),
      [&](std::size_t a, std::size_t b) { return (points[a].*number).value < (points[b].*number).value; });
  return least == candidates.end() ? std::nullopt : std::optional(*least);
}

std::optional<std::size_t> leastWithinNoise(const std::vector<TradeOff>& points,
                                            const std::vector<std::size_t>& candidates,
                                            Measured TradeOff::*number, double timeShare) {
  const std::optional<std::size_t> least = leastOf(points, candidates, number);
  if (!least) return std::nullopt;
  const bool isTime = number == &TradeOff::timeMs;
  const Measured& best = points[*least].*number;
  std::vector<std::size_t> alike;
  for (const std::size_t index : candidates) {
    const Measured& own = points[index].*number;
    if (index == *least || (decidable(best, own) && !differ(best, own, isTime ? timeShare : 0.0)))
      alike.push_back(index);
  }
  return leastOf(points, alike, isTime ? &TradeOff::error : &TradeOff::timeMs);
}

Interpolated errorAtTime(const std::vector<TradeOff>& points, const std::vector<std::size_t>& front,
                         double timeMs) {
  if (front.empty()) return {};
  const TradeOff &first = points[front.front()], &last = points[front.back()];
  if (timeMs < first.timeMs.value) return {Reach::notReached, first.error, front.front(), front.front()};
  if (timeMs > last.timeMs.value) return {Reach::atMost, last.error, front.back(), front.back()};
  if (front.size() == 1) return {Reach::interpolated, first.error, front.front(), front.front()};
  std::size_t right = 1;
  while (points[front[right]].timeMs.value < timeMs) ++right;
  const Segment s = segmentOf(points[front[right - 1]], points[front[right]]);
  const double w = (std::log(timeMs) - s.x1) / (s.x2 - s.x1);
  const double slope = (s.y2 - s.y1) / (s.x2 - s.x1);
  const double value = std::exp((1.0 - w) * s.y1 + w * s.y2);
  const double u = std::hypot((1.0 - w) * s.uy1 + w * s.uy2,
                              throughSlope(slope, std::hypot((1.0 - w) * s.ux1, w * s.ux2), s.y2 - s.y1));
  return {Reach::interpolated, {value, value * u, s.enoughRepeats}, front[right - 1], front[right]};
}

Interpolated timeAtError(const std::vector<TradeOff>& points, const std::vector<std::size_t>& front,
                         double error) {
  if (front.empty()) return {};
  const TradeOff &first = points[front.front()], &last = points[front.back()];
  if (error > first.error.value) return {Reach::atMost, first.timeMs, front.front(), front.front()};
  if (error < last.error.value) return {Reach::notReached, last.timeMs, front.back(), front.back()};
  if (front.size() == 1) return {Reach::interpolated, first.timeMs, front.front(), front.front()};
  std::size_t right = 1;
  while (points[front[right]].error.value > error) ++right;
  const Segment s = segmentOf(points[front[right - 1]], points[front[right]]);
  const double w = (std::log(error) - s.y1) / (s.y2 - s.y1);
  const double slope = (s.x2 - s.x1) / (s.y2 - s.y1);
  const double value = std::exp((1.0 - w) * s.x1 + w * s.x2);
  const double u = std::hypot(std::hypot((1.0 - w) * s.ux1, w * s.ux2),
                              throughSlope(slope, (1.0 - w) * s.uy1 + w * s.uy2, s.x2 - s.x1));
  return {Reach::interpolated, {value, value * u, s.enoughRepeats}, front[right - 1], front[right]};
}

std::vector<double> roundNumbers(double low, double high) {
  constexpr std::size_t kEnough = 3;
  constexpr double kSame = 1.005;  // values in a narrower range are not worth distinguishing
  std::vector<double> result;
  if (!(low > 0.0) || !(high >= kSame * low) || !std::isfinite(high)) return result;
  const auto scaled = [](double digits, int decade) {
    return decade < 0 ? digits / std::pow(10.0, -decade) : digits * std::pow(10.0, decade);
  };
  const auto decadeOf = [](double number) { return static_cast<int>(std::floor(std::log10(number))); };
  for (const std::vector<double>& digits :
       {std::vector<double>{1.0, 2.0, 5.0}, std::vector<double>{1.0, 1.5, 2.0, 3.0, 5.0, 7.0}}) {
    result.clear();
    for (int decade = decadeOf(low); decade <= decadeOf(high); ++decade)
      for (const double digit : digits)
        if (const double number = scaled(digit, decade); number >= low && number <= high)
          result.push_back(number);
    if (result.size() >= kEnough) return result;
  }
  // In a narrow range: multiples of a round step.
  for (int decade = decadeOf(high - low); result.size() < kEnough; --decade)
    for (const double digit : {5.0, 2.0, 1.0}) {
      if (result.size() >= kEnough) break;
      result.clear();
      const double step = scaled(digit, decade);
      for (double multiple = std::ceil(low / step); multiple * step <= high; multiple += 1.0)
        result.push_back(multiple * step);
    }
  return result;
}

}  // namespace lumivox
