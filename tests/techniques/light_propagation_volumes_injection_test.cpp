// Surfaces and virtual lights made by hand, one or a few at a time, in cells half a metre wide: which cell
// each comes to, and how much of it.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "lumivox/toolkit/light_samples.h"
#include "support/light_cells.h"
#include "support/made_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

constexpr int kSide = 8;       // cells
constexpr float kSize = 0.5f;  // m
constexpr double kFace = kSize * kSize;

/// The result of an injection for one grid.
struct Injected : ShGrid::Level, OccludedFaces::Level {};

/// An injection pass over cells of half a metre.
struct Injection {
  explicit Injection(const std::string& name)
      : pass("light_propagation_volumes." + name, emptyScene().scene,
             {{"levels", 1}, {"resolution", kSide}, {"extent", kSide * kSize}}) {}
  Injected run(const std::vector<FragmentData>& squares) {
    pass.in("fragments", listOver(grid(), squares));
    return {pass.out<ShGrid>("light").levels[0], pass.out<OccludedFaces>("faces").levels[0]};
  }
  /// Where the cells lie: around the eye, on whole cells.
  static GridPlacement grid() {
    const glm::vec3 eye = snapshotOf(emptyScene().scene, 0.0).camera.eye;
    return {kSize * (glm::round(eye / kSize) - 0.5f * static_cast<float>(kSide)), kSize, glm::ivec3(kSide)};
  }

  LonePass pass;
};

/// A directional light of this irradiance without shadows.
ShadowMap sunFrom(const glm::vec3& towards, float irradiance) {
  LightSampleData light{};
  light.direction = -glm::normalize(towards);
  light.firstView = -1;
  light.power = glm::vec3(irradiance);
  ShadowMap map;
  map.lights = bufferOf<LightSampleData>({light});
  map.views = bufferOf<glm::mat4>({glm::mat4(0.0f)});
  map.depth = filled({gpu::TextureKind::d2Array, gpu::Format::depth32f}, glm::vec4(0.0f));
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
int occludedParts(const Injected& level, int axis, const glm::ivec3& face) {
  const auto byte =
      static_cast<int>(level.occluded->download(0)[faceAt(face) + static_cast<std::size_t>(axis)]);
  return static_cast<int>(std::lround(byte * 16.0 / 255.0));
}
int allOccludedParts(const Injected& level, int axis) {
  const std::vector<std::byte> bytes = level.occluded->download(0);
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
  const auto texture = [&](auto value) {
    std::vector<float> values;
    for (const Texel& texel : texels) {
      const glm::vec3 v = value(texel);
      values.insert(values.end(), {v.x, v.y, v.z, 1.0f});
    }
    return textureOf(layers(static_cast<int>(texels.size()), 1, 1), values);
  };
  map.position = texture([](const Texel& texel) { return Injection::grid().low + kSize * texel.place; });
  map.normal = texture([](const Texel& texel) { return texel.normal; });
  map.flux = texture([](const Texel& texel) { return texel.flux; });
  map.lightCount = map.layerCount = 1;
  return map;
}

}  // namespace

TEST_CASE("a texel of flux F alone in its brick lights the cell in front of it: c0 = Y0 F, c1 = m Y1 F n") {
  // Moved to the nearest plane of faces, 3, it shines into the cell 3 along its normal and 2 against it.
  Injection inject("inject_rsm");
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f})
      for (const float place : {2.6f, 3.4f}) {
        glm::vec3 position(1.4f, 5.6f, 6.3f);
        position[axis] = place;
        glm::ivec3 cell(position);
        cell[axis] = sign > 0.0f ? 3 : 2;
        const glm::vec3 flux(0.01f, 0.0025f, 0.03f), normal = unit(axis, sign);
        inject.pass.in("map", mapOf({{position, normal, flux}, {position, normal, glm::vec3(0.0f)}}));
        const Injected level = inject.run({});
        INFO("axis " << axis << ", sign " << sign << ", at " << place);
        for (int channel = 0; channel < 3; ++channel) {
          const Cells cells = level.coefficients[static_cast<std::size_t>(channel)]->downloadFloats(0);
          const std::size_t first = at(kSide, cell.x, cell.y, cell.z);
          CHECK(cells[first] == Approx(kY0 * flux[channel]).epsilon(1e-5));
          const glm::dvec3 along =
              harmonicOrder(glm::dvec3(normal)) * (forwardCosine() * kY1 * flux[channel]);
          for (int i = 0; i < 3; ++i)
            CHECK(cells[first + 1 + static_cast<std::size_t>(i)] ==
                  Approx(along[i]).margin(1e-5 * flux[channel]));
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
        const Injected level =
            inject.run({squareAt(place, unit(axis, one.sign) + one.slope * unit(tilted, 1.0f))});
        INFO("axis " << axis << ", beyond " << one.beyond << ", sign " << one.sign << ", slope "
                     << one.slope);
        const std::size_t first = faceAt(face) + static_cast<std::size_t>(axis);
        CHECK(static_cast<int>(level.moved->download(0)[first]) == (one.down | one.up << 4));
        CHECK(occludedParts(level, axis, face) == 4);
        if (one.slope == 0.0f) CHECK(allOccludedParts(level, (axis + 1) % 3) == 0);
        if (one.slope == 0.0f) CHECK(allOccludedParts(level, (axis + 2) % 3) == 0);
      }
}

