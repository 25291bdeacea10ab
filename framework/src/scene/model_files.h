// What the loader of scenes does with the cameras and the images of model files.
#pragma once

#include "scene/model.h"

namespace lumivox {

/// Gives `camera` the place, the motion and the angle of view of a model's camera, which `placement` puts
/// into the world. Of a moving camera the direction that is up is that at the start.
void placeLike(const ModelCamera& source, const glm::dmat4& placement, Camera& camera);

/// DiagnosticsError at the line of an MTL file if the image that it names by `statement` ("map_Kd") is not
/// there or has a format that cannot be read.
void requireImage(const ModelMaterial& material, const char* statement, const ModelImage& image);

}  // namespace lumivox
