#include "reference/environment.h"

#include <fmt/format.h>

#include "lumivox/base/file.h"

namespace lumivox::reference {
namespace {

constexpr double kSphere = 4.0 * std::numbers::pi;

}  // namespace

EnvironmentLight::EnvironmentLight(const Scene& scene)
    : constant_(scene.environment),
      map_(scene.environment != glm::vec3(0.0f) ? scene.environmentMap : nullptr),
      total_(kSphere * meanOf(constant_)) {
  if (map_ == nullptr) return;
  const auto width = static_cast<std::size_t>(map_->width);
  requireMemory(
      map_->radiance.size() * AliasTable::kBytesWhileBuilt,
      fmt::format("the table that samples an environment map of {} x {} texels", map_->width, map_->height));
  std::vector<double> weights(map_->radiance.size());
  for (std::size_t row = 0; row < static_cast<std::size_t>(map_->height); ++row) {
    const double solidAngle = map_->solidAngle(static_cast<int>(row));
    for (std::size_t i = row * width; i < (row + 1) * width; ++i)
      weights[i] = solidAngle * meanOf(map_->radiance[i]);
  }
  total_ = 0.0;
  for (const double weight : weights) total_ += weight;
  texels_ = AliasTable(std::move(weights));
}

EnvironmentLight::Sample EnvironmentLight::sample(RandomStream& random) const {
  const std::uint32_t slotBits = random.bits(), choiceBits = random.bits();
  const std::uint32_t texel = texels_.pick(slotBits, choiceBits);
  const std::uint32_t width = static_cast<std::uint32_t>(map_->width), row = texel / width,
                      column = texel % width;
  const float u = random.uniform(), v = random.uniform();
  const glm::vec3& radiance = map_->radiance[texel];
  return {map_->directionWithin(static_cast<int>(column), static_cast<int>(row), u, v), radiance,
          density(radiance)};
}

float EnvironmentLight::density(const glm::vec3& radiance) const {
  return static_cast<float>(meanOf(radiance) / total_);
}

}  // namespace lumivox::reference
