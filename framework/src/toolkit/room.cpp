#include "lumivox/toolkit/room.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox {
namespace {

std::string whyNoRoom(PassContext& frame, const std::vector<std::uint64_t>& buffers) {
  try {
    std::vector<std::unique_ptr<gpu::Buffer>> taken;
    for (const std::uint64_t bytes : buffers)
      taken.push_back(std::make_unique<gpu::Buffer>(frame.device(), bytes, "room that is asked for"));
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

std::string whyNoRoom(PassContext& frame, std::uint64_t bytes) {
  std::vector<std::uint64_t> buffers;
  for (const std::uint64_t most = frame.device().info().maxStorageBytes; bytes > 0; bytes -= buffers.back())
    buffers.push_back(std::min(bytes, most));
  return whyNoRoom(frame, buffers);
}

void requireRoom(PassContext& frame, int items, const std::function<std::vector<std::uint64_t>(int)>& bytesOf,
                 const std::string& what) {
  const std::vector<std::uint64_t> buffers = bytesOf(items);
  const std::uint64_t bytes = std::accumulate(buffers.begin(), buffers.end(), std::uint64_t{0});
  const std::string why = whyNoRoom(frame, buffers);
  if (why.empty()) return;
  int fits = items / 2;
  while (fits > 0 && !whyNoRoom(frame, bytesOf(fits)).empty()) fits /= 2;
  throw Error(fmt::format("room for {} {} takes {}; of numbers halved from it {} ({})", items, what,
                          formatBytes(bytes),
                          fits == 0 ? "none fits" : fmt::format("the largest that fits is {}", fits), why));
}

}  // namespace lumivox
