// After a discard, derivatives are undefined in the neighbours of the discarded pixel in its 2 x 2 quad (GLSL
// 4.50, 6.4). So is the mip level of a texture sample that states no level. Some drivers compute them all the
// same; on the others images have wrong texels along the edge of every mask.
#include <fmt/format.h>

#include <map>
#include <optional>
#include <spirv/unified1/spirv.hpp>
#include <vector>

#include "lumivox/base/error.h"
#include "stage.h"

namespace lumivox::shaderpack {
namespace {

using Id = std::uint32_t;

bool discards(spv::Op operation) {
  return operation == spv::OpKill || operation == spv::OpTerminateInvocation;
}

bool samplesByDerivatives(spv::Op operation) {
  switch (operation) {
    case spv::OpImageSampleImplicitLod:
    case spv::OpImageSampleDrefImplicitLod:
    case spv::OpImageSampleProjImplicitLod:
    case spv::OpImageSampleProjDrefImplicitLod:
    case spv::OpImageQueryLod:
      return true;
    default:
      return false;
  }
}

/// Walks the instructions in the order of the module. That is the order of execution, since GLSL jumps back
/// in loops only.
class Walk {
 public:
  explicit Walk(const std::vector<std::uint32_t>& words) {
    Id function = 0;
    for (std::size_t at = 5; at < words.size(); at += words[at] >> 16) {
      const Instruction instruction{static_cast<spv::Op>(words[at] & 0xffffu), &words[at]};
      const std::uint32_t* w = instruction.words;
      if (instruction.operation == spv::OpEntryPoint) entry_ = w[2];
      if (instruction.operation == spv::OpName) names_[w[1]] = reinterpret_cast<const char*>(w + 2);
      if (instruction.operation == spv::OpLoad) variables_[w[2]] = w[3];
      if (instruction.operation == spv::OpFunction) function = w[2];
      if (function != 0) bodies_[function].push_back(instruction);
      if (instruction.operation == spv::OpFunctionEnd) function = 0;
    }
  }

  /// The first use of derivatives that a discard may have made undefined: the sampler's name, or "" for an
  /// explicit derivative. Nothing if there is none.
  std::optional<std::string> run() {
    follow(entry_);
    if (late_.empty()) return std::nullopt;
    return late_.front();
  }

 private:
  struct Instruction {
    spv::Op operation;
    const std::uint32_t* words;
  };
  struct Loop {
    Id end;
    bool discards = false;
    std::vector<std::string> needs;  ///< uses of derivatives; in the next iteration they follow the discard
  };

  void follow(Id function) {
    for (const Instruction& instruction : bodies_[function]) {
      const std::uint32_t* w = instruction.words;
      if (instruction.operation == spv::OpLabel && !loops_.empty() && loops_.back().end == w[1]) {
        const Loop loop = loops_.back();
        loops_.pop_back();
        if (loop.discards) late_.insert(late_.end(), loop.needs.begin(), loop.needs.end());
        if (!loops_.empty()) {
          loops_.back().discards |= loop.discards;
          loops_.back().needs.insert(loops_.back().needs.end(), loop.needs.begin(), loop.needs.end());
        }
      } else if (instruction.operation == spv::OpLoopMerge) {
        loops_.push_back({w[1], false, {}});
      } else if (instruction.operation == spv::OpFunctionCall) {
        follow(w[3]);  // GLSL has no recursion
      } else if (discards(instruction.operation)) {
        discarded_ = true;
        if (!loops_.empty()) loops_.back().discards = true;
      } else if (samplesByDerivatives(instruction.operation)) {
        need(names_[variables_[w[3]]]);
      } else if (instruction.operation >= spv::OpDPdx && instruction.operation <= spv::OpFwidthCoarse) {
        need("");
      }
    }
  }

  void need(const std::string& name) {
    if (discarded_) late_.push_back(name);
    if (!loops_.empty()) loops_.back().needs.push_back(name);
  }

  Id entry_ = 0;
  std::map<Id, std::vector<Instruction>> bodies_;
  std::map<Id, std::string> names_;
  std::map<Id, Id> variables_;  ///< that a loaded value comes from
  std::vector<Loop> loops_;     ///< those that enclose the current instruction
  bool discarded_ = false;
  std::vector<std::string> late_;
};

}  // namespace

void requireDerivativesBeforeDiscard(const std::vector<std::uint32_t>& words, const StageSource& source) {
  if (source.stage != gpu::Stage::fragment) return;
  const std::optional<std::string> late = Walk(words).run();
  if (!late) return;
  throw Error(fmt::format(
      "{}: error: {} after a discard, where derivatives are undefined; expected it before the first discard, or "
      "textureGrad or textureLod",
      late->empty() ? source.source->entry.string() : source.source->placeOf(*late).text(),
      late->empty() ? "a derivative is taken" : "'" + *late + "' is sampled by derivatives"));
}

}  // namespace lumivox::shaderpack
