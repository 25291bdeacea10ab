// Components of the image, which outputs of passes hold and references are made of.
#pragma once

namespace lumivox {

/// The component of the image that an output holds; decides which reference it is judged against.
enum class Contributes {
  nothing,
  direct,
  indirectDiffuse,
  indirectGlossy,
  ambientOcclusion,
  scattered,
  final
};
const char* name(Contributes component);  ///< "direct", "indirect_diffuse", ...
/// The value of an output where nothing is computed: 1 (nothing is occluded) for ambient occlusion,
/// else 0 (black).
float neutralElement(Contributes component);
int channelsOf(Contributes component);  ///< of its images: 1 for ambient occlusion, else 3

}  // namespace lumivox
