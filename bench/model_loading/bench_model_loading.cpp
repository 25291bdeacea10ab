// Loading a model of a million triangles from .glb and from binary PLY, beside reading its bytes and building
// the same arrays by hand; and Crytek Sponza's OBJ where it is. Medians and quartiles in s.
// usage: bench_model_loading [--quick | REPEATS] (default: 15), from the project's folder. --quick: a small
// model, whose figures mean nothing, for the tests. Exit code 1: the arrays differ.
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "../spread.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "scene/model.h"

namespace {

using namespace lumivox;
namespace fs = std::filesystem;

struct Arrays {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> texcoords;
  std::vector<std::uint32_t> indices;
};

/// A wavy sheet of side x side quads.
Arrays sheetOf(std::uint32_t side) {
  Arrays sheet;
  for (std::uint32_t j = 0; j <= side; ++j) {
    for (std::uint32_t i = 0; i <= side; ++i) {
      const glm::vec2 place(static_cast<float>(i) / static_cast<float>(side),
                            static_cast<float>(j) / static_cast<float>(side));
      const float slope = std::cos(40.0f * place.x);
      sheet.positions.emplace_back(place.x, std::sin(40.0f * place.x) / 40.0f, place.y);
      sheet.normals.push_back(glm::normalize(glm::vec3(-slope, 1.0f, 0.0f)));
      sheet.texcoords.push_back(place);
      if (i == side || j == side) continue;
      const std::uint32_t a = j * (side + 1) + i, b = a + side + 1;
      for (const std::uint32_t corner : {a, b, a + 1, a + 1, b, b + 1}) sheet.indices.push_back(corner);
    }
  }
  return sheet;
}

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
std::string number(std::size_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  return {reinterpret_cast<const char*>(&bits), 4};
}

std::string glbOf(const Arrays& sheet) {
  const std::string binary =
      bytesOf(sheet.positions) + bytesOf(sheet.normals) + bytesOf(sheet.texcoords) + bytesOf(sheet.indices);
  std::string views, accessors;
  std::size_t offset = 0;
  const auto add = [&](std::size_t bytes, int component, std::size_t count, const char* type) {
    views += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}}})", offset > 0 ? "," : "", offset,
                         bytes);
    accessors += fmt::format(R"({}{{"bufferView":{},"componentType":{},"count":{},"type":"{}"}})",
                             offset > 0 ? "," : "", std::count(views.begin(), views.end(), '{') - 1,
                             component, count, type);
    offset += bytes;
  };
  const std::size_t vertices = sheet.positions.size();
  add(12 * vertices, 5126, vertices, "VEC3");
  add(12 * vertices, 5126, vertices, "VEC3");
  add(8 * vertices, 5126, vertices, "VEC2");
  add(4 * sheet.indices.size(), 5125, sheet.indices.size(), "SCALAR");
  std::string json = fmt::format(
      R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{}}}],"bufferViews":[{}],"accessors":[{}],)"
      R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"NORMAL":1,)"
      R"("TEXCOORD_0":2}},"indices":3}}]}}]}})",
      binary.size(), views, accessors);
  while (json.size() % 4 != 0) json += ' ';
  return "glTF" + number(2) + number(28 + json.size() + binary.size()) + number(json.size()) + "JSON" + json +
         number(binary.size()) + std::string("BIN\0", 4) + binary;
}

std::string plyOf(const Arrays& sheet) {
  std::string file = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      sheet.positions.size(), sheet.indices.size() / 3);
  for (std::size_t v = 0; v < sheet.positions.size(); ++v) {
    file.append(reinterpret_cast<const char*>(&sheet.positions[v]), 12);
    file.append(reinterpret_cast<const char*>(&sheet.normals[v]), 12);
    file.append(reinterpret_cast<const char*>(&sheet.texcoords[v]), 8);
  }
  for (std::size_t i = 0; i < sheet.indices.size(); i += 3) {
    file += '\3';
    file.append(reinterpret_cast<const char*>(&sheet.indices[i]), 12);
  }
  return file;
}

