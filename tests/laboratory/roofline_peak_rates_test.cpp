// The peak rates of the device, what shaders do counted, and the distance of one from the other.
#include <cmath>
#include <ctime>
#include <functional>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/pipeline.h"
#include "lumivox/roofline/peak_rates.h"
#include "roofline/device_kernels.h"
#include "support/facts.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

const roofline::KernelEntry& kernelNamed(const std::string& name) {
  for (const roofline::KernelEntry& entry : roofline::kernels())
    if (entry.name == name) return entry;
  FAIL("there is no " << name);
  return roofline::kernels().front();
}

/// The programs of the device, counting what they do.
shader::ShaderLibrary& countingLibrary() {
  static shader::ShaderLibrary library(device());
  static const bool ready = [] {
    library.countWork();
    return true;
  }();
  REQUIRE(ready);
  return library;
}

bool lacksSpirv() {
  if (device().shaderInput() == gpu::ShaderInput::spirv) return false;
  skip("this driver takes GLSL, and operations are counted in SPIR-V");
  return true;
}

/// How long a kernel keeps the device busy, ms. A software rasteriser is judged by the processor time of all
/// its threads, which others on this machine do not change much.
double msOf(const roofline::Kernel& kernel, std::uint32_t rounds) {
  device().finish();
  const std::clock_t start = std::clock();
  const double ms = device().time([&] { kernel.run(rounds); }).deviceMs;
  device().finish();
  if (!device().info().software) return ms;
  return 1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// A ratio of times, the first of six that lies within the bounds: other programs on this machine disturb
/// caches and clocks, and what would be wrong here is wrong every time.
double ratioWithin(double low, double high, const std::function<double()>& ratio) {
  constexpr int kAttempts = 6;
  double last = ratio();
  for (int attempt = 1; attempt < kAttempts && !(last > low && last < high); ++attempt) last = ratio();
  return last;
}

PeakRate peakRate(const std::string& name, double rate) {
  PeakRate made;
  made.name = name;
  made.rate = statisticsOf({rate});
  return made;
}

const WorkBound& boundOf(const std::vector<WorkBound>& bounds, const std::string& resource) {
  for (const WorkBound& bound : bounds)
    if (bound.resource == resource) return bound;
  FAIL("no bound for " << resource);
  return bounds.front();
}

}  // namespace

TEST_CASE("bounds add on one resource, and the resource that takes longest limits") {
  const std::vector<PeakRate> peakRates{peakRate("float_operations", 1e9),
                                        peakRate("integer_operations", 2e9),
                                        peakRate("texture_samples_d3_rgba16f_linear", 1e8)};
  const auto bounds = lowerBounds(
      {{"float_operations", 1e6}, {"integer_operations", 4e6}, {"texture_samples_d3_rgba16f_linear", 1e6}},
      peakRates);
  REQUIRE(bounds.size() == 2);
  CHECK(bounds[0].resource == "texture sampling");
  CHECK(bounds[0].ms == Approx(10.0));
  CHECK(bounds[1].resource == "arithmetic");
  CHECK(bounds[1].ms == Approx(1.0 + 2.0));
  CHECK(lowerBounds({{"float_operations", 1e6}}, {}).empty());
  CHECK(lowerBounds({{"shared_accesses", 1e6}}, peakRates).empty());
}

TEST_CASE("without a peak rate of its own work takes the fastest of the most similar") {
  const std::vector<PeakRate> peakRates{peakRate("texture_samples_d3_rgba8_linear", 4e8),
                                        peakRate("texture_samples_d3_rgba32f_linear", 1e8),
                                        peakRate("texture_samples_d3_rgba8_mips", 2e8),
                                        peakRate("texture_samples_d2_rgba8_linear", 8e8),
                                        peakRate("texture_samples_d3_r32f_linear_scattered", 1e6),
                                        peakRate("image_atomics", 1e7),
                                        peakRate("image_atomics_contended", 1e5)};
  CHECK(lowerBounds({{"texture_samples_d3_r32f_linear", 4e8}}, peakRates)[0].ms == Approx(1000.0));
  CHECK(lowerBounds({{"image_atomics", 1e7}}, peakRates)[0].ms == Approx(1000.0));
  CHECK(lowerBounds({{"texture_samples", 8e8}}, peakRates)[0].ms == Approx(1000.0));
}