TEST_CASE(
    "a floor and a wall that end at each other's true place are closed up to their edge, as far as both go") {
  // Both were moved by 0.2 of a cell. The wall begins a quarter of a cell behind the plane of the floor, and
  // goes along half of the edge of the cell: three of four parts, twice. The floor, along the whole edge,
  // begins a quarter, a half or three quarters behind the plane of the wall. Both are filled up along the
  // wall's half where both come past the middles of their faces. What is a cell long goes on into the next.
  Injection inject("inject_rsm");
  for (int across = 0; across < 3; ++across)
    for (const int side : {(across + 1) % 3, (across + 2) % 3})
      for (const float up : {1.0f, -1.0f})
        for (const auto& [right, gap] : {std::pair{1.0f, 1}, std::pair{1.0f, 2}, std::pair{1.0f, 3},
                                         std::pair{-1.0f, 1}, std::pair{-1.0f, 2}, std::pair{-1.0f, 3}}) {
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
            floor[side] = inCell(2, right, behind - 0.25 + 0.25 * gap);
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
          const Injected level = inject.run(squares);
          INFO("floor " << up << " of axis " << across << ", wall " << right << " of axis " << side);
          INFO("gap " << gap);
          const bool meets = gap < 3;
          CHECK(occludedParts(level, across, ofFloor) == (4 - gap) * 4 + (meets ? 2 * gap : 0));
          CHECK(occludedParts(level, side, ofWall) == 3 * 2 + (meets ? 2 : 0));
          CHECK(allOccludedParts(level, across) == 4 * 4 + (meets ? 2 * gap : 0));
          CHECK(allOccludedParts(level, side) == 4 * 2 + (meets ? 2 : 0));
          CHECK(allOccludedParts(level, along) == 0);
        }
}

TEST_CASE("what a floor has between a wall's plane and its true place shines in the cell before the wall") {
  // A square with its middle on the edge between four cells: a sixteenth of its light's cell face for each of
  // 2 x 2 parts. A wall that was moved by 0.3 of a cell holds two of them back from the cell behind it;
  // beyond one that was moved by 0.05 there is nothing that a square's middle knows of, and those two are
  // left out.
  // A wall with holes is one where it closes more than half of a face.
  Injection inject("inject_voxels");
  for (int across = 0; across < 3; ++across)
    for (const int side : {(across + 1) % 3, (across + 2) % 3})
      for (const auto& [right, moved] : {std::pair{0.0f, 0.0}, std::pair{1.0f, 0.3}, std::pair{-1.0f, 0.3},
                                         std::pair{1.0f, 0.05}, std::pair{-1.0f, 0.05}}) {  // 0: no wall
        const int along = 3 - across - side;
        // Surfaces of one group share a mean normal: the floor looks the other way where it would be the
        // wall's.
        const float up = across == side + 1 && right < 0.0f ? -1.0f : 1.0f;
        glm::dvec3 floor(0.0), wall(0.0);
        floor[across] = up > 0.0f ? 2.1 : 2.9;
        floor[side] = 3.0;
        floor[along] = 5.0;
        std::vector<FragmentData> squares{squareAt(floor, unit(across, up))};
        wall[side] = 3.0 - moved * right;
        for (const double above : {2.25, 2.75})
          for (const double place : {4.25, 4.75, 5.25, 5.75}) {
            wall[across] = above;
            wall[along] = place;
            if (right != 0.0f) squares.push_back(squareAt(wall, unit(side, right), glm::vec3(0.5f), 0.7f));
          }
        inject.pass.in("shadow", sunFrom(unit(across, up), 0.8f));
        const Cells cells = inject.run(squares).coefficients[0]->downloadFloats(0);
        INFO("floor of axis " << across << ", wall " << right << " of axis " << side << " moved by "
                              << moved);
        int all = 0;
        for (const int column : {2, 3})
          for (const int place : {4, 5}) {
            glm::ivec3 cell(2);
            cell[side] = column;
            cell[along] = place;
            const bool isBefore = right == 0.0f || (right < 0.0f) == (column == 2);
            const int parts = isBefore ? moved > 0.1 ? 2 : 1 : 0;
            all += parts;
            const std::size_t first = at(kSide, cell.x, cell.y, cell.z);
            const double flux = 0.5 * 0.8 * kFace * parts / 16.0;
            CHECK(cells[first] == Approx(kY0 * flux).margin(1e-6));
            const glm::dvec3 lobe =
                harmonicOrder(glm::dvec3(unit(across, up))) * (forwardCosine() * kY1 * flux);
            for (int i = 0; i < 3; ++i)
              CHECK(cells[first + 1 + static_cast<std::size_t>(i)] == Approx(lobe[i]).margin(1e-6));
          }
        CHECK(energy(cells) == Approx(0.5 * 0.8 * kFace * all / 16.0).epsilon(1e-5));
      }
}

