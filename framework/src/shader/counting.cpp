#include "shader/counting.h"

#include <fmt/format.h>

#include <algorithm>

namespace lumivox {

void add(Work& sum, const Work& more) {
  for (const auto& [name, count] : more) sum[name] += count;
}

}  // namespace lumivox

namespace lumivox::shader {
namespace {

using gpu::ResourceBinding;

const char* filterOf(const ResourceBinding::Sampled& sampled, TextureAccess::Kind kind) {
  if (kind == TextureAccess::Kind::fetch) return "nearest";
  switch (sampled.sampling) {
    case gpu::Sampling::nearest:
      return "nearest";
    case gpu::Sampling::linear:
    case gpu::Sampling::linearBorder:
    case gpu::Sampling::linearOneMip:
      return "linear";
    case gpu::Sampling::linearMips:
    case gpu::Sampling::linearMipsRepeat:
    case gpu::Sampling::linearMipsBorder:
      return sampled.texture->description().levels > 1 ? "mips" : "linear";
    case gpu::Sampling::shadow:
      return "shadow";
  }
  return "";
}

/// The name under which an access is counted: it depends on the bound resource.
std::string nameOf(const TextureAccess& access, const std::vector<ResourceBinding>& bound) {
  const bool isSample =
      access.kind == TextureAccess::Kind::sample || access.kind == TextureAccess::Kind::fetch;
  for (const ResourceBinding& binding : bound) {
    if (binding.binding != access.binding) continue;
    const auto* sampled = std::get_if<ResourceBinding::Sampled>(&binding.resource);
    const auto* image = std::get_if<ResourceBinding::StorageImage>(&binding.resource);
    if (isSample ? sampled == nullptr : image == nullptr) continue;
    const gpu::TextureDescription& d = (isSample ? sampled->texture : image->texture)->description();
    // Layers of an array count as 2D images.
    const char* kind = d.kind == gpu::TextureKind::d3 ? "d3" : "d2";
    if (isSample)
      return fmt::format("texture_samples_{}_{}_{}", kind, gpu::name(d.format),
                         filterOf(*sampled, access.kind));
    return fmt::format("{}_{}_{}", access.kind == TextureAccess::Kind::read ? "image_reads" : "image_writes",
                       kind, gpu::name(d.format));
  }
  return isSample                                   ? "texture_samples"
         : access.kind == TextureAccess::Kind::read ? "image_reads"
                                                    : "image_writes";
}

}  // namespace

CountingProgram::CountingProgram(gpu::Device& device, const PackedProgram& packed,
                                 const std::vector<gpu::StageCode>& stages) {
  for (const PackedBinding& binding : packed.bindings)
    if (binding.kind == BindingKind::storage) binding_ = std::max(binding_, binding.binding + 1);
  std::size_t blocks = 0;
  for (const gpu::StageCode& stage : stages) {
    stages_.push_back(
        {stage.stage, instrument(stage.spirv, binding_, static_cast<std::uint32_t>(2 * blocks))});
    blocks += stages_.back().code.blocks.size();
  }
  counters_ = std::make_unique<gpu::Buffer>(device, counterBytes(blocks), "counters of operations");
  counters_->clear();
}

std::vector<gpu::StageCode> CountingProgram::stages() const {
  std::vector<gpu::StageCode> codes;
  for (const Stage& stage : stages_) codes.push_back({stage.stage, stage.code.spirv, {}});
  return codes;
}

ResourceBinding CountingProgram::counters() const {
  return {"counters of operations", binding_, ResourceBinding::Storage{counters_.get()}};
}

Work CountingProgram::take(const std::vector<ResourceBinding>& bound) {
  const auto words = counters_->downloadValues<std::uint32_t>();
  counters_->clear();
  Work work;
  std::size_t counter = 0;
  for (const Stage& stage : stages_) {
    for (std::size_t i = 0; i < stage.code.blocks.size(); ++i, ++counter) {
      const double times = static_cast<double>(words[2 * counter]) + 0x1p32 * words[2 * counter + 1];
      if (times == 0.0) continue;
      const BlockWork& block = stage.code.blocks[i];
      for (const auto& [name, count] : block.work) work[name] += count * times;
      for (const auto& [access, count] : block.access) work[nameOf(access, bound)] += count * times;
      if (i != stage.code.entry) continue;
      if (stage.stage == gpu::Stage::fragment) work["fragments"] += times;
      if (stage.stage == gpu::Stage::vertex) work["vertices"] += times;
      if (stage.stage == gpu::Stage::compute) work["work_groups"] += times / stage.code.groupSize;
    }
  }
  work[stages_.front().stage == gpu::Stage::compute ? "dispatches" : "draws"] += 1.0;
  return work;
}

}  // namespace lumivox::shader
