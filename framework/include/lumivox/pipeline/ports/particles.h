#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// The particles of all media of the scene that have some, in the order of the scene (scene/medium.h).
struct Particles {
  struct Group {
    int medium = 0;  ///< index into Scene::media
    int count = 0;   ///< of particles
    gpu::BufferRef offsets;
  };
  std::vector<Group> groups;
};

template <>
struct PortTraits<Particles> {
  static PortKind kind() {
    return {"Particles",
            "the particles of all media of the scene that have some",
            {{"offsets", "buffer, for each medium",
              "vec4 a particle: xyz position relative to the medium's source, m; w age, s"}}};
  }
  static void contents(const Particles& port, PortContents& contents) {
    for (const Particles::Group& group : port.groups) contents.buffer("offsets", group.offsets);
  }
};

}  // namespace lumivox
