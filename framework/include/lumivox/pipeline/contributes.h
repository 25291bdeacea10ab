// Components of the image, which outputs of passes hold and references are made of, and levels of grids: what
// two ports of one kind may still differ in.
#pragma once

#include <optional>

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

/// The levels of a grid with mips that an output fills, or that an input reads.
enum class Levels { unspecified, finest, all };

/// An input's expectation of the output behind it, beyond its kind. Another output is a warning: the light
/// would be wrong.
struct Expects {
  std::optional<Contributes>
      component;  ///< the one that it holds; nothing: none, a transmittance for instance
  Levels levels = Levels::unspecified;  ///< all: each must be filled

  Expects() = default;
  Expects(Contributes held)
      : component(held) {}                    // NOLINT: a member of a pass says only `Contributes::direct`
  Expects(Levels filled) : levels(filled) {}  // NOLINT: or `Levels::all`
};

}  // namespace lumivox
