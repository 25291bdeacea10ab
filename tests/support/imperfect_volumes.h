// Volumes with given contents for imperfect volumes, where metres are voxels, and the passes over them.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "lumivox/measure/voxels.h"
#include "support/bit_grids.h"
#include "support/passes.h"

namespace lumivox::test::volumes {

inline const double kY0 = 0.5 / std::sqrt(kPi), kY1 = std::sqrt(0.75 / kPi);

/// SH coefficients of a surface that sends radiance `front` into the half space of its normal and `back` into
/// the other.
inline glm::dvec4 bothSides(double front, double back, const glm::dvec3& normal) {
  const double difference = (front - back) * kPi * kY1;
  return {(front + back) * 2.0 * kPi * kY0, difference * normal.y, difference * normal.z,
          difference * normal.x};
}
/// SH coefficients of constant radiance.
inline glm::vec4 constant(double radiance) {
  return {radiance * 4.0 * kPi * kY0, 0.0, 0.0, 0.0};
}
/// Irradiance from the coefficients of two SH bands.
inline double irradiance(const glm::dvec4& coefficients, const glm::dvec3& normal) {
  return kPi * kY0 * coefficients.x +
         2.0 * kPi / 3.0 * kY1 *
             (coefficients.y * normal.y + coefficients.z * normal.z + coefficients.w * normal.x);
}

inline gpu::TextureRef volumeTexture(const glm::ivec3& size, gpu::Format format,
                                     const std::vector<float>& values) {
  return textureOf(volumeOf(size, format), values);
}

/// A volume of 1 m voxels that starts at the origin.
class Volume {
 public:
  explicit Volume(const glm::ivec3& size)
      : size_(size),
        set_(size),
        opacity_(count()),
        albedo_(4 * count()),
        normal_(4 * count()),
        sent_{std::vector<float>(4 * count()), std::vector<float>(4 * count()),
              std::vector<float>(4 * count())} {}

  const glm::ivec3& size() const { return size_; }
  const VoxelSet& set() const { return set_; }
  GridPlacement grid() const { return {glm::vec3(0.0f), 1.0f, size_}; }
  std::size_t at(const glm::ivec3& voxel) const {
    return static_cast<std::size_t>((voxel.z * size_.y + voxel.y) * size_.x + voxel.x);
  }
  template <class Work>
  void forEach(const Work& work) const {
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y)
        for (int x = 0; x < size_.x; ++x) work(glm::ivec3(x, y, z));
  }

  /// Fills a voxel with a surface: its normal, or length 0 for none, and the radiance that its sides send.
  Volume& occupy(const glm::ivec3& voxel, const glm::dvec3& normal, double front = 0.0, double back = 0.0,
                 double albedo = 0.5) {
    set_.insert(voxel);
    const std::size_t i = at(voxel);
    opacity_[i] = 1.0f;
    const glm::dvec4 sent = bothSides(front, back, normal);
    for (int c = 0; c < 4; ++c) {
      const auto k = 4 * i + static_cast<std::size_t>(c);
      albedo_[k] = c < 3 ? static_cast<float>(albedo) : 1.0f;
      normal_[k] = c < 3 ? static_cast<float>(normal[c]) : 0.0f;
      for (auto& channel : sent_) channel[k] = static_cast<float>(sent[c]);
    }
    return *this;
  }
  /// Fills all voxels for which `is` is true, with normals by `normal`.
  Volume& occupyWhere(const std::function<bool(const glm::ivec3&)>& is,
                      const std::function<glm::dvec3(const glm::ivec3&)>& normal, double front,
                      double back = 0.0, double albedo = 0.5) {
    forEach([&](const glm::ivec3& voxel) {
      if (is(voxel)) occupy(voxel, normal(voxel), front, back, albedo);
    });
    return *this;
  }

  OccupancyGrid opacity() const { return {grid(), volumeTexture(size_, gpu::Format::r8, opacity_)}; }
  AttributeGrid attributes() const {
    return {grid(), volumeTexture(size_, gpu::Format::rgba16f, albedo_),
            volumeTexture(size_, gpu::Format::rgba16f, normal_), nullptr};
  }
  BinaryGrid bits() const { return gridOf(set_); }
  ShGrid reflected() const {
    ShGrid result;
    result.quantity = ShGrid::Quantity::radiance;
    ShGrid::Level level{grid(), {}};
    for (std::size_t c = 0; c < 3; ++c)
      level.coefficients[c] = volumeTexture(size_, gpu::Format::rgba32f, sent_[c]);
    result.levels.push_back(level);
    return result;
  }

 private:
  std::size_t count() const { return grid().voxelCount(); }
  glm::ivec3 size_;
  VoxelSet set_;
  std::vector<float> opacity_, albedo_, normal_;
  std::array<std::vector<float>, 3> sent_;
};

