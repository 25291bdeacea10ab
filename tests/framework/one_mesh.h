// A scene of one mesh and an image, written for a test.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "framework/one_model.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/scene/scene.h"
#include "support/support.h"

namespace lumivox::test {

inline const char* const kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A cube of side 2 about the origin, without normals, out of six quads.
inline const char* const kCube =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";

/// A scene with one mesh `m` of `m.obj`.
struct OneMesh : OneModel {
  explicit OneMesh(const std::string& obj, const std::string& mesh = "", const std::string& more = "")
      : OneModel("m.obj", obj, mesh, more) {}
};

/// The scene, with everything that was logged while it was loaded.
inline std::pair<Scene, std::string> loadLogged(const OneMesh& mesh) {
  return mesh.logged();
}

/// An uncompressed TGA file, top row first; `channels` of 3 (RGB) or 4 (RGBA) or 1.
inline std::string tga(int width, int height, int channels, const std::vector<unsigned char>& values) {
  std::string file(18, '\0');
  file[2] = channels == 1 ? 3 : 2;
  file[12] = static_cast<char>(width);
  file[14] = static_cast<char>(height);
  file[16] = static_cast<char>(8 * channels);
  file[17] = static_cast<char>(0x20 | (channels == 4 ? 8 : 0));
  for (std::size_t i = 0; i < values.size(); i += static_cast<std::size_t>(channels)) {
    if (channels >= 3) {  // stored as BGR(A)
      file += static_cast<char>(values[i + 2]);
      file += static_cast<char>(values[i + 1]);
      file += static_cast<char>(values[i]);
      if (channels == 4) file += static_cast<char>(values[i + 3]);
    } else {
      file += static_cast<char>(values[i]);
    }
  }
  return file;
}

}  // namespace lumivox::test
