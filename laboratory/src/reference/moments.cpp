#include "lumivox/reference/moments.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/hash.h"
#include "lumivox/base/log.h"
#include "reference/cache.h"
#include "reference/render.h"

namespace lumivox {
namespace reference {
namespace {

constexpr const char* kHead = "lumivox reference part 1";
static_assert(std::endian::native == std::endian::little, "parts hold numbers as this machine does");

/// A unit is a block of samples in a tile. Units are numbered block by block, each tile by tile.
class Units {
 public:
  Units(const ResolvedOptions& resolved, const Tiles& tiles)
      : tiles_(tiles.count()), blocks_(blocksOf(resolved.options.samplesPerPixel)), pixelsBefore_{0} {
    for (int tile = 0; tile < tiles_; ++tile) {
      std::size_t pixels = 0;
      tiles.forEachPixel(tile, [&](int, int) { ++pixels; });
      pixelsBefore_.push_back(pixelsBefore_.back() + pixels);
    }
  }
  int blocks() const { return blocks_; }
  std::size_t count() const { return static_cast<std::size_t>(tiles_) * static_cast<std::size_t>(blocks_); }
  int tile(std::size_t unit) const { return static_cast<int>(unit % static_cast<std::size_t>(tiles_)); }
  int block(std::size_t unit) const { return static_cast<int>(unit / static_cast<std::size_t>(tiles_)); }
  std::size_t unit(int tile, int block) const {
    return static_cast<std::size_t>(block) * static_cast<std::size_t>(tiles_) +
           static_cast<std::size_t>(tile);
  }
  /// Pixels of all units before this one, each block with its own.
  std::size_t pixelsBefore(std::size_t unit) const {
    return static_cast<std::size_t>(block(unit)) * pixelsBefore_.back() +
           pixelsBefore_[static_cast<std::size_t>(tile(unit))];
  }
  std::size_t pixels(std::size_t unit) const { return pixelsBefore(unit + 1) - pixelsBefore(unit); }

 private:
  int tiles_, blocks_;
  std::vector<std::size_t> pixelsBefore_;  ///< of each tile
};

template <std::size_t Layers>
std::size_t numbersOf(std::size_t furtherLayers) {
  std::size_t count = 0;
  PixelStatistics<Layers>().forEachNumber([&](double) { ++count; });
  FurtherStatistics(furtherLayers).forEachNumber([&](double) { ++count; });
  return count;
}

/// The head of a file: which units of which reference, and the hash of their numbers.
struct PartHead {
  std::string key, hash;
  std::size_t first = 0, end = 0, numbers = 0;  ///< numbers: of one pixel
  std::size_t start = 0;                        ///< of the numbers, bytes into the file
};

std::string hashOf(const std::vector<double>& values) {
  return Hasher().add(values).finish().text();
}

/// A part that was written, checked but for its numbers.
PartHead headOf(std::ifstream& stream, const std::filesystem::path& file) {
  std::string line, numbers;
  PartHead head;
  if (!std::getline(stream, line) || line != kHead)
    throw Error(
        fmt::format("{}: this is no part of a reference; expected a file that reference --shard has written",
                    file.string()));
  std::istringstream words(std::getline(stream, numbers) ? numbers : std::string());
  if (!(words >> head.key >> head.first >> head.end >> head.numbers >> head.hash) || head.end < head.first)
    throw Error(
        fmt::format("{}: its second line is damaged; expected what reference --shard writes", file.string()));
  head.start = static_cast<std::size_t>(stream.tellg());
  return head;
}

std::vector<double> numbersAt(const std::filesystem::path& file, std::size_t start, std::size_t count) {
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(start));
  std::vector<double> values(count);
  stream.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(double)));
  if (static_cast<std::size_t>(stream.gcount()) != count * sizeof(double))
    throw Error(
        fmt::format("{}: it ends too early; the share that wrote it has to run again", file.string()));
  return values;
}

template <std::size_t Layers>
void mergeTile(const Tiles& tiles, int tile, const std::vector<std::vector<double>>& blocks, Film& film) {
  std::vector<const double*> next;
  for (const std::vector<double>& block : blocks) next.push_back(block.data());
  tiles.forEachPixel(tile, [&](int x, int y) {
    PixelStatistics<Layers> pixel;
    FurtherStatistics further(film.furtherLayers());
    for (const double*& from : next) {
      const auto take = [&](double& value) { value = *from++; };
      PixelStatistics<Layers> block;
      FurtherStatistics furtherBlock(film.furtherLayers());
      block.forEachNumber(take);
      furtherBlock.forEachNumber(take);
      pixel.add(block);
      further.add(furtherBlock);
    }
    film.write(x, y, pixel);
    if (further.channels() > 0) film.write(x, y, further);
  });
}

}  // namespace
}  // namespace reference

using namespace reference;

