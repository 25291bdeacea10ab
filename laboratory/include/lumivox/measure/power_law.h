// How fast a number falls or grows with a parameter.
#pragma once

#include <vector>

#include "lumivox/measure/metrics.h"

namespace lumivox {

struct PowerLawPoint {
  double x = 0.0;  ///< above 0
  Measured y;      ///< above 0
};

/// y = c x^slope, and y = plateau + c x^slopeAbove: what stays however large x becomes (or, for a slope above
/// 0, however small).
struct PowerLaw {
  Measured slope;       ///< NaN for fewer than three different x
  double factor = 0.0;  ///< c of the first law
  /// NaN for fewer than four different x and where the data do not tell one; 0 when they are best without.
  Measured plateau;
  double slopeAbove = 0.0;  ///< NaN where plateau is
  std::size_t points = 0;
  /// A plateau that is there: more than twice its uncertainty.
  bool hasPlateau() const { return plateau.value > 2.0 * plateau.uncertainty && plateau.value > 0.0; }
};

/// Least squares of log y on log x, weighted by the uncertainties of y where all have one. The uncertainty of
/// the slope is propagated from those, or follows from the scatter about the line where that is larger. The
/// plateau: least squares of y itself, each relative to its uncertainty (to y where there is none), over all
/// slopes of the sign of the first law's. Points whose x or y are not above 0 are left out.
PowerLaw fitPowerLaw(std::vector<PowerLawPoint> points);

}  // namespace lumivox
