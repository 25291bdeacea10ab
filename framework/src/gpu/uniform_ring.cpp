#include "gpu/uniform_ring.h"

#include <cassert>

namespace lumivox::gpu {

UniformRing::UniformRing(Fences& fences, std::size_t segmentBytes, std::size_t alignment)
    : fences_(fences), segmentBytes_(segmentBytes), alignment_(alignment) {
  assert(segmentBytes % alignment == 0);
}

void UniformRing::reserve(std::size_t bytes) {
  assert(bytes <= segmentBytes_);
  if (head_ + bytes > segmentBytes_) {
    fences_.insert(segmentSerial_ % kSegments);
    ++segmentSerial_;
    fences_.wait(segmentSerial_ % kSegments);
    head_ = 0;
  }
  reserved_ = bytes;
}

std::size_t UniformRing::place(std::size_t bytes) {
  const std::size_t room = roomFor(bytes);
  assert(room <= reserved_ && "a block without a reservation could be fenced before its command");
  const std::size_t offset = segmentSerial_ % kSegments * segmentBytes_ + head_;
  head_ += room;
  reserved_ -= room;
  return offset;
}

}  // namespace lumivox::gpu
