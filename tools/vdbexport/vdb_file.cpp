#include "vdbexport/vdb_file.h"

#include <fmt/format.h>
#include <openvdb/io/Stream.h>

#include <algorithm>
#include <istream>
#include <numeric>
#include <streambuf>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/hash.h"
#include "lumivox/base/memory_stream.h"

namespace lumivox::vdb {
namespace {

namespace fs = std::filesystem;

/// A stream into memory that allows OpenVDB to seek back and write the offset of each grid.
class OutputBuffer : public std::streambuf {
 public:
  std::string take() { return std::move(bytes_); }

 protected:
  std::streamsize xsputn(const char* data, std::streamsize count) override {
    const auto size = static_cast<std::size_t>(count);
    const std::size_t over = std::min(size, bytes_.size() - position_);
    std::copy_n(data, over, bytes_.begin() + static_cast<std::ptrdiff_t>(position_));
    bytes_.append(data + over, size - over);
    position_ += size;
    return count;
  }
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    xsputn(&byte, 1);
    return c;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const auto base = from == std::ios_base::beg   ? off_type{0}
                      : from == std::ios_base::cur ? static_cast<off_type>(position_)
                                                   : static_cast<off_type>(bytes_.size());
    const off_type target = base + offset;
    if (target < 0 || target > static_cast<off_type>(bytes_.size())) return pos_type(off_type(-1));
    position_ = static_cast<std::size_t>(target);
    return target;
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override {
    return seekoff(off_type(position), std::ios_base::beg, which);
  }

 private:
  std::string bytes_;
  std::size_t position_ = 0;
};

/// Writes to a stream by Archive::write(), which is protected. io::File is not used, since it does not notice
/// a full disk.
class MemoryArchive : public openvdb::io::Archive {
 public:
  MemoryArchive() {
    using namespace openvdb::io;
    setCompression(COMPRESS_ACTIVE_MASK | (hasBloscCompression() ? COMPRESS_BLOSC : COMPRESS_ZIP));
  }
  std::string bytesOf(const openvdb::GridCPtrVec& grids) const {
    OutputBuffer buffer;
    std::ostream stream(&buffer);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    Archive::write(stream, grids, /*seekable=*/true);
    return withStableTag(buffer.take());
  }

 private:
  std::string withStableTag(std::string bytes) const {
    const std::string tag = getUniqueTag();
    constexpr std::size_t kHeaderBytes = 128;
    const std::size_t place = bytes.substr(0, kHeaderBytes).find(tag);
    if (place == std::string::npos) throw Error("OpenVDB wrote a header without its unique tag");
    bytes.replace(place, tag.size(), std::string(tag.size(), '0'));
    std::string hash = hashOf(bytes).text();
    // Shaped as a universally unique identifier: groups of 8, 4, 4, 4 and 12 digits.
    for (const std::size_t dash : {8, 13, 18, 23}) hash.insert(dash, "-");
    return bytes.replace(place, tag.size(), hash.substr(0, tag.size()));
  }
};

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
  throw Error(fmt::format("{}: {}; expected a whole OpenVDB file", file.string(), why));
}

}  // namespace

std::string encode(const openvdb::GridCPtrVec& grids) {
  openvdb::initialize();
  std::uint64_t sizeBytes = 0;
  for (const openvdb::GridBase::ConstPtr& grid : grids) sizeBytes += grid->memUsage();
  requireMemory(sizeBytes, "the OpenVDB file");  // an upper bound, since the file is compressed
  return MemoryArchive().bytesOf(grids);
}

void writeVdb(const fs::path& file, const openvdb::GridCPtrVec& grids) {
  writeFileAtomically(file, encode(grids));
}

std::vector<openvdb::GridBase::Ptr> readVdb(const fs::path& file) {
  openvdb::initialize();
  const std::string bytes = readFile(file, kLargestVolumeFile);
  lumivox::MemoryBuffer buffer(bytes);
  std::istream stream(&buffer);
  try {
    // Without this, a stream that ends too early would be read as zeros.
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::Stream whole(stream, /*delayLoad=*/false);
    const openvdb::GridPtrVecPtr grids = whole.getGrids();
    return {grids->begin(), grids->end()};
  } catch (const std::ios_base::failure&) {
    refuse(file, "it ends too early, or its parts contradict each other");
  } catch (const std::bad_alloc&) {
    refuse(file, "it needs more memory than is available");
  } catch (const std::exception& error) {
    refuse(file, error.what());
  }
}

}  // namespace lumivox::vdb
