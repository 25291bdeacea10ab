// Reads what moves: blocks `animate`, and the keys of cameras.
#pragma once

#include "lumivox/dsl/schema.h"
#include "scene/block_reader.h"
#include "scene/description.h"

namespace lumivox {

/// What the name of an `animate` block names.
enum class AnimationTarget { nothing, mesh, light, camera };

/// Refuses a view without a direction: eye and target in one point, or a look along `up`.
void checkView(BlockReader& reader, const dsl::Block& block, const glm::dvec3& eye, const glm::dvec3& target,
               const glm::dvec3& up);

/// Reads `interpolation` and the keys in a block into a camera whose own view is read. What no key sets is
/// the camera's own.
void readCameraKeys(BlockReader& reader, const dsl::CheckedBlock& block,
                    const dsl::BlockSpecification& keyGrammar, Camera& camera);

/// Adds an `animate` block to its light or camera in the description, or to the animations of meshes. Lights
/// and cameras that the text's findings left out of the description are passed over.
void describeAnimation(BlockReader& reader, const dsl::CheckedBlock& block,
                       const dsl::BlockSpecification& keyGrammar, AnimationTarget target,
                       SceneDescription& description);

}  // namespace lumivox
