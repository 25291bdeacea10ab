// Repeatability: the same bits in all circumstances.
#include <fmt/format.h>

#include <cstring>

#include "stress/case_tools.h"

namespace lumivox::stress {
namespace {

Finding sameBits(const char* measure, int different, int runs) {
  return judged(measure, {static_cast<double>(different), 0.0}, 0.0, fmt::format("of {} runs", runs));
}

std::optional<Finding> again(Bench& bench) {
  const Scene scene = suitableScene(bench);
  const int runs = bench.quick() ? 3 : 10;
  const std::uint64_t first = bench.contentOf(scene);
  int different = 0;
  for (int run = 1; run < runs; ++run) different += bench.contentOf(scene) != first ? 1 : 0;
  return sameBits("runs with other bits than the first", different, runs);
}

std::optional<Finding> onSecondDevice(Bench& bench) {
  const Scene scene = suitableScene(bench);
  return sameBits("devices with other bits than the first",
                  bench.contentOnSecondDevice(scene) != bench.contentOf(scene) ? 1 : 0, 2);
}

/// On a software rasteriser the order of the shaders' work depends on how many threads share it.
std::optional<Finding> withThreads(Bench& bench) {
  const Scene scene = suitableScene(bench);
  const std::uint64_t first = bench.contentOf(scene);
  int different = 0, runs = 0;
  for (const int threads : bench.quick() ? std::vector<int>{4} : std::vector<int>{1, 2, 7}) {
    const std::uint64_t content =
        bench.contentElsewhere(scene.file.stem().string(), {}, {fmt::format("LP_NUM_THREADS={}", threads)});
    different += content != first ? 1 : 0;
    ++runs;
  }
  return sameBits("processes with other threads and other bits", different, runs);
}

std::optional<Finding> referenceWithThreads(Bench& bench) {
  if (!makesImages(bench)) return std::nullopt;
  const Scene scene = suitableScene(bench);
  Shot shot;
  shot.width = shot.height = bench.quick() ? 16 : 48;
  constexpr int kSamples = 8;
  const LayeredImage first = bench.reference(scene, shot, kSamples, 1);
  std::size_t different = 0;
  for (const int threads : {2, 7}) {
    const LayeredImage other = bench.reference(scene, shot, kSamples, threads);
    for (const auto& [name, image] : first.layers) {
      const std::vector<float>&a = image.values(), &b = other.layers.at(name).values();
      for (std::size_t i = 0; i < a.size(); ++i) different += std::memcmp(&a[i], &b[i], sizeof(float)) != 0;
    }
  }
  return judged("values of the reference with other bits on 2 or 7 threads than on one",
                {static_cast<double>(different), 0.0}, 0.0);
}

}  // namespace

std::vector<Case> repeatabilityCases() {
  return {
      {{"repeatability", "same_bits_again", "ten runs (quick: three) of a pipeline give the same bits", true},
       again},
      {{"repeatability", "same_bits_on_second_device",
        "a second device opened beside the first gives the same bits", false},
       onSecondDevice},
      {{"repeatability", "same_bits_with_other_threads",
        "a process whose rasteriser has 1, 2 or 7 threads (quick: 4) gives the same bits", true},
       withThreads},
      {{"repeatability", "same_reference_with_other_threads",
        "the path tracer gives the same bits on 1, 2 and 7 threads", true},
       referenceWithThreads}};
}

}  // namespace lumivox::stress
