// Surfaces and virtual lights made by hand, one or a few at a time, in cells a metre wide: which cell each
// comes to, and how much of it.
#include <array>
#include <cmath>

#include "lumivox/pipeline/light_samples.h"
#include "support/light_cells.h"
#include "support/made_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSide = 8;  // cells

/// An injection pass over cells of a metre.
struct Injection {
  explicit Injection(const std::string& pass)
      : builder(emptyScene()),
        harness(device(), techniques(), "light_propagation_volumes", pass, builder.scene,
                snapshotOf(builder.scene, 0.0)) {
    harness.setParameter("levels", 1);
    harness.setParameter("resolution", kSide);
    harness.setParameter("extent", kSide);
  }
  ShGrid::Level run(const std::vector<FragmentData>& squares) {
    harness.setInput("fragments", listOver(grid(), squares));
    harness.run();
    return harness.output<ShGrid>("light").levels[0];
  }
  /// Where the cells lie: around the eye, on whole cells.
  static GridPlacement grid() {
    const glm::vec3 eye = snapshotOf(emptyScene().scene, 0.0).camera.eye;
    return {glm::round(eye) - 0.5f * static_cast<float>(kSide), 1.0f, glm::ivec3(kSide)};
  }

  SceneBuilder builder;
  PassHarness harness;
};

/// A directional light of this irradiance without shadows.
ShadowMap sunFrom(const glm::vec3& towards, float irradiance) {
  LightSampleData light{};
  light.directionLayer = glm::vec4(-glm::normalize(towards), -1.0f);
  light.power = glm::vec4(glm::vec3(irradiance), 1.0f);
  ShadowMap map;
  map.lights = std::make_shared<gpu::Buffer>(device(), sizeof(light), "lights");
  map.lights->uploadValues(std::span<const LightSampleData>(&light, 1));
  map.views = std::make_shared<gpu::Buffer>(device(), sizeof(glm::mat4), "views");
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d2Array;
  description.format = gpu::Format::depth32f;
  map.depth = std::make_shared<gpu::Texture>(device(), description, "shadow");
  map.lightCount = map.layerCount = 1;
  return map;
}

glm::vec3 unit(int axis, float sign) {
  glm::vec3 result(0.0f);
  result[axis] = sign;
  return result;
}

/// Of a direction, to the order of the harmonics.
glm::dvec3 harmonicOrder(const glm::dvec3& v) {
  return {v.y, v.z, v.x};
}

std::size_t faceAt(const glm::ivec3& face) {
  return at(kSide + 1, face.x, face.y, face.z);
}

/// Closed sixteenths of the faces of an axis, of one or of all.
int closedParts(const ShGrid::Level& level, int axis, const glm::ivec3& face) {
  const auto byte =
      static_cast<int>(level.closed->download(0)[faceAt(face) + static_cast<std::size_t>(axis)]);
  return static_cast<int>(std::lround(byte * 16.0 / 255.0));
}
int allClosedParts(const ShGrid::Level& level, int axis) {
  const std::vector<std::byte> bytes = level.closed->download(0);
  int sum = 0;
  for (std::size_t i = static_cast<std::size_t>(axis); i < bytes.size(); i += 4)
    sum += static_cast<int>(std::lround(static_cast<int>(bytes[i]) * 16.0 / 255.0));
  return sum;
}

/// A texel of a reflective shadow map.
struct Texel {
  glm::vec3 place, normal, flux;  ///< place in cells
};

ReflectiveShadowMap mapOf(const std::vector<Texel>& texels) {
  ReflectiveShadowMap map;
  gpu::TextureDescription description;
  description.kind = gpu::TextureKind::d2Array;
  description.format = gpu::Format::rgba32f;
  description.width = static_cast<int>(texels.size());
  const auto filled = [&](auto value) {
    std::vector<float> values;
    for (const Texel& texel : texels) {
      const glm::vec3 v = value(texel);
      values.insert(values.end(), {v.x, v.y, v.z, 1.0f});
    }
    auto texture = std::make_shared<gpu::Texture>(device(), description, "texels");
    texture->uploadFloats(0, values);
    return texture;
  };
  map.position = filled([](const Texel& texel) { return Injection::grid().low + texel.place; });
  map.normal = filled([](const Texel& texel) { return texel.normal; });
  map.flux = filled([](const Texel& texel) { return texel.flux; });
  map.lightCount = map.layerCount = 1;
  return map;
}

}  // namespace

