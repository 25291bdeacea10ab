#include <fmt/format.h>

#include <algorithm>
#include <cassert>

#include "gpu/state.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox::gpu {

Buffer::Buffer(Device& device, std::uint64_t sizeBytes, std::string label)
    : device_(device.state()), sizeBytes_(sizeBytes), label_(std::move(label)) {
  device_->use();
  const std::string what = fmt::format("buffer '{}' ({})", label_, formatBytes(sizeBytes_));
  if (sizeBytes_ == 0) throw Error(fmt::format("{}: a buffer needs at least one byte", what));
  if (sizeBytes_ > static_cast<std::uint64_t>(device_->limits.storageBlockBytes)) {
    throw Error(fmt::format("{}: a shader on {} can address at most {} of one buffer", what,
                            device_->info.renderer,
                            formatBytes(static_cast<std::uint64_t>(device_->limits.storageBlockBytes))));
  }
  device_->requireDeviceMemory(sizeBytes_, what);
  glCreateBuffers(1, &handle_);
  glNamedBufferStorage(handle_, static_cast<GLsizeiptr>(sizeBytes_), nullptr, GL_DYNAMIC_STORAGE_BIT);
  if (!label_.empty())
    glObjectLabel(GL_BUFFER, handle_, static_cast<GLsizei>(std::min<std::size_t>(label_.size(), 200)),
                  label_.c_str());
  try {
    device_->check("allocating " + what + device_->besideText());
  } catch (...) {
    glDeleteBuffers(1, &handle_);
    throw;
  }
  device_->allocated(this, sizeBytes_);
}

Buffer::~Buffer() {
  if (device_->useToRelease()) {
    glDeleteBuffers(1, &handle_);
    device_->forgetBindings();
  }
  device_->freed(this, sizeBytes_);
}

void Buffer::upload(std::span<const std::byte> bytes, std::uint64_t offsetBytes) {
  if (bytes.empty()) return;
  device_->use();
  assert(offsetBytes + bytes.size() <= sizeBytes_);
  device_->order();
  glNamedBufferSubData(handle_, static_cast<GLintptr>(offsetBytes), static_cast<GLsizeiptr>(bytes.size()),
                       bytes.data());
  device_->transfers.uploaded += bytes.size();
  device_->checkTold("uploading to " + label_);
}

std::vector<std::byte> Buffer::download(std::uint64_t offsetBytes, std::uint64_t sizeBytes) const {
  device_->use();
  assert(offsetBytes <= sizeBytes_);
  const std::uint64_t count = std::min(sizeBytes, sizeBytes_ - offsetBytes);
  DeviceState::requireHostMemory(count, label_);
  std::vector<std::byte> bytes(count);
  if (bytes.empty()) return bytes;
  device_->order();
  glGetNamedBufferSubData(handle_, static_cast<GLintptr>(offsetBytes), static_cast<GLsizeiptr>(bytes.size()),
                          bytes.data());
  device_->downloaded(bytes.size());
  device_->check("downloading " + label_);
  return bytes;
}

void Buffer::clear(std::uint32_t word) {
  device_->use();
  device_->order();
  const std::uint64_t whole = sizeBytes_ / 4 * 4;
  if (whole > 0) {
    glClearNamedBufferSubData(handle_, GL_R32UI, 0, static_cast<GLsizeiptr>(whole), GL_RED_INTEGER,
                              GL_UNSIGNED_INT, &word);
  }
  // The last bytes of a size that is no multiple of a word.
  if (whole < sizeBytes_) {
    glNamedBufferSubData(handle_, static_cast<GLintptr>(whole), static_cast<GLsizeiptr>(sizeBytes_ - whole),
                         &word);
  }
  device_->transfers.cleared += sizeBytes_;
  device_->checkTold("clearing " + label_);
}

}  // namespace lumivox::gpu