TEST_CASE("a surface with holes closes its share of a face, to the nearest sixteenth") {
  Injection inject("inject_rsm");
  for (int axis = 0; axis < 3; ++axis)
    for (const double sixteenths : {1.0, 3.0, 7.375, 8.0, 11.625, 15.0, 16.0}) {
      std::vector<FragmentData> squares;
      for (const double u : {0.25, 0.75})
        for (const double v : {0.25, 0.75}) {
          glm::dvec3 place(3.1, 3.1, 3.1);
          place[(axis + 1) % 3] = 4.0 + u;
          place[(axis + 2) % 3] = 5.0 + v;
          squares.push_back(
              squareAt(place, unit(axis, 1.0f), glm::vec3(0.5f), static_cast<float>(sixteenths / 16.0)));
        }
      glm::ivec3 face(3);
      face[(axis + 1) % 3] = 4;
      face[(axis + 2) % 3] = 5;
      const Injected level = inject.run(squares);
      INFO("axis " << axis << ", sixteenths " << sixteenths);
      CHECK(occludedParts(level, axis, face) == std::lround(sixteenths));
      CHECK(allOccludedParts(level, axis) == std::lround(sixteenths));
    }
}

TEST_CASE(
    "a voxel's albedo is the mean over the parts of its surfaces, and lit from behind it shines there") {
  // Four parts of albedo 0.75 and, of a surface with holes in half of it, two of 0.25. Above 1 it is 1.
  Injection inject("inject_voxels");
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {1.0f, -1.0f})
      for (const bool twoSided : {true, false}) {
        glm::dvec3 place(3.2, 3.2, 3.2);
        place[(axis + 1) % 3] = 4.25;
        place[(axis + 2) % 3] = 5.25;
        glm::dvec3 beside = place;
        beside[(axis + 1) % 3] = 4.75;
        inject.pass.with({{"two_sided", twoSided ? "on" : "off"}});
        inject.pass.in("shadow", sunFrom(unit(axis, side), 0.8f));
        const Injected level =
            inject.run({squareAt(place, unit(axis, 1.0f), glm::vec3(0.75f, 0.5f, 1.25f)),
                        squareAt(beside, unit(axis, 1.0f), glm::vec3(0.25f, 0.5f, 1.5f), 0.5f)});
        const Cells cells = level.coefficients[0]->downloadFloats(0);
        glm::ivec3 cell(side > 0.0f ? 3 : 2);
        cell[(axis + 1) % 3] = 4;
        cell[(axis + 2) % 3] = 5;
        const double mean = (4.0 * 0.75 + 2.0 * 0.25) / 6.0;
        const double flux = side > 0.0f || twoSided ? mean * 0.8 * kFace * 6.0 / 16.0 : 0.0;
        INFO("axis " << axis << ", light from " << side << ", two-sided " << twoSided);
        CHECK(energy(level.coefficients[2]->downloadFloats(0)) == Approx(flux / mean).epsilon(1e-5));
        CHECK(energy(cells) == Approx(flux).epsilon(1e-5));
        CHECK(cells[at(kSide, cell.x, cell.y, cell.z)] == Approx(kY0 * flux).epsilon(1e-5));
      }
}

