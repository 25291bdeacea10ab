// Models of glTF 2.0 files, .gltf and .glb.
#pragma once

#include "scene/model.h"

namespace lumivox {

/// Reads one file: an object for each node with a mesh, under the node's name. Y is up and lengths are metres
/// already. Materials without one are grey.
Model loadGltfModel(const std::filesystem::path& file, const ModelOptions& options, Hasher& hasher);

}  // namespace lumivox