void renderReferencePart(const Scene& scene, const ReferenceOptions& given, std::size_t index,
                         std::size_t count, const std::filesystem::path& file) {
  const PreparedScene prepared(scene, given);
  const ResolvedOptions& resolved = prepared.resolved;
  const ReferenceOptions& options = resolved.options;
  const Tracer tracer(prepared.scene, resolved);
  const Film film(options.width, options.height, !tracer.media.empty(), hasEnvironment(scene),
                  options.bounceLayers);
  const Tiles tiles(options.width, options.height);
  const Units units(resolved, tiles);
  const std::size_t first = units.count() * (index - 1) / count, end = units.count() * index / count;
  const std::size_t perPixel = tracer.media.empty() ? numbersOf<kSurfaceLayers.size()>(film.furtherLayers())
                                                    : numbersOf<kMediaLayers.size()>(film.furtherLayers());
  std::vector<double> values((units.pixelsBefore(end) - units.pixelsBefore(first)) * perPixel);
  std::optional<Progress> progress;
  if (options.progress)
    progress.emplace(fmt::format("reference of {}: part {} of {}", prepared.scene.name, index, count),
                     static_cast<std::uint64_t>(end - first));
  tbb::task_arena arena(threadsOf(options.threads));
  arena.execute([&] {
    tbb::parallel_for(first, end, [&](std::size_t unit) {
      CountingRays rays{tracer.rays};
      double* to = values.data() + (units.pixelsBefore(unit) - units.pixelsBefore(first)) * perPixel;
      renderBlocks(tracer, resolved, tiles, units.tile(unit), {units.block(unit), units.block(unit) + 1},
                   film.furtherLayers(), rays, [&](int, int, auto& pixel, auto& further) {
                     const auto put = [&](double value) { *to++ = value; };
                     pixel.forEachNumber(put);
                     further.forEachNumber(put);
                   });
      if (progress) progress->advance();
    });
  });
  std::string text = fmt::format("{}\n{} {} {} {} {}\n", kHead, cacheKey(scene, resolved).text(), first, end,
                                 perPixel, hashOf(values));
  text.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  writeFileAtomically(file, text);
}

LayeredImage mergedReference(const Scene& scene, const ReferenceOptions& given,
                             const std::vector<std::filesystem::path>& files) {
  const PreparedScene prepared(scene, given);
  const ResolvedOptions& resolved = prepared.resolved;
  const ReferenceOptions& options = resolved.options;
  const bool media = !Media(prepared.scene, resolved.snapshot).empty();
  Film film(options.width, options.height, media, hasEnvironment(scene), options.bounceLayers);
  const Tiles tiles(options.width, options.height);
  const Units units(resolved, tiles);
  const std::string key = cacheKey(scene, resolved).text();
  const std::size_t perPixel = media ? numbersOf<kMediaLayers.size()>(film.furtherLayers())
                                     : numbersOf<kSurfaceLayers.size()>(film.furtherLayers());
  std::vector<PartHead> heads;
  std::vector<std::size_t> partOf(units.count(), files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    requireRegularFile(files[i]);
    std::ifstream stream(files[i], std::ios::binary);
    if (!stream)
      throw Error(fmt::format("{}: cannot be read; expected a part of a reference", files[i].string()));
    heads.push_back(headOf(stream, files[i]));
    const PartHead& head = heads.back();
    if (head.key != key || head.end > units.count() || head.numbers != perPixel)
      throw Error(fmt::format(
          "{}: it is part of another reference; expected the same scene, camera, time, size, samples, bounces and "
          "seed as here, and the same version of the path tracer",
          files[i].string()));
    if (hashOf(numbersAt(files[i], head.start,
                         (units.pixelsBefore(head.end) - units.pixelsBefore(head.first)) * perPixel)) !=
        head.hash)
      throw Error(fmt::format("{}: its numbers are not what was written; the share has to run again",
                              files[i].string()));
    for (std::size_t unit = head.first; unit < head.end; ++unit) partOf[unit] = i;
  }
  for (std::size_t unit = 0; unit < partOf.size(); ++unit)
    if (partOf[unit] == files.size())
      throw Error(fmt::format(
          "the reference of {} is not complete: no part has its samples from {} on in tile {} of {}",
          scene.name, units.block(unit) * kBlockSamples, units.tile(unit) + 1, tiles.count()));
  for (int tile = 0; tile < tiles.count(); ++tile) {
    std::vector<std::vector<double>> blocks;
    for (int block = 0; block < units.blocks(); ++block) {
      const std::size_t unit = units.unit(tile, block), part = partOf[unit];
      const std::size_t before = units.pixelsBefore(unit) - units.pixelsBefore(heads[part].first);
      blocks.push_back(numbersAt(files[part], heads[part].start + before * perPixel * sizeof(double),
                                 units.pixels(unit) * perPixel));
    }
    if (media)
      mergeTile<kMediaLayers.size()>(tiles, tile, blocks, film);
    else
      mergeTile<kSurfaceLayers.size()>(tiles, tile, blocks, film);
  }
  LayeredImage image = finished(scene, resolved, film);
  if (options.useCache) keepInCache(scene, resolved, image);
  return image;
}

}  // namespace lumivox
