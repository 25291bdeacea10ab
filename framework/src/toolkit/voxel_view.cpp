#include "lumivox/toolkit/voxel_view.h"

#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/pipeline.h"
#include "toolkit_shaders.h"

namespace lumivox {

namespace voxels_largest = shaders::toolkit::voxels_largest;
namespace voxels_mark = shaders::toolkit::voxels_mark;
namespace voxels_view = shaders::toolkit::voxels_view;
using gpu::Sampling;
using gpu::TextureRef;
using View = voxels_view::Variant;

namespace {

std::string sizeText(const glm::ivec3& size) {
  return fmt::format("{} x {} x {}", size.x, size.y, size.z);
}

/// Dispatches one invocation for each item along each axis; a barrier follows.
template <class Variant>
void run(const VoxelCanvas& canvas, const Variant& variant, const shader::BindingSet& bindings,
         const glm::ivec3& items) {
  const shader::BoundProgram& program = canvas.shaders.program(Variant::kOf, variant.key());
  const glm::ivec3& group = program.program->groupSize();
  canvas.shaders.dispatch(program, shader::ShaderLibrary::Bindings(bindings),
                          glm::uvec3((items + group - 1) / group));
  canvas.shaders.device().barrier();
}

TextureRef imageFor(const VoxelCanvas& canvas, int width, int height) {
  return canvas.texture({.format = gpu::Format::rgba32f, .width = width, .height = height},
                        "voxels as they are seen");
}

TextureRef seen(const VoxelCanvas& canvas, const CameraView& camera, const VoxelLook& look,
                const View& variant, const shader::BindingSet& voxels) {
  TextureRef image = imageFor(canvas, camera.width, camera.height);
  run(canvas, variant, {look.rays(camera), voxels, voxels_view::seenImage(image)},
      {camera.width, camera.height, 1});
  return image;
}

}  // namespace

VoxelCanvas::VoxelCanvas(PassContext& frame)
    : shaders(frame.shaders()),
      texture([&frame](const gpu::TextureDescription& description, const std::string& label) {
        return frame.texture(description, label);
      }) {}

VoxelCanvas::VoxelCanvas(shader::ShaderLibrary& library)
    : shaders(library),
      texture([&library](const gpu::TextureDescription& description, const std::string& label) {
        return std::make_shared<gpu::Texture>(library.device(), description, label);
      }) {}

std::vector<const PortContents::Field*> fieldsOfLevel(const PortContents& contents, int level) {
  std::vector<const PortContents::Field*> fields;
  int coarsest = -1;
  for (const PortContents::Field& field : contents.fields()) {
    coarsest = std::max(coarsest, field.level);
    if (field.level == level) fields.push_back(&field);
  }
  if (coarsest < 0)
    throw Error(
        fmt::format("a {} holds nothing in this scene; expected one with voxels", contents.kind().name));
  if (fields.empty())
    throw Error(fmt::format("a {} has no level {}; expected 0..{}", contents.kind().name, level, coarsest));
  return fields;
}

// ---- fields --------------------------------------------------------------------------------------------

VoxelField::VoxelField(const VoxelCanvas& canvas, const PortContents::Field& field)
    : name_(field.name), box_(field.box) {
  std::visit([&](const auto& source) { take(canvas, source); }, field.source);
}

void VoxelField::take(const VoxelCanvas&, const VoxelTexels& source) {
  if (source.textures.empty() || source.textures.size() > textures_.size() ||
      (source.channels.size() != 1 && source.channels.size() != 3))
    throw Error(fmt::format("'{}' has {} channels of {} textures; expected 1 or 3 of at most 3", name_,
                            source.channels.size(), source.textures.size()));
  level_ = source.level;
  unit_ = source.unit;
  channels_ = static_cast<int>(source.channels.size());
  textures_.fill(source.textures.front());
  for (std::size_t i = 0; i < source.textures.size(); ++i) {
    const gpu::TextureDescription& is = source.textures[i]->description();
    const glm::ivec3 size = levelResolution({is.width, is.height, is.depth}, level_);
    if (is.kind != gpu::TextureKind::d3 || size != box_.resolution)
      throw Error(fmt::format("'{}' is of {} voxels, but its texture of {}", name_, sizeText(box_.resolution),
                              sizeText(size)));
    textures_[i] = source.textures[i];
  }
  for (int c = 0; c < channels_; ++c) {
    textureOf_[c] = source.channels[static_cast<std::size_t>(c)].texture;
    componentOf_[c] = source.channels[static_cast<std::size_t>(c)].component;
  }
}

void VoxelField::take(const VoxelCanvas&, const VoxelBits& source) {
  source_ = View::sourceStacks;
  level_ = source.level;
  textures_[0] = source.stacks;
}

void VoxelField::take(const VoxelCanvas& canvas, const VoxelList& source) {
  source_ = View::sourceMarks;
  counts_ = source.counts;
  const glm::ivec3& size = box_.resolution;
  textures_[0] = canvas.texture(
      {gpu::TextureKind::d3, gpu::Format::r32ui, size.x, size.y, counts_ ? size.z : (size.z + 31) / 32},
      "marks of voxels");
  textures_[0]->clear(glm::vec4(0.0f));
  // Rows of work groups, as listIndex() of common/list.glsl counts them.
  constexpr std::uint64_t kGroup = voxels_mark::kGroupSize.x, kRow = 65535 * kGroup;
  run(canvas, voxels_mark::Variant{},
      {voxels_mark::itemCount(source.count), voxels_mark::items(source.items),
       voxels_mark::marking({static_cast<std::uint32_t>(source.capacity),
                             static_cast<std::uint32_t>(source.itemBytes / sizeof(std::uint32_t)), counts_}),
       voxels_mark::marks(textures_[0])},
      {std::min(source.capacity, kRow), (source.capacity + kRow - 1) / kRow, 1});
}

void VoxelField::take(const VoxelCanvas& canvas, const VoxelsFilled&) {
  makeVolume(canvas, gpu::Format::r8);
  textures_[0]->clear(glm::vec4(1.0f));
}

void VoxelField::take(const VoxelCanvas& canvas, const VoxelsRead& source) {
  channels_ = source.components;
  componentOf_ = {0, 1, 2};
  const std::size_t stride = channels_ == 1 ? 1 : 4;  // no texture has three components
  makeVolume(canvas, stride == 1 ? gpu::Format::r32f : gpu::Format::rgba32f);
  const glm::u64vec3 size(box_.resolution);
  std::vector<float> values(stride * size.x * size.y * size.z, 0.0f);
  for (const VoxelsRead::Voxel& one : source.read()) {
    if (glm::any(glm::lessThan(one.voxel, glm::ivec3(0))) ||
        glm::any(glm::greaterThanEqual(one.voxel, box_.resolution)))
      throw Error(fmt::format("'{}' has a voxel ({}, {}, {}) outside its grid of {}", name_, one.voxel.x,
                              one.voxel.y, one.voxel.z, sizeText(box_.resolution)));
    const glm::u64vec3 at(one.voxel);
    for (int c = 0; c < channels_; ++c)
      values[stride * (at.x + size.x * (at.y + size.y * at.z)) + static_cast<std::size_t>(c)] = one.value[c];
  }
  textures_[0]->uploadFloats(0, values);
}

/// Error if it does not fit into memory.
void VoxelField::makeVolume(const VoxelCanvas& canvas, gpu::Format format) {
  const glm::ivec3& size = box_.resolution;
  textures_.fill(canvas.texture({gpu::TextureKind::d3, format, size.x, size.y, size.z}, "values of voxels"));
}

shader::BindingSet VoxelField::bindings() const {
  shader::BindingSet set{voxels_view::fieldParameters({.gridLow = glm::vec3(box_.low),
                                                       .fieldUnit = unit_,
                                                       .voxelSides = glm::vec3(box_.voxelSize),
                                                       .fieldLevel = level_,
                                                       .gridResolution = box_.resolution,
                                                       .fieldChannels = channels_,
                                                       .textureOf = textureOf_,
                                                       .marksCount = counts_,
                                                       .componentOf = componentOf_})};
  if (source_ == View::sourceStacks) set.add(voxels_view::fieldStacks(textures_[0], Sampling::nearest));
  if (source_ == View::sourceMarks) set.add(voxels_view::fieldMarks(textures_[0], Sampling::nearest));
  if (source_ == View::sourceTexels) {
    set.add(voxels_view::field0(textures_[0], Sampling::nearest));
    set.add(voxels_view::field1(textures_[1], Sampling::nearest));
    set.add(voxels_view::field2(textures_[2], Sampling::nearest));
  }
  return set;
}

// ---- transfer functions --------------------------------------------------------------------------------

VoxelTransfer::VoxelTransfer(const VoxelCanvas& canvas, const PortContents::Field& field, const Rule& rule)
    : values_(canvas, field), rule_(rule), isDirection_(field.what->role == PortField::Role::direction) {
  if (rule.opacity != Opacity::field) return;
  opacities_.emplace_back(canvas, *rule.opacityField);
  if (opacities_.front().source_ != View::sourceTexels)
    throw Error(fmt::format("'{}' holds no numbers that could be opacities", rule.opacityField->name));
}

shader::BindingSet VoxelTransfer::bindings() const {
  const VoxelField& opacities = opacities_.empty() ? values_ : opacities_.front();
  shader::BindingSet set{values_.bindings(),
                         voxels_view::transferParameters({.rampLow = rule_.rampLow,
                                                          .rampHigh = rule_.rampHigh,
                                                          .absorption = rule_.absorption,
                                                          .opacityComponent = opacities.componentOf_.x,
                                                          .opacityLevel = opacities.level_,
                                                          .isMultiplied = rule_.multiplied,
                                                          .isDirection = isDirection_})};
  if (!opacities_.empty())
    set.add(voxels_view::fieldOpacity(opacities.textures_[static_cast<std::size_t>(opacities.textureOf_.x)],
                                      Sampling::nearest));
  return set;
}

// ---- pictures ------------------------------------------------------------------------------------------

shader::BindingSet VoxelLook::rays(const CameraView& camera) const {
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  const glm::vec3 corner = camera.direction(0.0f, 0.0f);
  return {voxels_view::voxelRays({.eye = camera.eye,
                                  .pixelWidth = 2.0f * camera.tanHalfFov / height,
                                  .corner = corner,
                                  .cut = cut,
                                  .perColumn = (camera.direction(width, 0.0f) - corner) / width,
                                  .above = above,
                                  .perRow = (camera.direction(0.0f, height) - corner) / height,
                                  .shading = static_cast<int>(shading),
                                  .gain = gain,
                                  .background = background})};
}

TextureRef firstVoxels(const VoxelCanvas& canvas, const CameraView& camera, const VoxelField& field,
                       const VoxelLook& look, bool lobes) {
  return seen(canvas, camera, look,
              {.shape = lobes ? View::shapeLobes : View::shapeCubes, .source = field.source()},
              field.bindings());
}

TextureRef blendedVoxels(const VoxelCanvas& canvas, const CameraView& camera, const VoxelTransfer& transfer,
                         const VoxelLook& look) {
  return seen(
      canvas, camera, look,
      {.shape = View::shapeBlended, .opacity = transfer.opacity(), .source = transfer.values().source()},
      transfer.bindings());
}

std::vector<ImageBuffer> largestAlongAxes(const VoxelCanvas& canvas, const VoxelField& field) {
  const glm::ivec3& size = field.resolution();
  std::vector<ImageBuffer> views;
  for (const auto& [axis, width, height] :
       {std::array{0, size.z, size.y}, std::array{1, size.x, size.z}, std::array{2, size.x, size.y}}) {
    const TextureRef image = imageFor(canvas, width, height);
    run(canvas, voxels_largest::Variant{.source = field.source()},
        {field.bindings(), voxels_largest::columns({axis}), voxels_largest::largest(image)},
        {width, height, 1});
    views.push_back(imageOf(*image));
  }
  return views;
}

}  // namespace lumivox
