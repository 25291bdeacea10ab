#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// The particles of all media of the scene that have some, in the order of the scene (scene/medium.h). Twelve
/// bytes each, so that as many as a scene may have fit into one block of the size that every device has (128
/// MiB).
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
              "three floats a particle: x, y and z of its position relative to the medium's source, m"}}};
  }
  static void contents(const Particles& port, PortContents& contents) {
    for (const Particles::Group& group : port.groups) contents.buffer("offsets", group.offsets);
  }
};

}  // namespace lumivox
