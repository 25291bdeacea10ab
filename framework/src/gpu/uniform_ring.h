// Allocates uniform blocks of commands in flight. Without OpenGL, so that tests can check the order of fences
// and commands.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace lumivox::gpu {

/// Offsets in a ring buffer of segments. A segment is reused only after the device has passed the fence
/// behind the last command that reads it.
class UniformRing {
 public:
  static constexpr std::size_t kSegments = 4;

  /// The device as the ring uses it.
  class Fences {
   public:
    virtual ~Fences() = default;
    virtual void insert(std::size_t segment) = 0;  ///< behind all commands so far
    virtual void wait(
        std::size_t segment) = 0;  ///< waits until the last fence of this segment is passed, if it has one
  };

  UniformRing(Fences& fences, std::size_t segmentBytes, std::size_t alignment);

  /// Room in one segment for all blocks of the next command: `bytes` is the sum of their roomFor(). To be
  /// called before anything of that command is bound: should the ring move on, the fence of the segment that
  /// it leaves stands behind every command that reads it, and blocks of earlier commands lie there no longer.
  /// Precondition: at most segmentBytes().
  void reserve(std::size_t bytes);
  /// The offset of a block; reserve() must have reserved its room.
  std::size_t place(std::size_t bytes);
  /// The room of a block, with the gap before the next.
  std::size_t roomFor(std::size_t bytes) const { return (bytes + alignment_ - 1) / alignment_ * alignment_; }

  std::size_t segmentBytes() const { return segmentBytes_; }
  /// Changes whenever the ring moves on to another segment; offsets of the current segment stay valid.
  std::uint64_t segmentSerial() const { return segmentSerial_; }

 private:
  Fences& fences_;
  std::size_t segmentBytes_, alignment_;
  std::size_t head_ = 0, reserved_ = 0;  ///< head_: in the current segment
  std::uint64_t segmentSerial_ = 0;
};

}  // namespace lumivox::gpu
