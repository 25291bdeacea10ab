// Looking at a grid: ray and cone casting of the voxels of any kind of port, with a transfer function (thesis
// Gomes 2015, Sec. 2.3).
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {
namespace {

using namespace shaders::voxel_cone_tracing;
using gpu::Sampling;
using Field = PortContents::Field;

/// Values of a field in textures: one texture for each channel.
struct FieldTexels {
  std::vector<gpu::TextureRef> channels;
  std::vector<int> components;
  int level = 0;
  float unit = 1.0f;
};

/// Places of the values that are not zero, one or three floats each, read by the host: of kinds that are no
/// texels.
std::vector<VoxelsRead::Voxel> readOnHost(const VoxelSource& source, const glm::ivec3& resolution) {
  std::vector<VoxelsRead::Voxel> voxels;
  if (const auto* read = std::get_if<VoxelsRead>(&source)) return read->read();
  if (const auto* list = std::get_if<VoxelList>(&source)) {
    std::uint32_t count = 0;
    std::memcpy(&count, list->count->download(0, sizeof(count)).data(), sizeof(count));
    const std::uint64_t items = std::min<std::uint64_t>(count, list->capacity);
    const std::vector<std::byte> bytes =
        list->items->download(0, std::max<std::uint64_t>(items * list->itemBytes, 1));
    for (std::uint64_t i = 0; i < items; ++i) {
      std::uint32_t word = 0;
      std::memcpy(&word, bytes.data() + i * list->itemBytes, sizeof(word));
      voxels.push_back({glm::ivec3(word & 1023u, word >> 10 & 1023u, word >> 20 & 1023u), glm::vec3(1.0f)});
    }
    return voxels;
  }
  if (const auto* bits = std::get_if<VoxelBits>(&source)) {
    const std::vector<std::byte> bytes = bits->stacks->download(bits->level);
    for (int z = 0; z < resolution.z; ++z)
      for (int y = 0; y < resolution.y; ++y)
        for (int x = 0; x < resolution.x; ++x) {
          const std::size_t texel =
              (static_cast<std::size_t>(z / BinaryGrid::kStack) * static_cast<std::size_t>(resolution.y) +
               static_cast<std::size_t>(y)) *
                  static_cast<std::size_t>(resolution.x) +
              static_cast<std::size_t>(x);
          std::uint32_t word = 0;
          std::memcpy(&word,
                      bytes.data() + 16 * texel + 4 * static_cast<std::size_t>(z % BinaryGrid::kStack / 32),
                      sizeof(word));
          if ((word >> (z % 32) & 1u) != 0) voxels.push_back({{x, y, z}, glm::vec3(1.0f)});
        }
    return voxels;
  }
  for (int z = 0; z < resolution.z; ++z)
    for (int y = 0; y < resolution.y; ++y)
      for (int x = 0; x < resolution.x; ++x) voxels.push_back({{x, y, z}, glm::vec3(1.0f)});
  return voxels;
}

FieldTexels texelsOf(PassContext& frame, const Field& field) {
  FieldTexels result;
  if (const auto* texels = std::get_if<VoxelTexels>(&field.source)) {
    for (const VoxelTexels::Channel& channel : texels->channels) {
      result.channels.push_back(texels->textures[static_cast<std::size_t>(channel.texture)]);
      result.components.push_back(channel.component);
    }
    result.level = texels->level;
    result.unit = texels->unit;
    return result;
  }
  const auto* read = std::get_if<VoxelsRead>(&field.source);
  const int channels = read != nullptr ? read->components : 1;
  const glm::ivec3& size = field.box.resolution;
  const GridPlacement all{.resolution = size};
  const auto* list = std::get_if<VoxelList>(&field.source);
  std::vector<float> values(all.voxelCount() * 4);
  for (const VoxelsRead::Voxel& voxel : readOnHost(field.source, size)) {
    float* const value =
        &values[4 * ((static_cast<std::size_t>(voxel.voxel.z) * static_cast<std::size_t>(size.y) +
                      static_cast<std::size_t>(voxel.voxel.y)) *
                         static_cast<std::size_t>(size.x) +
                     static_cast<std::size_t>(voxel.voxel.x))];
    for (int channel = 0; channel < channels; ++channel)
      value[channel] = list != nullptr && list->counts ? value[channel] + 1.0f : voxel.value[channel];
  }
  const gpu::TextureRef texture = frame.volume(size, gpu::Format::rgba32f, "values of a field");
  texture->uploadFloats(0, values);
  for (int channel = 0; channel < channels; ++channel) {
    result.channels.push_back(texture);
    result.components.push_back(channel);
  }
  return result;
}

class LookPass : public Pass {
  // In the order of look_classify.comp and look.comp.
  enum class Emission { colours, ramp };
  enum class Opacity { automatic, field, absorption, solid };
  enum class Filter { nearest, trilinear };
  enum class Cast { ray, cone };

  InVoxels voxels{this, "voxels", "the grid: an output of any kind that is exported"};
  Param<int> field{this, "field", 0, within(0, 99),
                   "which of the fields of the level, in the order of 'vdbexport --list'"};
  Param<int> level{this, "level", 0, within(0, 31),
                   "which level of the grid; 0 is the finest, or the smallest of nested ones"};
  Param<Emission> emission{
      this, "emission", Emission::colours,
      "what voxels emit: the value itself as a colour, or a colour of a ramp from black over blue, green and yellow to white"};
  Param<float> low{this, "low", 0.0f, within(-1e9f, 1e9f), "value at the lower end of the ramp"};
  Param<float> high{this, "high", 1.0f, within(-1e9f, 1e9f), "value at the upper end of the ramp"};
  Param<Opacity> opacity{
      this, "opacity", Opacity::automatic,
      "how opaque a voxel is: as the kind's own field of opacity says; by the value times 'absorption'; opaque where the value is not 0; or the first of these that the kind has"};
  Param<float> absorption{this, "absorption", 1.0f, within(0.0f, 1e9f), "/m", "extinction at the value 1"};
  Param<bool> multiplied{this, "multiplied", false,
                         "the values are multiplied by the opacity already, as radiance is"};
  Param<float> gain{this, "gain", 1.0f, within(0.0f, 1e9f), "factor of what is emitted"};
  Param<Filter> filter{this, "filter", Filter::nearest,
                       "cells as they are, or blended between their middles"};
  Param<Cast> cast{
      this, "cast", Cast::ray,
      "through the middle of each pixel, or through all of it: by means of voxels as large as the pixel is there"};
  Param<bool> faces{this, "faces", false,
                    "nearest cells are shaded by the face that is seen, so that each stands out"};
  Param<float> step{this, "step", 0.5f, within(0.05f, 2.0f),
                    "step as a share of a voxel, but from cell to cell of nearest ones"};
  Param<float> background{this, "background", 0.0f, within(0.0f, 1e9f), "radiance behind the grid"};
  Out<Image> radiance{this, "radiance", "the grid as the camera sees it"};

  Reads readsFrom() const override { return Reads::camera; }
  std::string checkParameters() const override {
    return low < high ? "" : "'low' is not below 'high', the ends of the ramp";
  }

  /// The fields of the level; Error where there is none.
  std::vector<const Field*> fieldsOfLevel(const PortContents& contents) const {
    std::vector<const Field*> fields;
    int coarsest = -1;
    for (const Field& one : contents.fields()) {
      coarsest = std::max(coarsest, one.level);
      if (one.level == level) fields.push_back(&one);
    }
    if (coarsest < 0)
      throw Error(fmt::format("'voxels' is a {} that holds nothing in this scene; expected one with voxels",
                              contents.kind().name));
    if (fields.empty())
      throw Error(fmt::format("'voxels', a {}, has no level {}; expected 0..{}", contents.kind().name,
                              static_cast<int>(level), coarsest));
    return fields;
  }

  const Field& chosen(const std::vector<const Field*>& fields) const {
    if (field < static_cast<int>(fields.size())) return *fields[static_cast<std::size_t>(field)];
    std::vector<std::string> names;
    for (std::size_t i = 0; i < fields.size(); ++i)
      names.push_back(fmt::format("{} ({})", i, fields[i]->name));
    throw Error(fmt::format("'voxels' has no field {}; expected {}", static_cast<int>(field),
                            fmt::join(names, ", ")));
  }

  /// The field of opacity among those of a level, or null.
  static const Field* fogOf(const std::vector<const Field*>& fields) {
    const auto found = std::find_if(fields.begin(), fields.end(),
                                    [](const Field* one) { return one->what->role == PortField::Role::fog; });
    return found == fields.end() ? nullptr : *found;
  }

  Opacity ruleFor(const Field& shown, const Field* fog, const PortKind& kind) const {
    if (opacity == Opacity::field && fog == nullptr)
      throw Error(fmt::format(
          "'opacity field': a {} has no field of opacity; expected 'opacity absorption' or 'opacity solid'",
          kind.name));
    if (opacity != Opacity::automatic) return opacity;
    if (shown.what->role == PortField::Role::density) return Opacity::absorption;
    return fog != nullptr ? Opacity::field : Opacity::solid;
  }

  void run(PassContext& frame) override {
    const PortContents contents = voxels.contents();
    const std::vector<const Field*> fields = fieldsOfLevel(contents);
    const Field& shown = chosen(fields);
    const Field* const fog = fogOf(fields);
    const Opacity rule = ruleFor(shown, fog, contents.kind());
    const gpu::TextureRef classified = classify(frame, shown, rule == Opacity::field ? fog : nullptr, rule);
    const VoxelBox& box = shown.box;
    const CameraView& camera = frame.snapshot().camera;
    const auto columns = static_cast<float>(camera.width), rows = static_cast<float>(camera.height);
    const glm::vec3 corner = camera.direction(0.0f, 0.0f), sides(box.voxelSize);
    radiance = Image{frame.image("voxels"), shown.unit == kRadianceUnit};
    frame.dispatch(
        frame.program(look::kProgram, {},
                      look::Constants{.filterRule = static_cast<int>(static_cast<Filter>(filter)),
                                      .castsCones = cast == Cast::cone,
                                      .shadesFaces = faces}
                          .values()),
        {look::look({.eyeWorld = camera.eye,
                     .stepShare = step,
                     .corner = corner,
                     .coneWidth = 2.0f * camera.tanHalfFov / rows,
                     .perColumn = (camera.direction(columns, 0.0f) - corner) / columns,
                     .gain = gain,
                     .perRow = (camera.direction(0.0f, rows) - corner) / rows,
                     .coarsest = static_cast<float>(classified->description().levels - 1),
                     .low = glm::vec3(box.low),
                     .voxelSize = std::min({sides.x, sides.y, sides.z}),
                     .voxelSides = sides,
                     .background = glm::vec3(background)}),
         look::classified(classified, filter == Filter::nearest ? Sampling::nearest : Sampling::linearMips),
         look::radianceImage(radiance->texture)},
        pixels(frame));
  }

  gpu::TextureRef classify(PassContext& frame, const Field& shown, const Field* fog, Opacity rule) const {
    const glm::ivec3& size = shown.box.resolution;
    const FieldTexels values = texelsOf(frame, shown);
    const FieldTexels opacities = fog != nullptr ? texelsOf(frame, *fog) : values;
    const std::size_t channels = values.channels.size();
    const auto channel = [&](std::size_t i) { return std::min(i, channels - 1); };
    const int levels = cast == Cast::cone ? gpu::fullLevelCount(size.x, size.y, size.z) : 1;
    const gpu::TextureRef result =
        frame.volume(size, gpu::Format::rgba32f, "voxels that emit and absorb", levels);
    frame.dispatch(
        frame.program(look_classify::kProgram, {},
                      look_classify::Constants{.emission = static_cast<int>(static_cast<Emission>(emission)),
                                               .opacityRule = static_cast<int>(rule) - 1}
                          .values()),
        {look_classify::classify({.resolution = size,
                                  .channels = static_cast<int>(channels),
                                  .components = {values.components[0], values.components[channel(1)],
                                                 values.components[channel(2)]},
                                  .level = values.level,
                                  .unit = values.unit,
                                  .low = low,
                                  .high = high,
                                  .absorption = absorption,
                                  .voxelSize = static_cast<float>(std::min(
                                      {shown.box.voxelSize.x, shown.box.voxelSize.y, shown.box.voxelSize.z})),
                                  .opacityComponent = opacities.components[0],
                                  .opacityLevel = opacities.level,
                                  .multiplied = multiplied,
                                  .direction = shown.what->role == PortField::Role::direction}),
         look_classify::value0(values.channels[0], Sampling::nearest),
         look_classify::value1(values.channels[channel(1)], Sampling::nearest),
         look_classify::value2(values.channels[channel(2)], Sampling::nearest),
         look_classify::opacityOf(opacities.channels[0], Sampling::nearest),
         look_classify::classified(result, 0)},
        size);
    for (int i = 1; i < levels; ++i) {
      const glm::ivec3 coarse = levelResolution(size, i);
      frame.dispatch(
          frame.program(look_mean::kProgram),
          {look_mean::mean({.coarse = coarse, .fineLevel = i - 1, .fine = levelResolution(size, i - 1)}),
           look_mean::classified(result, Sampling::nearest), look_mean::meanImage(result, i)},
          coarse);
    }
    return result;
  }
};

}  // namespace

void addLook(TechniqueRegistry& registry) {
  registry.add<LookPass>(
      "look", "Ray and cone casting of any grid's voxels with a transfer function (thesis Sec. 2.3)");
}

}  // namespace lumivox::voxel_cone_tracing
