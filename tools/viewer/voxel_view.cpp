#include "viewer/voxel_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "lumivox/base/error.h"
#include "lumivox/shader/library.h"
#include "viewer_shaders.h"

namespace lumivox::viewer {
namespace {

namespace program = shaders::viewer::voxels;

constexpr std::array kHarmonics{"Y00", "Y1-1", "Y10", "Y11"};

std::string sizeText(const glm::ivec3& size) {
  return fmt::format("{} x {} x {}", size.x, size.y, size.z);
}

/// A source as the shader reads it: textures that are there, or one that is made.
class ReadableSource {
 public:
  ReadableSource(gpu::Device& device, const PortContents::Field& field)
      : device_(device), name_(field.name), resolution_(field.box.resolution) {
    std::visit([&](const auto& source) { take(source); }, field.source);
  }

  gpu::TextureRef stacks;  ///< null: the others
  std::array<gpu::TextureRef, 3> textures;
  glm::ivec3 textureOf{0}, componentOf{0};
  int channels = 1, level = 0;
  float unit = 1.0f;

 private:
  void take(const VoxelTexels& source) {
    if (source.textures.empty() || source.textures.size() > textures.size() ||
        (source.channels.size() != 1 && source.channels.size() != 3))
      throw Error(fmt::format("'{}' has {} channels of {} textures; expected 1 or 3 of at most 3", name_,
                              source.channels.size(), source.textures.size()));
    level = source.level;
    unit = source.unit;
    channels = static_cast<int>(source.channels.size());
    textures.fill(source.textures.front());
    for (std::size_t i = 0; i < source.textures.size(); ++i) {
      const gpu::TextureDescription& is = source.textures[i]->description();
      const glm::ivec3 size = levelResolution({is.width, is.height, is.depth}, level);
      if (is.kind != gpu::TextureKind::d3 || size != resolution_)
        throw Error(fmt::format("'{}' is of {} voxels, but its texture of {}", name_, sizeText(resolution_),
                                sizeText(size)));
      textures[i] = source.textures[i];
    }
    for (int c = 0; c < channels; ++c) {
      textureOf[c] = source.channels[static_cast<std::size_t>(c)].texture;
      componentOf[c] = source.channels[static_cast<std::size_t>(c)].component;
    }
  }
  void take(const VoxelBits& source) {
    stacks = source.stacks;
    level = source.level;
  }
  void take(const VoxelList& source) {
    std::vector<float> values = emptyVoxels(1);
    std::uint32_t count = 0;
    const std::vector<std::byte> head = source.count->download(0, sizeof(count));
    std::memcpy(&count, head.data(), sizeof(count));
    const std::uint64_t items = std::min<std::uint64_t>(count, source.capacity);
    // Through a small buffer: a list may be as large as the device's memory.
    constexpr std::uint64_t kAtOnce = std::uint64_t{1} << 18;
    for (std::uint64_t first = 0; first < items; first += kAtOnce) {
      const std::uint64_t some = std::min(items - first, kAtOnce);
      const std::vector<std::byte> bytes =
          source.items->download(first * source.itemBytes, some * source.itemBytes);
      for (std::uint64_t i = 0; i < some; ++i) {
        std::uint32_t packed = 0;
        std::memcpy(&packed, bytes.data() + i * source.itemBytes, sizeof(packed));
        float& value = values[indexOf({packed & 1023u, packed >> 10 & 1023u, packed >> 20 & 1023u})];
        value = source.counts ? value + 1.0f : 1.0f;
      }
    }
    upload(values);
  }
  void take(const VoxelsFilled&) {
    std::vector<float> values = emptyVoxels(1);
    std::fill(values.begin(), values.end(), 1.0f);
    upload(values);
  }
  void take(const VoxelsRead& source) {
    channels = source.components;
    componentOf = {0, 1, 2};
    const std::size_t stride = channels == 1 ? 1 : 4;  // no texture has three components
    std::vector<float> values = emptyVoxels(stride);
    for (const VoxelsRead::Voxel& one : source.read()) {
      const std::size_t at = stride * indexOf(one.voxel);
      for (int c = 0; c < channels; ++c) values[at + static_cast<std::size_t>(c)] = one.value[c];
    }
    upload(values);
  }

  std::vector<float> emptyVoxels(std::size_t stride) {
    const glm::u64vec3 size(resolution_);
    gpu::TextureDescription description;
    description.kind = gpu::TextureKind::d3;
    description.format = stride == 1 ? gpu::Format::r32f : gpu::Format::rgba32f;
    description.width = resolution_.x;
    description.height = resolution_.y;
    description.depth = resolution_.z;
    // First, since it refuses what does not fit.
    textures.fill(std::make_shared<gpu::Texture>(device_, description, "voxels that are looked at"));
    return std::vector<float>(stride * size.x * size.y * size.z, 0.0f);
  }
  std::size_t indexOf(const glm::ivec3& voxel) const {
    if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, resolution_)))
      throw Error(fmt::format("'{}' has a voxel ({}, {}, {}) outside its grid of {}", name_, voxel.x, voxel.y,
                              voxel.z, sizeText(resolution_)));
    const glm::u64vec3 at(voxel), size(resolution_);
    return at.x + size.x * (at.y + size.y * at.z);
  }
  void upload(const std::vector<float>& values) { textures[0]->uploadFloats(0, values); }

  gpu::Device& device_;
  std::string name_;
  glm::ivec3 resolution_;
};

