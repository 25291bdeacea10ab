#include "lumivox/measure/power_law.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <set>

#include "measure/pixels.h"

namespace lumivox {
namespace {

constexpr double kFlattest = 0.05, kSteepest = 8.0;  // range of slopes above a plateau

/// Straight line through (u, v) with weights: least squares (Press et al. 2007, Numerical Recipes,
/// Sec. 15.2).
struct Line {
  double slope = 0.0, offset = 0.0;
  double slopeVariance = 0.0;  ///< if weights are inverse variances
  double squares = 0.0;        ///< weighted sum of the squared residuals
};

Line lineThrough(const std::vector<double>& u, const std::vector<double>& v,
                 const std::vector<double>& weight) {
  double sum = 0.0, sumU = 0.0, sumV = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    sum += weight[i];
    sumU += weight[i] * u[i];
    sumV += weight[i] * v[i];
  }
  const double meanU = sumU / sum, meanV = sumV / sum;
  double uu = 0.0, uv = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    uu += weight[i] * (u[i] - meanU) * (u[i] - meanU);
    uv += weight[i] * (u[i] - meanU) * (v[i] - meanV);
  }
  Line line{uv / uu, meanV - uv / uu * meanU, 1.0 / uu, 0.0};
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double residual = v[i] - line.offset - line.slope * u[i];
    line.squares += weight[i] * residual * residual;
  }
  return line;
}

/// The uncertainty from `variance`, or from the scatter if that is larger.
double uncertaintyOf(double variance, double squares, double freedom, bool weighted) {
  const double scatter = freedom > 0.0 ? squares / freedom : 0.0;
  return std::sqrt(variance * (weighted ? std::max(1.0, scatter) : scatter));
}

/// Fits y = plateau + c x^slope for a given slope: a line in x^slope.
struct PlateauFit {
  double slope = 0.0, plateau = 0.0, factor = 0.0, squares = std::numeric_limits<double>::infinity();
};

PlateauFit plateauAt(double slope, const std::vector<PowerLawPoint>& points,
                     const std::vector<double>& weight) {
  std::vector<double> u, v;
  double uu = 0.0, uv = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    u.push_back(std::pow(points[i].x, slope));
    v.push_back(points[i].y.value);
    uu += weight[i] * u[i] * u[i];
    uv += weight[i] * u[i] * v[i];
  }
  const Line line = lineThrough(u, v, weight);
  if (line.offset >= 0.0) return {slope, line.offset, line.slope, line.squares};
  PlateauFit without{slope, 0.0, uv / uu, 0.0};  // nothing lies below 0
  for (std::size_t i = 0; i < points.size(); ++i)
    without.squares += weight[i] * (v[i] - without.factor * u[i]) * (v[i] - without.factor * u[i]);
  return without;
}

/// The best fit over all slopes of one sign: a scan, then golden section search around its best.
PlateauFit bestPlateau(const std::vector<PowerLawPoint>& points, const std::vector<double>& weight,
                       double sign) {
  constexpr int kSteps = 200;
  const auto slopeAt = [&](double step) {
    return sign * kFlattest * std::pow(kSteepest / kFlattest, step / kSteps);
  };
  PlateauFit best;
  int at = 0;
  for (int step = 0; step <= kSteps; ++step) {
    const PlateauFit fit = plateauAt(slopeAt(step), points, weight);
    if (fit.squares < best.squares) best = fit, at = step;
  }
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = std::max(at - 1, 0), high = std::min(at + 1, kSteps);
  for (int i = 0; i < 80; ++i) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    if (plateauAt(slopeAt(a), points, weight).squares < plateauAt(slopeAt(b), points, weight).squares)
      high = b;
    else
      low = a;
  }
  const PlateauFit refined = plateauAt(slopeAt(0.5 * (low + high)), points, weight);
  return refined.squares < best.squares ? refined : best;
}

/// Variance of the plateau from the linearised problem in (plateau, factor, slope).
double plateauVariance(const PlateauFit& fit, const std::vector<PowerLawPoint>& points,
                       const std::vector<double>& weight) {
  glm::dmat3 normal(0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double power = std::pow(points[i].x, fit.slope);
    const glm::dvec3 gradient(1.0, power, fit.factor * power * std::log(points[i].x));
    normal += weight[i] * glm::outerProduct(gradient, gradient);
  }
  return glm::inverse(normal)[0][0];
}

}  // namespace

PowerLaw fitPowerLaw(std::vector<PowerLawPoint> points) {
  std::erase_if(points, [](const PowerLawPoint& p) { return !(p.x > 0.0 && p.y.value > 0.0); });
  PowerLaw law{{kNan, 0.0}, kNan, {kNan, 0.0}, kNan, points.size()};
  std::set<double> different;
  bool weighted = true;
  for (const PowerLawPoint& p : points) {
    different.insert(p.x);
    weighted = weighted && p.y.uncertainty > 0.0;
  }
  if (different.size() < 3) return law;
  std::vector<double> u, v, weight;
  for (const PowerLawPoint& p : points) {
    u.push_back(std::log(p.x));
    v.push_back(std::log(p.y.value));
    const double relative = p.y.value / p.y.uncertainty;
    weight.push_back(weighted ? relative * relative : 1.0);
  }
  const auto n = static_cast<double>(points.size());
  const Line line = lineThrough(u, v, weight);
  law.slope = {line.slope, uncertaintyOf(line.slopeVariance, line.squares, n - 2.0, weighted)};
  law.factor = std::exp(line.offset);
  if (different.size() < 4 || line.slope == 0.0) return law;

  for (std::size_t i = 0; i < points.size(); ++i) weight[i] /= points[i].y.value * points[i].y.value;
  const PlateauFit fit = bestPlateau(points, weight, line.slope > 0.0 ? 1.0 : -1.0);
  // A slope at an end of the search range means that the data determine none.
  constexpr double kNear = 1.01;
  if (std::abs(fit.slope) < kNear * kFlattest || std::abs(fit.slope) > kSteepest / kNear) return law;
  const double variance = plateauVariance(fit, points, weight);
  law.plateau = {fit.plateau, std::isfinite(variance) && variance > 0.0
                                  ? uncertaintyOf(variance, fit.squares, n - 3.0, weighted)
                                  : fit.plateau};
  law.slopeAbove = fit.slope;
  return law;
}

}  // namespace lumivox