TEST_CASE("counting finds what each program of the device is known to do, to the last operation") {
  if (lacksSpirv()) return;
  shader::ShaderLibrary& library = countingLibrary();
  constexpr std::uint32_t kRounds = 1;
  for (const char* name :
       {"texture_samples_d2_rgba8_nearest", "texture_samples_d3_rgba16f_mips",
        "texture_samples_d3_rgba32f_linear", "texture_samples_d2_depth32f_shadow", "image_writes_d3_rgba16f",
        "image_writes_d2_r32ui", "image_reads_d2_rgba32f", "image_atomics", "buffer_atomics",
        "buffer_reads_uniform", "exponentials", "sines", "inverse_square_roots", "fragments", "triangles",
        "dispatches", "work_groups", "draws"}) {
    INFO(name);
    const roofline::Kernel kernel = kernelNamed(name).make(library);
    library.takeWork();
    kernel.run(kRounds);
    device().finish();
    const Work work = library.takeWork();
    REQUIRE(work.count(name) == 1);
    CHECK(work.at(name) == kernel.perRound * kRounds);
  }
  // Counting changes no result.
  for (const char* name : {"texture_samples_d3_rgba16f_mips", "image_atomics", "triangles"})
    CHECK(kernelNamed(name).make(library).wrong().empty());
  // Programs that need other operations of the same kind around what they are for.
  for (const char* name :
       {"float_operations", "float_operations_fused", "integer_operations", "buffer_reads"}) {
    INFO(name);
    const roofline::Kernel kernel = kernelNamed(name).make(library);
    library.takeWork();
    kernel.run(kRounds);
    const Work once = library.takeWork();
    kernel.run(2 * kRounds);
    const Work twice = library.takeWork();
    const std::string counted = std::string(name) == "float_operations_fused" ? "float_operations" : name;
    const double perRound = (twice.at(counted) - once.at(counted)) / kRounds;
    CHECK(perRound >= kernel.perRound);
    CHECK(perRound < 1.2 * kernel.perRound);
  }
}

TEST_CASE("bytes that are uploaded and cleared count once, and those of counting itself do not") {
  if (lacksSpirv()) return;
  shader::ShaderLibrary& library = countingLibrary();
  const roofline::Kernel upload = kernelNamed("upload_bytes").make(library);
  const roofline::Kernel clear = kernelNamed("clear_bytes").make(library);
  const roofline::Kernel dispatch = kernelNamed("dispatches").make(library);
  library.takeWork();
  upload.run(2);
  clear.run(3);
  const Work work = library.takeWork();
  CHECK(work.at("upload_bytes") == 2.0 * upload.perRound);
  CHECK(work.at("clear_bytes") == 3.0 * clear.perRound);
  dispatch.run(5);
  const Work started = library.takeWork();
  CHECK(started.at("dispatches") == 5.0);
  CHECK(started.at("buffer_writes") == 5.0 * 4.0);
  CHECK(started.count("clear_bytes") == 0);
  CHECK(started.count("download_bytes") == 0);
}

TEST_CASE("four times the work takes two to eight times the time, so that nothing of it was optimised away") {
  shader::ShaderLibrary library(device());
  for (const char* name : {"texture_samples_d3_rgba16f_linear", "buffer_atomics", "float_operations", "sines",
                           "buffer_reads", "fragments"}) {
    const roofline::Kernel kernel = kernelNamed(name).make(library);
    // The best of several: others use this machine too.
    const auto best = [&](std::uint32_t rounds) {
      return std::min({msOf(kernel, rounds), msOf(kernel, rounds), msOf(kernel, rounds)});
    };
    kernel.run(1);
    // Well above what starting costs, and more than one round, since the first finds the caches empty.
    std::uint32_t rounds = 2;
    constexpr double kLongEnough = 30.0;  // ms
    while (best(rounds) < kLongEnough) rounds *= 2;
    // Work that was optimised away takes the same time, whatever its amount.
    constexpr double kLow = 2.0, kHigh = 8.0;
    const double ratio = ratioWithin(kLow, kHigh, [&] { return best(4 * rounds) / best(rounds); });
    INFO(name << ", " << rounds << " rounds");
    CHECK(ratio > kLow);
    CHECK(ratio < kHigh);
  }
}

