#include "lumivox/base/deflate.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include <memory>

#include "base/deflate_limit.h"
#include "lumivox/base/error.h"

namespace lumivox {

std::string zlibStream(std::string_view bytes, int level) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(level), &libdeflate_free_compressor);
  if (!compressor) throw Error("no memory is left to deflate");
  std::string stream(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  stream.resize(
      libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), stream.data(), stream.size()));
  return stream;
}

Deflated Deflated::ofStream(std::string stream, std::uint64_t expandedBytes) {
  auto holder = std::make_shared<const std::string>(std::move(stream));
  return {*holder, expandedBytes, std::move(holder)};
}

std::string Deflated::expanded() const {
  if (expandedBytes / kMostDeflateExpansion > stream.size())
    throw Error(
        fmt::format("deflated data is damaged: {} bytes cannot hold {}", stream.size(), expandedBytes));
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!decompressor) throw Error("no memory is left to expand deflated data");
  std::string bytes(expandedBytes, '\0');
  // A null size pointer requires exactly this many bytes.
  if (libdeflate_zlib_decompress(decompressor.get(), stream.data(), stream.size(), bytes.data(), bytes.size(),
                                 nullptr) != LIBDEFLATE_SUCCESS)
    throw Error(fmt::format("deflated data is damaged: it does not expand to {} bytes", expandedBytes));
  return bytes;
}

}  // namespace lumivox