/// A closed room of `inside` voxels a side in a shell of one voxel, whose walls send radiance inwards.
inline Volume closedRoom(int inside, double radiance, double albedo = 0.5) {
  const int last = inside + 1;
  Volume volume(glm::ivec3(inside + 2));
  const auto inwards = [=](const glm::ivec3& voxel) {
    glm::dvec3 normal(0.0);
    for (int axis = 0; axis < 3; ++axis)
      normal[axis] = voxel[axis] == 0 ? 1.0 : voxel[axis] == last ? -1.0 : 0.0;
    return normal;
  };
  return volume.occupyWhere([&](const glm::ivec3& voxel) { return inwards(voxel) != glm::dvec3(0.0); },
                            [&](const glm::ivec3& voxel) { return glm::normalize(inwards(voxel)); }, radiance,
                            0.0, albedo);
}

struct ReadPoint {
  glm::vec3 place, normal;
};

/// A white g-buffer of one row, with a pixel for each point.
inline GBuffer seen(const std::vector<ReadPoint>& points) {
  return gbufferWhere({static_cast<int>(points.size()), 1}, [&](int x, int) {
    const ReadPoint& point = points[static_cast<std::size_t>(x)];
    return SeenSurface{point.place, point.normal};
  });
}

/// A surface point for every voxel of the walls of a closed room, without the edges. `before`: its distance
/// in front of the voxel's centre.
inline std::vector<ReadPoint> wallsOf(const Volume& room, float before = 0.0f) {
  std::vector<ReadPoint> points;
  const int last = room.size().x - 1;
  room.forEach([&](const glm::ivec3& voxel) {
    int walls = 0;
    glm::vec3 normal(0.0f);
    for (int axis = 0; axis < 3; ++axis) {
      if (voxel[axis] != 0 && voxel[axis] != last) continue;
      ++walls;
      normal[axis] = voxel[axis] == 0 ? 1.0f : -1.0f;
    }
    if (walls == 1) points.push_back({glm::vec3(voxel) + 0.5f + before * normal, normal});
  });
  return points;
}

/// A pass of the technique with a camera of one row of pixels.
inline LonePass volumePass(const std::string& pass, Scene scene, int width = 1) {
  scene.cameras.front().width = width;
  scene.cameras.front().height = 1;
  return {"imperfect_volumes." + pass, scene};
}

inline Scene underSky(double radiance) {
  SceneBuilder builder;
  builder.scene.environment = glm::vec3(static_cast<float>(radiance));
  return builder.scene;
}

/// `march` over a volume, with all its inputs.
inline LonePass marching(const Volume& volume, const Settings& settings, double sky = 0.0) {
  LonePass runner = volumePass("march", underSky(sky));
  runner.in("opacity", volume.opacity())
      .in("reflected", volume.reflected())
      .in("attributes", volume.attributes())
      .in("bits", volume.bits())
      .with(settings);
  return runner;
}
inline ShGrid arriving(const Volume& volume, const Settings& settings, double sky = 0.0) {
  return marching(volume, settings, sky).out<ShGrid>("incoming");
}

/// The coefficients of a voxel's first channel.
inline glm::dvec4 coefficientsIn(const ShGrid& light, const glm::ivec3& voxel) {
  const ShGrid::Level& level = light.levels.front();
  const std::vector<float> values = level.coefficients[0]->downloadFloats(0);
  const glm::ivec3 size = level.grid.resolution;
  const auto i = static_cast<std::size_t>(4 * ((voxel.z * size.y + voxel.y) * size.x + voxel.x));
  return glm::dvec4(values[i], values[i + 1], values[i + 2], values[i + 3]) * double{light.unit};
}

/// E / pi at each point, in the first channel.
inline std::vector<double> gathered(const Volume& volume, const ShGrid& light,
                                    const std::vector<ReadPoint>& points, const Settings& settings = {},
                                    double sky = 0.0, const char* output = "diffuse") {
  LonePass runner = volumePass("gather", underSky(sky), static_cast<int>(points.size()));
  runner.in("gbuffer", seen(points))
      .in("incoming", light)
      .in("visibility", light)
      .in("opacity", volume.opacity())
      .in("attributes", volume.attributes())
      .with(settings);
  const std::vector<float> values = runner.out<Image>(output).texture->downloadFloats(0);
  std::vector<double> result;
  for (std::size_t i = 0; i < points.size(); ++i) result.push_back(values[4 * i]);
  return result;
}
inline double gatheredAt(const Volume& volume, const ShGrid& light, const ReadPoint& point,
                         const Settings& settings = {}, const char* output = "diffuse") {
  return gathered(volume, light, {point}, settings, 0.0, output).front();
}
inline double meanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Light that is the same from all directions. `radianceOf` gives its radiance by voxel and channel.
template <class RadianceOf>
ShGrid evenLight(const Volume& volume, const RadianceOf& radianceOf) {
  ShGrid light;
  light.quantity = ShGrid::Quantity::radiance;
  ShGrid::Level level{volume.grid(), {}};
  for (int c = 0; c < 3; ++c) {
    std::vector<float> values;
    volume.forEach([&](const glm::ivec3& voxel) {
      values.push_back(constant(radianceOf(voxel, c)).x);
      values.insert(values.end(), 3, 0.0f);
    });
    level.coefficients[static_cast<std::size_t>(c)] =
        volumeTexture(volume.size(), gpu::Format::rgba32f, values);
  }
  light.levels.push_back(level);
  return light;
}

}  // namespace lumivox::test::volumes
