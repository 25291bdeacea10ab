// Lights from a captured frame of 640 x 480 pixels, over decoding its two PNG files: the time of
// captured_frames.read, which decodes, and of captured_frames.lights, by widths of the filter of depth.
// usage: bench_captured_frames [--quick | REPEATS] (default: 9), from the project's folder. --quick: seconds
// of work, whose figures mean nothing, for the tests
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <random>

#include "../timed_pipelines.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/scene/text.h"

namespace {

using namespace lumivox;
namespace fs = std::filesystem;

/// A folder with a capture of so many frames, which goes with the object.
class Files {
 public:
  Files(int width, int height, int frames)
      : folder_(fs::temp_directory_path() / "lumivox_bench_captured_frames") {
    fs::create_directories(folder_ / "rgb");
    fs::create_directories(folder_ / "depth");
    std::mt19937 random(1);
    std::normal_distribution<double> noise;
    std::string pairs, poses;
    for (int frame = 0; frame < frames; ++frame) {
      WordImage depth{width, height, {}};
      ByteImage colour{width, height, 3, {}};
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const double z = 2.0 + 0.4 * std::sin(0.01 * x + frame) + 0.3 * std::cos(0.013 * y);
          depth.values.push_back(static_cast<std::uint16_t>(5000.0 * (z + 0.006 * noise(random))));
          for (int c = 0; c < 3; ++c)
            colour.values.push_back(
                static_cast<unsigned char>(128 + 60 * std::sin(0.02 * x + c) + 6 * noise(random)));
        }
      writeGreyPng16(folder_ / fmt::format("depth/{}.png", frame), depth);
      writeBytePng(folder_ / fmt::format("rgb/{}.png", frame), colour);
      pairs += fmt::format("{} rgb/{}.png {} depth/{}.png\n", frame, frame, frame, frame);
      poses += fmt::format("{} 0 0 0 0 0 0 1\n", frame);
    }
    writeFileAtomically(folder_ / "associations.txt", pairs);
    writeFileAtomically(folder_ / "groundtruth.txt", poses);
  }
  ~Files() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;
  const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

double millisecondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    Machine machine;
    machine.repeats = quick ? 1 : argc > 1 ? repeatsOf(argv[1], "bench_captured_frames") : 9;
    const int width = quick ? 64 : 640, height = quick ? 48 : 480;
    // More frames than a capture keeps decoded.
    const int frames = machine.repeats + 1;
    const Files files(width, height, frames);
    const Scene scene = loadSceneText(
        fmt::format(
            "scene \"capture\" {{ camera main {{ capture c }}\n capture c {{ folder \"{}\" focal {} {} centre {} {} }} }}",
            files.folder().string(), 0.82 * width, 0.82 * width, 0.5 * (width - 1), 0.5 * (height - 1)),
        files.folder() / "capture.scene");
    const Pipeline text = Pipeline::parse(
        "pipeline \"lights\" {\n param filter 2 in 0..8\n pass gbuffer direct_lighting.gbuffer { }\n"
        " pass read captured_frames.read { }\n pass lights captured_frames.lights {\n frames read.frames\n filter $filter\n }\n"
        " pass choose reflective_shadow_maps.choose { map lights.map }\n"
        " pass gather reflective_shadow_maps.gather {\n gbuffer gbuffer\n lights choose.lights\n }\n"
        " output indirect_diffuse gather.diffuse\n}\n",
        "bench.pipeline");
    fmt::print("{} x {} pixels, medians and quartiles of {} frames\n", width, height, machine.repeats);
    for (const char* filter : {"0", "1", "2"}) {
      Bench bench(machine, scene, text, {std::string("filter=") + filter}, 16);
      bench.at(0.0);
      std::vector<double> ratios, filtered;
      for (int frame = 1; frame < frames; ++frame) {
        const double decoding = millisecondsOf([&] {
          const fs::path depth = files.folder() / fmt::format("depth/{}.png", frame);
          decodeGreyPng16(readFile(depth), depth);
          readByteImage(files.folder() / fmt::format("rgb/{}.png", frame));
        });
        const Times times = bench.at(frame);
        ratios.push_back(sumOf(times, {"read", "lights"}) / decoding);
        filtered.push_back(times.at("lights") / decoding);
      }
      row(fmt::format("read and lights over decoding, filter {}", filter), inWords(ratios));
      row(fmt::format("  of it lights, filter {}", filter), inWords(filtered));
    }
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_captured_frames: {}\n", error.what());
    return 1;
  }
}