TEST_CASE(
    "with the published albedo a voxel shines as its most contrasting surface, of equal ones the reddest") {
  Injection inject("inject_voxels");
  inject.pass.with({{"albedo", "contrast"}});
  inject.pass.in("shadow", sunFrom({0, 1, 0}, 0.8f));
  // Contrasts are kept in 127ths and albedos in bytes: 25.2 and 25.7 of the second pair are equal.
  struct Pair {
    glm::dvec3 wins, loses;
  };
  for (const Pair& pair :
       {Pair{{0.2, 0.61, 0.88}, {0.7, 0.95, 0.75}}, Pair{{0.9, 0.3, 0.15}, {0.05, 0.35, 0.05}}})
    for (const bool first : {true, false}) {
      std::vector<FragmentData> squares{squareAt({4.25, 3.1, 5.25}, {0, 1, 0}, glm::vec3(pair.wins)),
                                        squareAt({4.75, 3.1, 5.25}, {0, 1, 0}, glm::vec3(pair.loses))};
      if (!first) std::swap(squares[0], squares[1]);
      const Injected level = inject.run(squares);
      for (int channel = 0; channel < 3; ++channel) {
        const double albedo =
            std::round(glm::dvec3(squares[first ? 0 : 1].albedo())[channel] * 255.0) / 255.0;
        CHECK(energy(level.coefficients[static_cast<std::size_t>(channel)]->downloadFloats(0)) ==
              Approx(albedo * 0.8 * kFace * 8.0 / 16.0).epsilon(1e-5));
      }
    }
}

TEST_CASE("each surface of a long list lights its own cell and closes its own face") {
  // Of the parts those count whose centres it covers, two by two wherever it begins.
  std::vector<FragmentData> squares;
  for (int i = 0; i < kSide * kSide * kSide; ++i)
    squares.push_back(
        squareAt(glm::dvec3(i % kSide, i / kSide % kSide, i / kSide / kSide) + glm::dvec3(0.41, 0.1, 0.59),
                 {0, 1, 0}));
  Injection inject("inject_voxels");
  inject.pass.in("shadow", sunFrom({0, 1, 0}, 0.8f));
  const Injected level = inject.run(squares);
  const Cells cells = level.coefficients[0]->downloadFloats(0);
  REQUIRE(cells.size() == 4 * squares.size());
  for (std::size_t i = 0; i < cells.size(); i += 4)
    CHECK(cells[i] == Approx(kY0 * 0.5 * 0.8 * kFace * 4.0 / 16.0).epsilon(1e-5));
  CHECK(allOccludedParts(level, 1) == 4 * kSide * kSide * kSide);
  CHECK(allOccludedParts(level, 0) + allOccludedParts(level, 2) == 0);
}

TEST_CASE("a surface is lit by a light at its true place and not at the middle of its cell: I cos / d^2") {
  Injection inject("inject_voxels");
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {1.0f, -1.0f})
      for (const double part : {0.25, 0.75})
        for (const double beyond : {-0.4, 0.4}) {
          glm::dvec3 place(3.0 + beyond);
          place[(axis + 1) % 3] = 4.0 + part;
          place[(axis + 2) % 3] = 5.0 + part;
          const glm::dvec3 lightCell = glm::dvec3(4.9, 4.7, 5.1) + 3.0 * glm::dvec3(unit(axis, sign));
          ShadowMap shadow = sunFrom({0, 1, 0}, 0.0f);
          LightSampleData light{};
          light.position = Injection::grid().low + kSize * glm::vec3(lightCell);
          light.kind = LightSampleKind::point;
          light.firstView = -1;
          light.power = glm::vec3(0.3f);
          shadow.lights->uploadValues(std::span<const LightSampleData>(&light, 1));
          inject.pass.in("shadow", shadow);
          const Cells cells =
              inject.run({squareAt(place, unit(axis, sign))}).coefficients[0]->downloadFloats(0);
          const glm::dvec3 path = static_cast<double>(kSize) * (lightCell - place);
          const double distance = glm::length(path), cosine = std::abs(path[axis]) / distance;
          INFO("axis " << axis << ", sign " << sign << ", " << beyond << " beyond the plane");
          CHECK(energy(cells) ==
                Approx(0.5 * 0.3 * cosine / (distance * distance) * kFace * 4.0 / 16.0).epsilon(2e-3));
        }
}

