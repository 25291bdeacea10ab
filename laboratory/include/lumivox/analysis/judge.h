// When a published table, curve or claim about images counts as reproduced.
#pragma once

#include <vector>

#include "lumivox/results/reproduction.h"

namespace lumivox {

/// A ratio is reproduced within this factor of the published one, upwards and downwards.
inline constexpr double kReproducedFactor = 1.5;
/// A measured ratio reaches this many of its standard uncertainties to both sides (95 % of a normal
/// distribution).
inline constexpr double kReproducedSigmas = 2.0;

/// The rule. Times and frame rates are divided by the first row of either that is comparable, fragments and
/// memory by the first of their own; a row that says so by the row that it names. A table is reproduced when
/// at least one row is, none is not, and no two comparable rows are in another order than published by
/// more than their uncertainty.
JudgedTable judge(const std::vector<MeasuredRow>& rows);

/// A curve follows x^p; p reaches so many of its standard uncertainties to both sides as a ratio does.
/// Sublinear is reproduced when all of that lies below 1, superlinear when above, and not when all of it lies
/// on the other side. Linear: when from the first point to the last the curve grows as x does within the
/// factor of ratios.
JudgedCurve judgeGrowth(const MeasuredCurve& curve);

/// A claim is reproduced when the panel that is to have less has less than the other one, so many times; not
/// comparable when a panel is missing or a stand-in. Images have no uncertainty that is known.
JudgedClaim judgeClaim(const MeasuredClaim& claim);

/// The results with every row, table, curve and claim judged anew.
std::vector<ReproducedResult> judged(std::vector<ReproducedResult> results);

}  // namespace lumivox
