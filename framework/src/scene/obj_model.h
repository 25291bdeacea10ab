// Models of OBJ and MTL files.
#pragma once

#include "scene/model.h"

namespace lumivox {

/// Reads one OBJ file, or the frames of a sequence, which must have the same faces. Everything that is read
/// goes into `hasher`.
Model loadObjModel(const std::vector<std::filesystem::path>& frames, const ModelOptions& options,
                   Hasher& hasher);

/// The line of an MTL file in which the material names its image by `statement` ("map_Kd"); 0 when it does
/// not.
int lineOfMap(const ModelMaterial& material, const std::string& statement);

}  // namespace lumivox
