// Textures of the arcade and of tables: small, procedural, and periodic without a seam.
#include <cmath>
#include <functional>
#include <numbers>

#include "lumivox/base/image.h"
#include "models.h"
#include "obj_model.h"

namespace lumivox::models {
namespace {

constexpr double kPi = std::numbers::pi;

/// A pseudo-random value in [0,1) for a point of an integer lattice: the finaliser of MurmurHash3 (Appleby
/// 2011) over both coordinates.
double speckle(int x, int y, std::uint32_t salt) {
  std::uint32_t h =
      static_cast<std::uint32_t>(x) * 0x9e3779b1u + static_cast<std::uint32_t>(y) * 0x85ebca77u + salt;
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return ((h ^ (h >> 16)) >> 8) / 16777216.0;
}

/// Fills an image from (u, v) in [0,1)^2 with v upwards, at texel centres.
ImageBuffer paint(int size, int channels, const std::function<glm::dvec3(double u, double v)>& albedo) {
  ImageBuffer image(size, size, channels);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const glm::dvec3 value = albedo((x + 0.5) / size, 1 - (y + 0.5) / size);
      for (int c = 0; c < channels; ++c) image.at(x, y, c) = static_cast<float>(value[c]);
    }
  return image;
}

/// Position within a course of blocks: the block, and the distance to its nearest edge (the image's side is
/// 1).
struct Block {
  int column, row;
  double edge;
};
Block blockAt(double u, double v, int columns, int rows) {
  const int row = static_cast<int>(v * rows);
  const double shifted = u * columns + (row % 2) * 0.5;
  const int column =
      static_cast<int>(std::floor(shifted)) % columns;  // the two halves at the seam belong to one block
  const double x = shifted - std::floor(shifted), y = v * rows - row;
  return {column, row, std::min(std::min(x, 1 - x) / columns, std::min(y, 1 - y) / rows)};
}

}  // namespace

void writeArcadeTextures(const std::filesystem::path& directory) {
  const auto save = [&](const char* name, const ImageBuffer& image) { writePng(directory / name, image); };

  save("bricks.png", paint(128, 3, [](double u, double v) {
         const Block brick = blockAt(u, v, 4, 10);
         if (brick.edge < 0.008) return glm::dvec3(0.45, 0.42, 0.38);  // mortar
         const double tone = 0.75 + 0.4 * speckle(brick.column, brick.row, 1);
         return glm::dvec3(0.42, 0.2, 0.13) * tone;
       }));
  save("stone.png", paint(64, 3, [](double u, double v) {
         const Block block = blockAt(u, v, 2, 4);
         const double joint = block.edge < 0.012 ? 0.75 : 1.0;
         return glm::dvec3(0.6, 0.55, 0.46) * (joint * (0.9 + 0.2 * speckle(block.column, block.row, 2)));
       }));
  save("tiles.png", paint(64, 3, [](double u, double v) {  // a check of eight by eight tiles
         const int column = static_cast<int>(u * 8), row = static_cast<int>(v * 8);
         const glm::dvec3 base =
             (column + row) % 2 == 0 ? glm::dvec3(0.55, 0.52, 0.47) : glm::dvec3(0.3, 0.25, 0.21);
         return base * (0.92 + 0.16 * speckle(column, row, 3));
       }));
  save("weave.png", paint(64, 3, [](double u, double v) {  // plain weave: warp and weft take turns on top
         const double x = u * 16, y = v * 16;
         const bool warp = (static_cast<int>(x) + static_cast<int>(y)) % 2 == 0;
         const double across = warp ? x - std::floor(x) : y - std::floor(y);
         return glm::dvec3((warp ? 1.0 : 0.85) * (0.6 + 0.4 * std::sin(kPi * across)));
       }));
  save("lattice_mask.png",
       paint(64, 1, [](double u, double v) {  // diagonal bars and a frame at top and bottom
         const auto bar = [](double t) { return std::abs(t - std::round(t)) < 0.11; };
         return glm::dvec3(bar(2 * (u + v)) || bar(2 * (u - v)) || v < 0.06 || v > 0.94 ? 1.0 : 0.0);
       }));
  save("leaves_mask.png", paint(128, 1, [](double u, double v) {  // leaves on a fan of stems
         for (int i = 0; i < 7; ++i) {
           const double angle = kPi * (0.2 + 0.1 * i), length = 0.72 + 0.22 * speckle(i, 0, 4);
           const glm::dvec2 stem{std::cos(angle), std::sin(angle)}, p{u - 0.5, v};
           const double along = glm::dot(p, stem) / length, across = std::abs(p.x * stem.y - p.y * stem.x);
           // Half width of a lancet leaf that starts a fifth up its stem; a thin stem below.
           const double width = along < 0.2 ? 0.008 : 0.075 * std::sin(kPi * (along - 0.2) / 0.8);
           if (along > 0 && along < 1 && across < width) return glm::dvec3(1);
         }
         return glm::dvec3(0);
       }));
}

void writeTableTextures(const std::filesystem::path& directory) {
  writePng(directory / "chequer.png", paint(64, 3, [](double u, double v) {  // a chess board
             const bool light = (static_cast<int>(u * 8) + static_cast<int>(v * 8)) % 2 == 0;
             return light ? glm::dvec3(0.75, 0.7, 0.6) : glm::dvec3(0.3, 0.18, 0.1);
           }));
  writePng(directory / "pattern.png", paint(128, 3, [](double u, double v) {  // rings in a lattice of stripes
             const double x = u * 6 - std::floor(u * 6) - 0.5, y = v * 6 - std::floor(v * 6) - 0.5,
                          r = std::hypot(x, y);
             if (r < 0.16) return glm::dvec3(0.75, 0.2, 0.12);
             if (r > 0.24 && r < 0.34) return glm::dvec3(0.15, 0.3, 0.55);
             if (std::abs(x) > 0.44 || std::abs(y) > 0.44) return glm::dvec3(0.2, 0.4, 0.25);
             return glm::dvec3(0.8, 0.76, 0.66);
           }));
}

}  // namespace lumivox::models