/// What a program would do that knows where everything is.
Arrays glbByHand(const fs::path& file, const Arrays& like) {
  const std::string bytes = readFile(file, kLargestModelFile);
  Arrays result;
  std::size_t at = bytes.size() - 32 * like.positions.size() - 4 * like.indices.size();
  const auto take = [&](auto& values, std::size_t count) {
    values.resize(count);
    std::memcpy(values.data(), bytes.data() + at, count * sizeof(values[0]));
    at += count * sizeof(values[0]);
  };
  take(result.positions, like.positions.size());
  take(result.normals, like.normals.size());
  take(result.texcoords, like.texcoords.size());
  take(result.indices, like.indices.size());
  for (glm::vec2& texcoord : result.texcoords) texcoord.y = 1.0f - texcoord.y;
  return result;
}

Arrays plyByHand(const fs::path& file, const Arrays& like) {
  const std::string bytes = readFile(file, kLargestModelFile);
  const std::size_t vertices = like.positions.size(), triangles = like.indices.size() / 3;
  Arrays result;
  result.positions.resize(vertices);
  result.normals.resize(vertices);
  result.texcoords.resize(vertices);
  result.indices.resize(3 * triangles);
  const char* at = bytes.data() + bytes.size() - 32 * vertices - 13 * triangles;
  for (std::size_t v = 0; v < vertices; ++v, at += 32) {
    std::memcpy(&result.positions[v], at, 12);
    std::memcpy(&result.normals[v], at + 12, 12);
    std::memcpy(&result.texcoords[v], at + 24, 8);
  }
  for (std::size_t t = 0; t < triangles; ++t, at += 13) std::memcpy(&result.indices[3 * t], at + 1, 12);
  return result;
}

Spread timesOf(int repeats, const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return spreadOf(seconds);
}

void print(const std::string& what, const Spread& spread) {
  fmt::print("  {:<52} {:.4f} [{:.4f}, {:.4f}] s\n", what, spread.median, spread.lower, spread.upper);
}

Model load(const fs::path& file) {
  Hasher hasher;
  return loadModel({file}, {}, hasher);
}

/// Whether loading and the hand-written reader give the same positions, texture coordinates and indices.
bool compare(const std::string& name, const fs::path& file, int repeats,
             const std::function<Arrays(const fs::path&)>& byHand) {
  const Arrays expected = byHand(file);
  const Model model = load(file);
  const Spread ours = timesOf(repeats, [&] { load(file); }), theirs = timesOf(repeats, [&] { byHand(file); });
  print(name + ": loaded", ours);
  print(name + ": by hand", theirs);
  fmt::print("  {:<52} {:.2f}\n", "ratio", ours.median / theirs.median);
  return model.positions == expected.positions && model.texcoords == expected.texcoords &&
         model.indices == expected.indices;
}

int run(int repeats, std::uint32_t side) {
  setLogLevel(LogLevel::quiet);
  // Every repetition takes new memory from the system, as a program does that loads a model once.
  mallopt(M_MMAP_THRESHOLD, 1 << 17);
  const Arrays sheet = sheetOf(side);
  const fs::path folder = fs::temp_directory_path() / fmt::format("lumivox-model-loading-{}", getpid());
  fs::create_directories(folder);
  writeFileAtomically(folder / "sheet.glb", glbOf(sheet));
  writeFileAtomically(folder / "sheet.ply", plyOf(sheet));
  fmt::print("{} triangles, {} vertices\n", sheet.indices.size() / 3, sheet.positions.size());
  const bool good = compare(".glb", folder / "sheet.glb", repeats,
                            [&](const fs::path& file) { return glbByHand(file, sheet); }) &&
                    compare("binary PLY", folder / "sheet.ply", repeats,
                            [&](const fs::path& file) { return plyByHand(file, sheet); });
  fs::remove_all(folder);
  const fs::path sponza = "../shared/models/sponza_crytek/sponza.obj.gz";
  if (fs::exists(sponza)) print("Crytek Sponza, OBJ", timesOf(std::min(repeats, 5), [&] { load(sponza); }));
  if (!good) fmt::print("the arrays differ\n");
  return good ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  try {
    const bool isQuick = count > 1 && std::string_view(arguments[1]) == "--quick";
    constexpr std::uint32_t kMillion = 708;  // quads along a side: 1,002,528 triangles
    return run(isQuick ? 1 : count > 1 ? std::max(1, std::atoi(arguments[1])) : 15, isQuick ? 20 : kMillion);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