TEST_CASE("a texel of flux F alone in its brick lights the cell in front of it: c0 = Y0 F, c1 = m Y1 F n") {
  // Moved to the nearest plane of faces, 3, it shines into the cell 3 along its normal and 2 against it.
  Injection inject("inject_rsm");
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f})
      for (const float place : {2.7f, 3.2f}) {
        glm::vec3 position(1.4f, 5.6f, 6.3f);
        position[axis] = place;
        glm::ivec3 cell(position);
        cell[axis] = sign > 0.0f ? 3 : 2;
        const glm::vec3 flux(1.0f, 0.25f, 3.0f), normal = unit(axis, sign);
        inject.harness.setInput("map",
                                mapOf({{position, normal, flux}, {position, normal, glm::vec3(0.0f)}}));
        const ShGrid::Level level = inject.run({});
        INFO("axis " << axis << ", sign " << sign << ", at " << place);
        for (int channel = 0; channel < 3; ++channel) {
          const Cells cells = level.coefficients[static_cast<std::size_t>(channel)]->downloadFloats(0);
          const std::size_t first = at(kSide, cell.x, cell.y, cell.z);
          CHECK(cells[first] == Approx(kY0 * flux[channel]).epsilon(1e-5));
          const glm::dvec3 along =
              harmonicOrder(glm::dvec3(normal)) * (forwardCosine() * kY1 * flux[channel]);
          for (int i = 0; i < 3; ++i)
            CHECK(cells[first + 1 + static_cast<std::size_t>(i)] == Approx(along[i]).margin(1e-5));
          CHECK(energy(cells) == Approx(flux[channel]).epsilon(1e-5));
        }
      }
}

TEST_CASE(
    "a surface tells how many fourteenths of a cell it was moved to its plane, with its slant, 7 at most") {
  // Half a cell wide and at a slope s, its place varies by s/4 to both sides. What looks down is moved where
  // it lies above its plane, what looks up where it lies below; a started fourteenth counts.
  Injection inject("inject_rsm");
  struct Case {
    double beyond;  ///< cells from the plane to the true place
    float sign, slope;
    int down, up;
  };
  for (const Case& one : {Case{0.2, -1, 0, 3, 0}, Case{0.2, 1, 0, 0, 0}, Case{-0.1, 1, 0, 0, 2},
                          Case{-0.1, -1, 0, 0, 0}, Case{0.48, -1, 0, 7, 0}, Case{-0.48, 1, 0, 0, 7},
                          Case{0.1, -1, 0.5f, 4, 0}, Case{0.1, 1, 0.5f, 0, 1}, Case{0.45, -1, 0.8f, 7, 0}})
    for (int axis = 0; axis < 3; ++axis)
      for (const int tilted : {(axis + 1) % 3, (axis + 2) % 3}) {
        glm::dvec3 place(4.25, 4.25, 4.25);
        place[axis] = 3.0 + one.beyond;
        glm::ivec3 face(4);
        face[axis] = 3;
        const ShGrid::Level level =
            inject.run({squareAt(place, unit(axis, one.sign) + one.slope * unit(tilted, 1.0f))});
        INFO("axis " << axis << ", beyond " << one.beyond << ", sign " << one.sign << ", slope "
                     << one.slope);
        const std::size_t first = faceAt(face) + static_cast<std::size_t>(axis);
        CHECK(static_cast<int>(level.moved->download(0)[first]) == (one.down | one.up << 4));
        CHECK(closedParts(level, axis, face) == 4);
        if (one.slope == 0.0f) CHECK(allClosedParts(level, (axis + 1) % 3) == 0);
        if (one.slope == 0.0f) CHECK(allClosedParts(level, (axis + 2) % 3) == 0);
      }
}

