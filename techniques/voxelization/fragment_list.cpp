#include "fragment_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "lumivox/base/error.h"
#include "voxelization_shaders.h"

namespace lumivox::voxelization {

namespace copyShader = shaders::voxelization::copy;
namespace countShader = shaders::voxelization::copy_count;
namespace finishShader = shaders::voxelization::finish;

namespace {

void requireListable(std::uint64_t fragments) {
  if (fragments > 0x7fffffffu) throw Error(fmt::format("{} fragments do not fit into one list", fragments));
}

}  // namespace

gpu::BufferRef countBuffer(PassContext& frame, const char* label) {
  return frame.buffer(kWantedOffset + sizeof(std::uint32_t), label);
}

void copyCount(PassContext& frame, const gpu::Buffer& from, const gpu::Buffer& to) {
  frame.dispatch(frame.program(countShader::kProgram), {countShader::from(from), countShader::to(to)},
                 {1, 1, 1});
}

std::uint64_t roomFor(std::uint64_t wanted, bool moves) {
  requireListable(wanted);
  return moves ? wanted + wanted / 8 : wanted;
}

VoxelFragments listBehind(PassContext& frame, const GridPlacement& grid, const VoxelFragments* base,
                          std::uint64_t more) {
  VoxelFragments list;
  list.grid = grid;
  list.workGroupSize = kWorkGroupSize;
  list.capacity = more + (base != nullptr ? base->capacity : 0);
  requireListable(list.capacity);
  list.count = countBuffer(frame, "voxel fragment count");
  list.fragments = frame.buffer(std::max<std::uint64_t>(list.capacity, 1) * VoxelFragments::kFragmentBytes,
                                "voxel fragments");
  list.count->clear();
  if (base == nullptr) return list;
  assert(base->workGroupSize == kWorkGroupSize);
  list.coverage = base->coverage;
  list.reflected = base->reflected;  // of the first fragments, which are the same
  frame.dispatchIndirect(
      frame.program(copyShader::kProgram),
      {copyShader::baseCount(base->count), copyShader::baseFragments(base->fragments), appending(list)},
      *base->count, VoxelFragments::kArgumentsBytes);
  return list;
}

void finishCount(PassContext& frame, const gpu::Buffer& count, std::uint64_t room) {
  frame.dispatch(
      frame.program(finishShader::kProgram),
      {finishShader::count(count), finishShader::parameters({static_cast<int>(room), kWorkGroupSize})},
      {1, 1, 1});
}

void finishList(PassContext& frame, const VoxelFragments& list) {
  finishCount(frame, *list.count, list.capacity);
}

}  // namespace lumivox::voxelization
