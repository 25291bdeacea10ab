#pragma once

#include "lumivox/pipeline/port.h"

namespace lumivox {

/// An image-sized result. rgba16f or rgba32f: radiance in W/(sr m^2) in rgb; ambient occlusion in r.
struct Image {
  gpu::TextureRef texture;
  /// False: fractions, counts or colour codes; they are displayed without exposure.
  bool radiance = true;
};

template <>
struct PortTraits<Image> {
  static PortKind kind() {
    return {"Image",
            "an image-sized result",
            {{"texture", "d2 rgba16f or rgba32f", "radiance in W/(sr m^2) in rgb; ambient occlusion in r"}},
            {},
            {},
            {{"radiance", "false: fractions, counts or colour codes instead of light",
              "they are exposed like light", "that show it"}}};
  }
  static void contents(const Image& port, PortContents& contents) {
    contents.texture("texture", port.texture);
  }
};

}  // namespace lumivox