TEST_CASE(
    "a floor and a wall that end at each other's true place are closed up to their edge, as far as both go") {
  // Both were moved by 0.2 of a cell and begin a quarter of a cell behind the plane of the other: three of
  // four rows of parts. The floor goes along the whole edge of the cell and the wall along half of it: there
  // two parts are filled of each. A row of each goes on into the next cell.
  Injection inject("inject_rsm");
  for (int across = 0; across < 3; ++across)
    for (const int side : {(across + 1) % 3, (across + 2) % 3})
      for (const float up : {1.0f, -1.0f})
        for (const float right : {1.0f, -1.0f}) {
          const int along = 3 - across - side;
          glm::dvec3 floor(0.0), wall(0.0);
          // Towards the room: from the edge at 0 of cells 3 and 2 up, or from that at 1 down.
          const auto inCell = [](int cell, float sign, double share) {
            return sign > 0.0f ? cell + share : cell + 1 - share;
          };
          std::vector<FragmentData> squares;
          floor[across] = inCell(3, up, 0.2);
          wall[side] = inCell(2, right, 0.2);
          for (const double behind : {0.5, 1.0}) {
            floor[side] = inCell(2, right, behind);
            for (const double place : {4.25, 4.75}) {
              floor[along] = place;
              squares.push_back(squareAt(floor, unit(across, up)));
            }
            wall[across] = inCell(3, up, behind);
            wall[along] = 4.25;
            squares.push_back(squareAt(wall, unit(side, right)));
          }
          glm::ivec3 face(4);
          face[across] = 3;
          face[side] = 2;
          glm::ivec3 ofFloor = face, ofWall = face;
          if (up < 0.0f) ofFloor[across] = 4;
          if (right < 0.0f) ofWall[side] = 3;
          const ShGrid::Level level = inject.run(squares);
          INFO("floor " << up << " of axis " << across << ", wall " << right << " of axis " << side);
          CHECK(closedParts(level, across, ofFloor) == 3 * 4 + 2);
          CHECK(closedParts(level, side, ofWall) == 3 * 2 + 2);
          CHECK(allClosedParts(level, across) == 4 * 4 + 2);
          CHECK(allClosedParts(level, side) == 4 * 2 + 2);
          CHECK(allClosedParts(level, along) == 0);
        }
}

TEST_CASE("what a floor has between a wall's plane and its true place shines in the cell before the wall") {
  // A square with its middle on the edge between four cells: a sixteenth of its light's cell face for each of
  // 2 x 2 parts. A wall 0.3 of a cell beyond the plane holds two of them back from the cell behind it.
  Injection inject("inject_voxels");
  for (int across = 0; across < 3; ++across)
    for (const int side : {(across + 1) % 3, (across + 2) % 3})
      for (const float right : {0.0f, 1.0f, -1.0f}) {  // 0: no wall
        const int along = 3 - across - side;
        // Surfaces of one group share a mean normal: the floor looks the other way where it would be the
        // wall's.
        const float up = across == side + 1 && right < 0.0f ? -1.0f : 1.0f;
        glm::dvec3 floor(0.0), wall(0.0);
        floor[across] = up > 0.0f ? 2.1 : 2.9;
        floor[side] = 3.0;
        floor[along] = 5.0;
        std::vector<FragmentData> squares{squareAt(floor, unit(across, up))};
        wall[side] = 3.0 - 0.3 * right;
        for (const double above : {2.25, 2.75})
          for (const double place : {4.25, 4.75, 5.25, 5.75}) {
            wall[across] = above;
            wall[along] = place;
            if (right != 0.0f) squares.push_back(squareAt(wall, unit(side, right)));
          }
        inject.harness.setInput("shadow", sunFrom(unit(across, up), 0.8f));
        const Cells cells = inject.run(squares).coefficients[0]->downloadFloats(0);
        INFO("floor of axis " << across << ", wall " << right << " of axis " << side);
        for (const int column : {2, 3})
          for (const int place : {4, 5}) {
            glm::ivec3 cell(2);
            cell[side] = column;
            cell[along] = place;
            const int parts = right == 0.0f ? 1 : (right < 0.0f) == (column == 2) ? 2 : 0;
            const std::size_t first = at(kSide, cell.x, cell.y, cell.z);
            const double flux = 0.5 * 0.8 * parts / 16.0;
            CHECK(cells[first] == Approx(kY0 * flux).margin(1e-6));
            const glm::dvec3 lobe =
                harmonicOrder(glm::dvec3(unit(across, up))) * (forwardCosine() * kY1 * flux);
            for (int i = 0; i < 3; ++i)
              CHECK(cells[first + 1 + static_cast<std::size_t>(i)] == Approx(lobe[i]).margin(1e-6));
          }
        CHECK(energy(cells) == Approx(0.5 * 0.8 * 4.0 / 16.0).epsilon(1e-5));
      }
}

