// Ranges of materials and lights, for texts and for material files alike.
#pragma once

namespace lumivox {

/// Radiance, irradiance and intensity in SI units: products of two still fit into single precision. The sun's
/// radiance is 2e7.
inline constexpr double kMostLight = 1e15;
/// Beyond it Phong lobes are narrower than single precision resolves: cos^n of one ulp below 1 is already
/// exp(-n 6e-8).
inline constexpr double kLargestExponent = 1e6;
/// Limit of Kd, Ks, d and Tr in material files, which are used as given: far above 1, but small enough that
/// the light of a few bounces stays finite.
inline constexpr double kLargestGivenAlbedo = 1e3;

}  // namespace lumivox
