// Equal time and equal error: interpolation between measured points of a pipeline, with uncertainties. Pure
// functions.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "lumivox/measure/metrics.h"

namespace lumivox {

/// One measured point of a pipeline, both numbers with one standard uncertainty.
struct TradeOff {
  Measured timeMs;
  Measured error;
};

/// Indices of the points that no other beats by its values alone, by time; of equal ones the first. Their
/// errors fall strictly. Points whose time or error is not above 0 are passed over: they have no logarithm.
std::vector<std::size_t> frontByValue(const std::vector<TradeOff>& points);

/// A difference counts as significant beyond this many standard uncertainties of it.
inline constexpr double kSignificantSigmas = 3.0;
/// For times, also beyond this share, or beyond the difference of repeated controls if that is more
/// (TimeFloor): quartiles of a few repeats do not show slow changes of the machine.
inline constexpr double kSignificantTimeShare = 0.05;

/// Whether both have the repeats that any claim about their difference needs.
bool decidable(const Measured& a, const Measured& b);
/// Whether a and b differ by more than kSignificantSigmas standard uncertainties of their difference, and by
/// more than `leastShare` of `a`. False when that is undecided: decidable().
bool differ(const Measured& a, const Measured& b, double leastShare = 0.0);
/// |a - b| over the standard uncertainty of the difference; infinite when that is 0 and they differ.
double sigmasApart(const Measured& a, const Measured& b);

/// The rule of all fronts: a is no slower and has no more error than b, and in one of the two it is better
/// by more than the uncertainty (differ(); for times by `timeShare` too). Points within their uncertainties
/// do not beat each other.
bool beats(const TradeOff& a, const TradeOff& b, double timeShare = kSignificantTimeShare);
/// For each point the one that beats it: of those the one with the least error. None: it is on the Pareto
/// front.
std::vector<std::optional<std::size_t>> beatenBy(const std::vector<TradeOff>& points,
                                                 double timeShare = kSignificantTimeShare);

/// Of `candidates`, indices into `points`, the one with the least of a number by value; of equal ones the
/// first. None: there is no candidate.
std::optional<std::size_t> leastOf(const std::vector<TradeOff>& points,
                                   const std::vector<std::size_t>& candidates, Measured TradeOff::*number);
/// The choice where one number has a limit and the other, `number`, is to be least: among the candidates
/// within the uncertainty of the least (decidable() and not differ(), for times by `timeShare` too), the one
/// with the least of the limited number.
std::optional<std::size_t> leastWithinNoise(const std::vector<TradeOff>& points,
                                            const std::vector<std::size_t>& candidates,
                                            Measured TradeOff::*number,
                                            double timeShare = kSignificantTimeShare);

enum class Reach {
  interpolated,  ///< between two measured points, or at one
  atMost,        ///< the last measured point has this much already: less is not measured
  notReached,    ///< every measured point takes longer, or has more error
  notMeasured    ///< there is no point
};
const char* name(Reach reach);  ///< "not_reached"

struct Interpolated {
  Reach reach = Reach::notMeasured;
  Measured value;                ///< ms or error; with notReached that of the nearest measured point
  std::size_t from = 0, to = 0;  ///< the measured points on both sides, indices into `points`
};

/// The error at a time. `front` are indices from frontByValue(). Between two of its points (t1, e1), (t2, e2)
/// the logarithm of the error is linear in that of the time, exact on power laws; beyond them nothing is
/// extrapolated. With w = ln(T/t1) / ln(t2/t1), the slope s = ln(e2/e1) / ln(t2/t1) and relative
/// uncertainties u, to first order:
///   u^2 = ((1-w) u_e1 + w u_e2)^2 + s^2 ((1-w)^2 u_t1^2 + w^2 u_t2^2).
/// Errors add linearly, since the two may share the reference's noise and then err together: the safe side.
/// The second term is at most ln(e2/e1)^2: a segment shorter than its times are sure says no more than its
/// ends.
Interpolated errorAtTime(const std::vector<TradeOff>& points, const std::vector<std::size_t>& front,
                         double timeMs);
/// The time at an error: the same segment read the other way, with 1/s in place of s:
///   u^2 = (1-w)^2 u_t1^2 + w^2 u_t2^2 + ((1-w) u_e1 + w u_e2)^2 / s^2,  w = ln(E/e1) / ln(e2/e1).
Interpolated timeAtError(const std::vector<TradeOff>& points, const std::vector<std::size_t>& front,
                         double error);

/// Round numbers within [low, high]: 1, 2, 5 times powers of ten; 1, 1.5, 2, 3, 5, 7 where those would be
/// fewer than three; else the multiples of a round step. Empty when low is not above 0, or high not 0.5 %
/// above it.
std::vector<double> roundNumbers(double low, double high);

}  // namespace lumivox