TEST_CASE("a packed voxel keeps a normal in 255ths whatever its signs, and shines with the cosine of that") {
  // Listings 4.26 to 4.31: the albedo over pi in bytes, the numbers of the normal cut off.
  constexpr double kPrinted0 = 0.8862269262, kPrinted1 = 1.0233267079;
  const double radiance = std::floor(0.5 / kPi * 255.0) / 255.0 * 0.8;
  Injection inject("inject_voxels");
  inject.harness.setParameter("voxels", std::string("packed"));
  for (const glm::dvec3 direction : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0),
                                     glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1),
                                     glm::dvec3(1, 2, 3), glm::dvec3(-1, -2, -3), glm::dvec3(3, -1, -2)}) {
    const glm::dvec3 normal = glm::normalize(direction), kept = glm::trunc(normal * 255.0) / 255.0;
    inject.harness.setInput("shadow", sunFrom(glm::vec3(normal), 0.8f));
    const Cells cells =
        inject.run({squareAt({3.3, 4.2, 5.1}, glm::vec3(normal))}).coefficients[0]->downloadFloats(0);
    INFO("normal " << normal.x << " " << normal.y << " " << normal.z);
    const std::size_t first = at(kSide, 3, 4, 5);
    const double light = radiance * glm::dot(kept, normal);
    CHECK(cells[first] == Approx(kPrinted0 * light).epsilon(1e-3));
    const glm::dvec3 lobe = harmonicOrder(kept) * (kPrinted1 * light);
    for (int i = 0; i < 3; ++i)
      CHECK(cells[first + 1 + static_cast<std::size_t>(i)] == Approx(lobe[i]).margin(2e-3 * light));
    CHECK(energy(cells) == Approx(cells[first] / kY0).epsilon(1e-6));
  }
}

TEST_CASE(
    "a packed voxel keeps the contrast of its albedo as displayed, x^(1/2.2), in 127ths; above 1 is 1") {
  // |rrg - gbb| / (sqrt 2 + r + g + b).
  Injection inject("inject_voxels");
  inject.harness.setParameter("voxels", std::string("packed"));
  for (const glm::dvec3 albedo : {glm::dvec3(1, 0.1, 0.1), glm::dvec3(0.2, 0.6, 0.9), glm::dvec3(0, 0.5, 0),
                                  glm::dvec3(0.4), glm::dvec3(2, 0.1, 0.1)}) {
    const ShGrid::Level level = inject.run({squareAt({3.3, 4.2, 5.1}, {0, 1, 0}, glm::vec3(albedo))});
    const glm::dvec3 d = glm::pow(glm::min(albedo, glm::dvec3(1.0)), glm::dvec3(1.0 / 2.2));
    const double contrast =
        glm::length(glm::dvec3(d.r - d.g, d.r - d.b, d.g - d.b)) / (std::sqrt(2.0) + d.r + d.g + d.b);
    const std::uint32_t word = level.packed->downloadValues<std::uint32_t>()[at(kSide, 3, 4, 5) / 4 * 5];
    INFO("albedo " << albedo.r << " " << albedo.g << " " << albedo.b);
    CHECK(word >> 31 == 1u);
    CHECK((word >> 24 & 127u) == static_cast<std::uint32_t>(contrast * 127.0));
    for (int i = 0; i < 3; ++i)
      CHECK((word >> (16 - 8 * i) & 255u) == static_cast<std::uint32_t>(albedo[i] / kPi * 255.0));
  }
}
