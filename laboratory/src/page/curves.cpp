// The curves of a figure as CSV and as a drawing.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lumivox/page/reproduction_page.h"
#include "page/markup.h"

namespace lumivox {
namespace {

using namespace page;

/// Size and margins of the drawing of one curve, pixels.
constexpr double kWidth = 420, kHeight = 320, kLeft = 64, kRight = 16, kTop = 44, kBottom = 48;

std::string csvText(const std::string& text) {
  return '"' + replaced(text, "\"", "\"\"") + '"';
}

std::string csvNumber(double value) {
  return std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string();
}

/// From a number to a place along an axis, both logarithmic; with a little space at both ends.
class LogarithmicAxis {
 public:
  LogarithmicAxis(double low, double high, double from, double to) : from_(from), to_(to) {
    constexpr double kSpace = 1.25;
    low_ = std::log(low / kSpace);
    high_ = std::log(high * kSpace);
  }
  double operator()(double value) const {
    return from_ + (std::log(value) - low_) / (high_ - low_) * (to_ - from_);
  }
  /// 1, 2 and 5 times the powers of ten that lie on it.
  std::vector<double> ticks() const {
    std::vector<double> result;
    for (int power = static_cast<int>(std::floor(low_ / std::log(10.0)));
         power <= static_cast<int>(std::ceil(high_ / std::log(10.0))); ++power)
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double value = digit * std::pow(10.0, power);
        if (std::log(value) >= low_ && std::log(value) <= high_) result.push_back(value);
      }
    return result;
  }

 private:
  double low_, high_, from_, to_;
};

std::string text(double x, double y, const char* anchor, const std::string& what) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     escaped(what));
}

std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1, x2, y2,
                     style);
}

std::string drawing(const MeasuredCurve& curve, const JudgedCurve& judged) {
  std::string svg = text(kWidth / 2, 16, "middle", curve.name) +
                    text(kWidth / 2, 32, "middle", curveText(curve, judged)) +
                    text(kWidth / 2, kHeight - 8, "middle", curve.over);
  std::vector<const MeasuredPoint*> points;
  for (const MeasuredPoint& point : curve.points)
    if (point.measured && point.measured->lowerQuartile > 0.0 && point.x > 0.0) points.push_back(&point);
  if (points.empty()) return svg + text(kWidth / 2, kHeight / 2, "middle", "nothing was measured");
  double lowX = points[0]->x, highX = lowX, lowY = points[0]->measured->lowerQuartile, highY = lowY;
  for (const MeasuredPoint* point : points) {
    lowX = std::min(lowX, point->x);
    highX = std::max(highX, point->x);
    lowY = std::min(lowY, point->measured->lowerQuartile);
    highY = std::max(highY, point->measured->upperQuartile);
  }
  const LogarithmicAxis x(lowX, highX, kLeft, kWidth - kRight), y(lowY, highY, kHeight - kBottom, kTop);
  for (const double tick : x.ticks())
    svg += line(x(tick), kTop, x(tick), kHeight - kBottom, "stroke=\"#ddd\"") +
           text(x(tick), kHeight - kBottom + 16, "middle", fmt::format("{:g}", tick));
  for (const double tick : y.ticks())
    svg += line(kLeft, y(tick), kWidth - kRight, y(tick), "stroke=\"#ddd\"") +
           text(kLeft - 6, y(tick) + 4, "end", fmt::format("{:g}", tick));
  const bool isTime =
      curve.quantity == PublishedQuantity::time || curve.quantity == PublishedQuantity::frameRate;
  svg += text(kLeft, kTop - 4, "start",
              isTime ? "ms" : fmt::format("{} {}", name(curve.quantity), unit(curve.quantity)));
  // Growth in proportion, from the first point as far as the drawing goes.
  const MeasuredPoint& first = *points.front();
  const double reach = std::min(highX / first.x, highY / first.measured->median);
  if (reach > 1.0)
    svg += line(x(first.x), y(first.measured->median), x(first.x * reach), y(first.measured->median * reach),
                "stroke=\"#888\" stroke-dasharray=\"4 4\"");
  std::string path;
  for (const MeasuredPoint* point : points) {
    const TimingStatistics& time = *point->measured;
    path += fmt::format("{}{:.1f} {:.1f} ", path.empty() ? "M" : "L", x(point->x), y(time.median));
    svg += line(x(point->x), y(time.lowerQuartile), x(point->x), y(time.upperQuartile),
                "stroke=\"#1f5fa8\" stroke-width=\"2\"") +
           fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"#1f5fa8\"/>\n", x(point->x),
                       y(time.median));
  }
  return svg + fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#1f5fa8\"/>\n", path);
}

}  // namespace

std::string curvesAsCsv(const ReproducedResult& result) {
  std::string csv = "curve,over,x,measures,unit,median,lower_quartile,upper_quartile,repeats,why_not\n";
  for (const MeasuredCurve& curve : result.curves)
    for (const MeasuredPoint& point : curve.points) {
      // Rates are measured, and kept, as times of frames.
      const bool isRate = curve.quantity == PublishedQuantity::frameRate;
      const TimingStatistics time = point.measured.value_or(TimingStatistics{});
      const auto cell = [&](double value) { return point.measured ? csvNumber(value) : std::string(); };
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csvText(curve.name), curve.over,
                         csvNumber(point.x), name(curve.quantity), isRate ? "ms" : unit(curve.quantity),
                         cell(time.median), cell(time.lowerQuartile), cell(time.upperQuartile), time.repeats,
                         csvText(point.whyNot));
    }
  return csv;
}

std::string curvesAsSvg(const ReproducedResult& result) {
  const double width = kWidth * static_cast<double>(result.curves.size());
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
      width, kHeight);
  for (std::size_t i = 0; i < result.curves.size(); ++i)
    svg += fmt::format("<g transform=\"translate({} 0)\">\n{}</g>\n", kWidth * static_cast<double>(i),
                       drawing(result.curves[i], result.judgedCurves[i]));
  return svg + "</svg>\n";
}

}  // namespace lumivox