TEST_CASE("a pass that does one known thing is found at its ceiling, within a fifth") {
  if (lacksSpirv()) return;
  shader::ShaderLibrary plain(device());
  shader::ShaderLibrary& counting = countingLibrary();
  struct Known {
    const char *name, *resource;
    std::uint32_t rounds;
  };
  for (const Known& known : {Known{"texture_samples_d3_rgba16f_linear", "texture sampling", 2},
                             {"image_writes_d3_r32ui", "image access", 2},
                             {"buffer_reads", "buffer access", 4},
                             {"float_operations", "arithmetic", 16}}) {
    const roofline::Kernel counted = kernelNamed(known.name).make(counting),
                           timed = kernelNamed(known.name).make(plain);
    counting.takeWork();
    counted.run(3 * known.rounds);
    const Work work = counting.takeWork();
    timed.run(1);
    constexpr double kLow = 0.8, kHigh = 1.2;
    const double share = ratioWithin(kLow, kHigh, [&] {
      // The rate from one amount of work, the pass from another.
      double rateMs = 1e30, passMs = 1e30;
      for (int repeat = 0; repeat < 5; ++repeat) {
        rateMs = std::min(rateMs, msOf(timed, 4 * known.rounds));
        passMs = std::min(passMs, msOf(timed, 3 * known.rounds));
      }
      const double rate = timed.perRound * 4 * known.rounds / rateMs * 1000.0;
      return boundOf(lowerBounds(work, {peakRate(known.name, rate)}), known.resource).ms / passMs;
    });
    INFO(known.name);
    CHECK(share > kLow);
    CHECK(share < kHigh);
  }
}

TEST_CASE("every peak rate of this device is measured, with the right results", "[slow]") {
  PeakRateOptions options;
  options.repeats = 3;
  options.repeatMs = 2.0;
  std::size_t told = 0;
  options.progress = [&](std::size_t, std::size_t, const std::string&) { ++told; };
  const std::vector<PeakRate> peakRates = measurePeakRates(device(), options);
  CHECK(peakRates.size() == peakRateNames().size());
  CHECK(told == peakRates.size());
  for (const PeakRate& one : peakRates) {
    INFO(one.name);
    CHECK(one.rate.median > 0.0);
    CHECK(std::isfinite(one.rate.median));
    CHECK(one.rate.lowerQuartile <= one.rate.median);
    CHECK(one.rate.repeats == 3);
    CHECK_FALSE(one.unit.empty());
  }
  options.names = {"texture_sampling"};
  CHECK_THROWS_MATCHES(measurePeakRates(device(), options), Error, Tells("texture_samples_d2_rgba8_nearest"));
}

TEST_CASE("a pass's work is counted with its loops and branches, and its image stays the same bit for bit") {
  if (lacksSpirv()) return;
  const Scene scene = litRoom(20, 12);  // no multiple of a work group: the pixels outside do nothing
  const Pipeline pipeline = test::pipeline("direct_lighting");
  RenderOptions options;
  const FrameResult plain = renderOnce(scene, pipeline, options);
  options.countWork = true;
  const FrameResult counted = renderOnce(scene, pipeline, options);
  REQUIRE(plain.outputs.size() == counted.outputs.size());
  for (const auto& [name, image] : plain.outputs) CHECK(image.values() == counted.outputs.at(name).values());
  for (const PassRecord& pass : plain.passes) CHECK(pass.work.empty());
  bool shaded = false, drawn = false;
  for (const PassRecord& pass : counted.passes) {
    INFO(pass.pass);
    if (pass.pass == "shade") {
      shaded = true;
      CHECK(pass.work.at("image_writes_d2_rgba32f") == 20.0 * 12.0);
      CHECK(pass.work.at("float_operations") >
            100.0 * 20.0 * 12.0);  // 16 samples of the area light in each pixel
    }
    if (pass.pass == "gbuffer") {
      drawn = true;
      CHECK(pass.work.at("triangles") == static_cast<double>(scene.triangleCount()));
      CHECK(pass.work.at("vertices") >= 4.0 * static_cast<double>(scene.objects.size()));
      CHECK(pass.work.at("fragments") > 0.25 * 20.0 * 12.0);
    }
  }
  CHECK(shaded);
  CHECK(drawn);
}

TEST_CASE("a device that takes GLSL says that nothing can be counted") {
  gpu::Device glsl({"auto", gpu::ShaderInput::glsl});
  shader::ShaderLibrary library(glsl);
  CHECK_THROWS_MATCHES(library.countWork(), AbsentError, Tells("GLSL"));
}