TEST_CASE("a packed voxel keeps a normal in 255ths whatever its signs, and shines with the cosine of that") {
  // Listings 4.26 to 4.31: the albedo over pi in bytes, the numbers of the normal cut off.
  constexpr double kPrinted0 = 0.8862269262, kPrinted1 = 1.0233267079;
  const double intensity = std::floor(0.5 / kPi * 255.0) / 255.0 * 0.8 * kFace;
  Injection inject("inject_voxels");
  inject.pass.with({{"voxels", "packed"}});
  for (const glm::dvec3 direction : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0),
                                     glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1),
                                     glm::dvec3(1, 2, 3), glm::dvec3(-1, -2, -3), glm::dvec3(3, -1, -2)}) {
    const glm::dvec3 normal = glm::normalize(direction), kept = glm::trunc(normal * 255.0) / 255.0;
    inject.pass.in("shadow", sunFrom(glm::vec3(normal), 0.8f));
    const Cells cells =
        inject.run({squareAt({3.3, 4.2, 5.1}, glm::vec3(normal))}).coefficients[0]->downloadFloats(0);
    INFO("normal " << normal.x << " " << normal.y << " " << normal.z);
    const std::size_t first = at(kSide, 3, 4, 5);
    const double light = intensity * glm::dot(kept, normal);
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
  inject.pass.with({{"voxels", "packed"}});
  for (const glm::dvec3 albedo : {glm::dvec3(1, 0.1, 0.1), glm::dvec3(0.2, 0.6, 0.9), glm::dvec3(0, 0.5, 0),
                                  glm::dvec3(0.4), glm::dvec3(2, 0.1, 0.1)}) {
    const Injected level = inject.run({squareAt({3.3, 4.2, 5.1}, {0, 1, 0}, glm::vec3(albedo))});
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

TEST_CASE("a packed voxel keeps a normal at the nearest face of a tetrahedron, with 31 times its cosine") {
  // Listings 4.28 and 4.29. A normal in each of many cells.
  const double a = std::sqrt(1.0 / 3.0), b = std::sqrt(2.0 / 3.0);
  const glm::dvec3 faces[] = {{0, -a, b}, {0, -a, -b}, {-b, a, 0}, {b, a, 0}};
  std::mt19937 random(4);
  std::normal_distribution<double> component;
  std::vector<FragmentData> squares;
  for (int i = 0; i < kSide * kSide * kSide; ++i) {
    const glm::dvec3 cell(i % kSide, i / kSide % kSide, i / kSide / kSide);
    const glm::dvec3 normal(component(random), component(random), component(random));
    squares.push_back(squareAt(cell + 0.4, glm::vec3(glm::normalize(normal))));
  }
  Injection inject("inject_voxels");
  inject.pass.with({{"voxels", "packed"}});
  const std::vector<std::uint32_t> words = inject.run(squares).packed->downloadValues<std::uint32_t>();
  REQUIRE(words.size() == 5 * squares.size());
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const glm::dvec3 normal(squares[i].unitNormal());
    std::array<double, 4> cosines{};
    for (std::size_t face = 0; face < 4; ++face) cosines[face] = glm::dot(normal, faces[face]);
    const auto face =
        static_cast<std::size_t>(std::max_element(cosines.begin(), cosines.end()) - cosines.begin());
    std::array<double, 4> sorted = cosines;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[3] - sorted[2] < 1e-4) continue;  // between two faces rounding decides
    for (std::size_t other = 0; other < 4; ++other)
      if (other != face) CHECK(words[5 * i + 1 + other] == 0u);
    const std::uint32_t word = words[5 * i + 1 + face];
    CHECK(std::abs((word >> 27) + 0.5 - 31.0 * cosines[face]) < 0.501);
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t bits = word >> (18 - 9 * axis) & 511u;
      CHECK(std::abs((bits & 255u) + 0.5 - 255.0 * std::abs(normal[axis])) < 0.51);
      if (std::abs(normal[axis]) > 0.01) CHECK((bits >> 8 == 1u) == (normal[axis] < 0.0));
    }
  }
}