const PortContents::Field& fieldNamed(const PortContents& contents, const std::string& name, int level) {
  std::vector<std::string> names;
  int finest = 0, coarsest = -1;
  for (const PortContents::Field& field : contents.fields()) {
    if (std::find(names.begin(), names.end(), field.name) == names.end()) names.push_back(field.name);
    if (field.name != name && field.what->name != name) continue;
    if (field.level == level) return field;
    finest = coarsest < 0 ? field.level : std::min(finest, field.level);
    coarsest = std::max(coarsest, field.level);
  }
  if (coarsest >= 0)
    throw Error(fmt::format("voxels {}: no level {}; expected one of {}..{}", name, level, finest, coarsest));
  throw Error(fmt::format("voxels {}: a {} has no such field{}", name, contents.kind().name,
                          names.empty() ? "" : fmt::format("; expected one of {}", fmt::join(names, ", "))));
}

/// The field Y00 of a port whose harmonics share their textures, component by component.
const PortContents::Field& harmonicsOf(const PortContents& contents, int level) {
  const PortContents::Field& first = fieldNamed(contents, kHarmonics[0], level);
  for (std::size_t k = 0; k < kHarmonics.size(); ++k) {
    const auto* const texels = std::get_if<VoxelTexels>(&fieldNamed(contents, kHarmonics[k], level).source);
    const auto* const all = std::get_if<VoxelTexels>(&first.source);
    const bool fits = texels != nullptr && all != nullptr && texels->textures == all->textures &&
                      std::all_of(texels->channels.begin(), texels->channels.end(),
                                  [&](const VoxelTexels::Channel& channel) {
                                    return channel.component == static_cast<int>(k);
                                  });
    if (!fits || texels->channels.size() != 3)
      throw Error(
          fmt::format("voxels {}: {} is not component {} of three textures", kLobes, kHarmonics[k], k));
  }
  return first;
}

}  // namespace

std::vector<std::string> drawnFields(const PortKind& kind) {
  std::vector<std::string> names;
  for (const PortField& field : kind.fields) names.push_back(field.name);
  if (std::all_of(kHarmonics.begin(), kHarmonics.end(), [&](const char* name) {
        return std::find(names.begin(), names.end(), name) != names.end();
      }))
    names.insert(names.begin(), kLobes);
  return names;
}

struct VoxelView::State {
  explicit State(gpu::Device& of) : device(of), library(of) {}
  gpu::Device& device;
  shader::ShaderLibrary library;
};

VoxelView::VoxelView(gpu::Device& device) : state_(std::make_unique<State>(device)) {}
VoxelView::~VoxelView() = default;

VoxelPicture VoxelView::draw(const PortContents& contents, const std::string& name, int level, float above,
                             const CameraView& camera) {
  const bool lobes = name == kLobes;
  const PortContents::Field& field = lobes ? harmonicsOf(contents, level) : fieldNamed(contents, name, level);
  const ReadableSource source(state_->device, field);
  const glm::vec3 corner = camera.direction(0.0f, 0.0f);
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  program::Variant variant;
  variant.shape = lobes ? program::Variant::shapeLobes : program::Variant::shapeCubes;
  variant.source = source.stacks ? program::Variant::sourceBits : program::Variant::sourceTexels;
  gpu::TextureDescription description;
  description.format = gpu::Format::rgba32f;
  description.width = camera.width;
  description.height = camera.height;
  const auto image = std::make_shared<gpu::Texture>(state_->device, description, "voxels as they are seen");
  const glm::uvec3 groups((camera.width + program::kGroupSize.x - 1) / program::kGroupSize.x,
                          (camera.height + program::kGroupSize.y - 1) / program::kGroupSize.y, 1);
  const auto parameters = program::parameters({.gridLow = glm::vec3(field.box.low),
                                               .unit = source.unit,
                                               .voxelSize = glm::vec3(field.box.voxelSize),
                                               .level = source.level,
                                               .resolution = field.box.resolution,
                                               .above = above,
                                               .eye = camera.eye,
                                               .pixelAngle = 2.0f * camera.tanHalfFov / height,
                                               .corner = corner,
                                               .channels = source.channels,
                                               .right = (camera.direction(width, 0.0f) - corner) / width,
                                               .down = (camera.direction(0.0f, height) - corner) / height,
                                               .textureOf = source.textureOf,
                                               .componentOf = source.componentOf});
  state_->device.barrier();  // what passes wrote is read
  state_->library.dispatch(
      state_->library.program(program::kProgram, variant.key()),
      {parameters, program::stacks(source.stacks, gpu::Sampling::nearest),
       program::first(source.textures[0], gpu::Sampling::nearest),
       program::second(source.textures[1], gpu::Sampling::nearest),
       program::third(source.textures[2], gpu::Sampling::nearest), program::values(image)},
      groups);
  state_->device.barrier();
  const std::vector<float> texels = image->downloadFloats();
  VoxelPicture picture;
  const int channels = lobes ? 3 : source.channels;
  picture.values = ImageBuffer(camera.width, camera.height, channels);
  picture.brightness = ImageBuffer(camera.width, camera.height, 1);
  for (std::size_t pixel = 0; pixel < picture.brightness.pixelCount(); ++pixel) {
    for (int c = 0; c < channels; ++c)
      picture.values.values()[pixel * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)] =
          texels[4 * pixel + static_cast<std::size_t>(c)];
    picture.brightness.values()[pixel] = texels[4 * pixel + 3];
  }
  picture.quantity =
      lobes ? "spherical harmonics in the direction of each point of the lobe" : field.what->quantity;
  picture.unit = field.unit;
  picture.isDirection = field.what->role == PortField::Role::direction;
  return picture;
}

}  // namespace lumivox::viewer
