// Files of captures that tests write by hand: folders of the TUM layout, and .sens files.
#pragma once

#include <fmt/format.h>
#include <zlib.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/scene/scene.h"
#include "lumivox/scene/text.h"
#include "support/support.h"

namespace lumivox::test {

/// 4 x 3 pixels, each depth and colour of its own.
inline WordImage depthImage(std::uint16_t first = 5000) {
  WordImage image{4, 3, {}};
  for (std::uint16_t i = 0; i < 12; ++i) image.values.push_back(static_cast<std::uint16_t>(first + 100 * i));
  return image;
}
inline ByteImage colourImage(int width = 4, int height = 3) {
  ByteImage image{width, height, 3, {}};
  for (int i = 0; i < 3 * width * height; ++i)
    image.values.push_back(static_cast<unsigned char>(i * 7 % 256));
  return image;
}

inline constexpr const char* kPinhole = "focal 4 4  centre 1.5 1";

/// A scene text with one capture, beside the files of the folder "c".
struct CaptureFiles {
  TemporaryDirectory directory;

  void image(const std::string& name, const WordImage& depth) const {
    create(name);
    writeGreyPng16(directory.path() / name, depth);
  }
  void image(const std::string& name, const ByteImage& colour) const {
    create(name);
    writeBytePng(directory.path() / name, colour);
  }
  void text(const std::string& name, const std::string& content) const { directory.write(name, content); }
  void create(const std::string& name) const {
    std::filesystem::create_directories((directory.path() / name).parent_path());
  }

  Scene load(const std::string& capture = std::string("folder \"c\" ") + kPinhole,
             const std::string& camera = "capture c") const {
    return loadSceneText(
        fmt::format("scene \"s\" {{ capture c {{ {} }}\n camera main {{ {} }} }}", capture, camera),
        directory.path() / "s.scene");
  }
  std::string refusal(const std::string& capture = std::string("folder \"c\" ") + kPinhole) const {
    try {
      load(capture);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing was refused";
  }
};

/// Two frames in the TUM layout, 0.1 s apart.
inline CaptureFiles tum(const std::string& associations, const std::string& poses) {
  CaptureFiles files;
  for (const char* name : {"1.0", "1.1"}) {
    files.image(fmt::format("c/rgb/{}.png", name), colourImage());
    files.image(fmt::format("c/depth/{}.png", name), depthImage());
  }
  files.text("c/associations.txt", associations);
  files.text("c/groundtruth.txt", poses);
  return files;
}

inline constexpr const char* kPairs =
    "1.0 rgb/1.0.png 1.0 depth/1.0.png\n1.1 rgb/1.1.png 1.1 depth/1.1.png\n";
inline constexpr const char* kTwoPoses =
    "1.0 1 2 3 0 0 0 1\n1.1 2 2 3 0 0 0.7071067811865476 0.7071067811865476\n";

inline const Capture& only(const Scene& scene) {
  REQUIRE(scene.captures.size() == 1);
  return *scene.captures.front();
}

inline std::string matrixText(const glm::dquat& rotation, const glm::dvec3& eye) {
  const glm::dmat3 m = glm::mat3_cast(rotation);
  std::string text;
  for (int row = 0; row < 3; ++row)
    text += fmt::format("{:.17g} {:.17g} {:.17g} {:.17g}\n", m[0][row], m[1][row], m[2][row], eye[row]);
  return text + "0 0 0 1\n";
}

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
inline void putMatrix(std::string& bytes, const glm::dmat4& matrix) {
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) put(bytes, static_cast<float>(matrix[column][row]));
}
inline glm::dmat4 intrinsics(double focal, double cx, double cy) {
  glm::dmat4 matrix(1.0);
  matrix[0][0] = matrix[1][1] = focal;
  matrix[2][0] = cx, matrix[2][1] = cy;
  return matrix;
}

/// A .sens file; its defaults are a good one of two frames.
struct Sens {
  std::uint32_t version = 4;
  std::int32_t colourKind = 1, depthKind = 1;
  std::uint64_t claimed = 2;            ///< frames
  std::uint32_t width = 4, height = 3;  ///< of depth, as the header says
  double focal = 4.0, centre = 1.5;     ///< of depth, along x
  float shift = 1000.0f;                ///< units of depth in a metre
  glm::dmat4 colourPose{1.0};
  std::vector<glm::dmat4> poses{glm::dmat4(1.0), glm::dmat4(1.0)};
  WordImage depth = depthImage(1000);
  std::string colour;  ///< bytes of a PNG of 8 x 6

  std::string bytes() const {
    std::string result;
    put(result, version);
    put(result, std::uint64_t{4});
    result += "name";
    putMatrix(result, intrinsics(8, 3.5, 2.5));
    putMatrix(result, colourPose);
    putMatrix(result, intrinsics(focal, centre, 1));
    putMatrix(result, glm::dmat4(1.0));
    put(result, colourKind);
    put(result, depthKind);
    for (const std::uint32_t side : {8u, 6u, width, height}) put(result, side);
    put(result, shift);
    put(result, claimed);
    std::vector<Bytef> packed(compressBound(24));
    uLongf size = static_cast<uLongf>(packed.size());
    compress(packed.data(), &size, reinterpret_cast<const Bytef*>(depth.values.data()), 24);
    for (const glm::dmat4& pose : poses) {
      putMatrix(result, pose);
      put(result, std::uint64_t{11});
      put(result, std::uint64_t{12});
      put(result, std::uint64_t{colour.size()});
      put(result, std::uint64_t{size});
      result += colour;
      result.append(reinterpret_cast<const char*>(packed.data()), size);
    }
    return result;
  }
};

inline Sens sens() {
  Sens made;
  TemporaryDirectory directory;
  writeBytePng(directory.path() / "c.png", colourImage(8, 6));
  made.colour = readFile(directory.path() / "c.png");
  return made;
}

/// A folder that holds room.sens.
inline CaptureFiles withSens(const std::string& bytes) {
  CaptureFiles files;
  files.text("room.sens", bytes);
  return files;
}

inline constexpr const char* kSens = "file \"room.sens\" rate 10";

}  // namespace lumivox::test
