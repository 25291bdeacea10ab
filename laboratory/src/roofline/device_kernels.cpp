#include "roofline/device_kernels.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <memory>

#include "device_shaders.h"
#include "lumivox/base/error.h"

namespace lumivox::roofline {
namespace {

namespace code = shaders::device;
using gpu::Buffer;
using gpu::Format;
using gpu::Sampling;
using gpu::Texture;
using gpu::TextureKind;

constexpr std::uint32_t kInvocations = 1u << 17;  // enough for every unit of a large device
constexpr std::uint32_t kContenders = 1u << 13;   // on one word they wait for each other
constexpr std::uint32_t kPerRound =
    8;  // samples, accesses or steps of an invocation in a round, as in the shaders
constexpr int kImageSize = 256,
              kVolumeSize = 64;  // texels along a side; fits into a cache, as most passes' textures do
constexpr int kTargetSize = 512;
constexpr std::uint64_t kCachedBytes = std::uint64_t{1} << 20, kMemoryBytes = std::uint64_t{64} << 20;
constexpr std::uint64_t kTransferBytes = std::uint64_t{8} << 20;
constexpr std::uint32_t kCachedApart = 8256;  // elements: distinct cache lines with the same neighbours
constexpr std::uint32_t kCheckedRounds = 3;   // rounds of a run whose results are checked

glm::uvec3 groups(std::uint32_t invocations) {
  // local_size_x of the shaders: large, since starting a group costs time too.
  constexpr std::uint32_t kGroup = 512;
  return {invocations / kGroup, 1, 1};
}

gpu::TextureRef texture(gpu::Device& device, TextureKind kind, Format format, int size, int levels = 1) {
  const int depth = kind == TextureKind::d3 ? size : 1;
  return std::make_shared<Texture>(device, gpu::TextureDescription{kind, format, size, size, depth, levels},
                                   "device measurement");
}

gpu::BufferRef buffer(gpu::Device& device, std::uint64_t bytes) {
  return std::make_shared<Buffer>(device, bytes, "device measurement");
}

// ---- sampling
// ----------------------------------------------------------------------------------------------

/// Every level stores the position of its texels in 0..1, which linear filtering reproduces.
void fillWithPositions(Texture& field) {
  const gpu::TextureDescription& d = field.description();
  for (int level = 0; level < d.levels; ++level) {
    const int size = std::max(1, d.width >> level), depth = d.kind == TextureKind::d3 ? size : 1;
    std::vector<float> values;
    values.reserve(static_cast<std::size_t>(size) * size * depth * 4);
    const auto place = [&](int texel) {
      return (static_cast<float>(texel) + 0.5f) / static_cast<float>(size);
    };
    for (int z = 0; z < depth; ++z)
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
          values.insert(values.end(), {place(x), place(y), depth > 1 ? place(z) : 0.0f, 1.0f});
    field.uploadFloats(level, values);
  }
}

constexpr float kSampleStep = 0.25f / 9.0f;  // eight steps and less than one more stay within 0.25

/// The mean position that an invocation samples in this many rounds, as in sample.comp.
glm::vec3 meanPosition(std::uint32_t invocation, bool scattered, std::uint32_t width, std::uint32_t rounds) {
  glm::dvec3 start(static_cast<double>(invocation % width) / width,
                   static_cast<double>(invocation / width % width) / width,
                   static_cast<double>(invocation % 61u) / 61.0);
  start = start * 0.5 + 0.125;
  std::uint32_t state = invocation * 747796405u + 2891336453u;
  glm::dvec3 sum(0.0);
  for (std::uint32_t round = 0; round < rounds; ++round)
    for (std::uint32_t k = 0; k < kPerRound; ++k) {
      state = state * 1664525u + 1013904223u;
      sum +=
          scattered
              ? glm::dvec3(state >> 22u, state >> 12u & 1023u, state >> 17u & 1023u) * (0.75 / 1023.0) + 0.125
              : start + double{kSampleStep} * (0.125 * (round & 7u) + k + 1.0);
    }
  return sum / static_cast<double>(rounds * kPerRound);
}

struct SampleKind {
  const char* name;
  int variant;
  TextureKind kind;
  Format format;
  Sampling sampling;
};

Kernel sampleKernel(shader::ShaderLibrary& library, const SampleKind& kind, bool scattered) {
  const bool mips = kind.sampling == Sampling::linearMips, shadow = kind.sampling == Sampling::shadow;
  gpu::Device& device = library.device();
  const int size = kind.kind == TextureKind::d3 ? kVolumeSize : kImageSize;
  const auto field = texture(device, kind.kind, kind.format, size, mips ? 3 : 1);
  constexpr float kShadowDepth = 0.375f;
  if (shadow)
    field->clear(glm::vec4(kShadowDepth));
  else
    fillWithPositions(*field);
  const auto results = buffer(device, kInvocations * sizeof(glm::vec4));
  const auto* program = &library.program(
      code::sample::kProgram, code::sample::Variant{.kind = kind.variant, .pattern = scattered}.key());
  const auto parameters = [size, mips](std::uint32_t rounds) {
    code::sample::Parameters p{};
    p.rounds = rounds;
    p.width = static_cast<std::uint32_t>(size);
    p.level = mips ? 0.5f : 0.0f;
    p.step = kSampleStep;
    return p;
  };
  const auto run = [=, &library](std::uint32_t rounds) {
    library.dispatch(*program,
                     {code::sample::parameters(parameters(rounds)),
                      code::sample::image(*field, kind.sampling), code::sample::volume(*field, kind.sampling),
                      code::sample::depths(*field, kind.sampling), code::sample::results(*results)},
                     groups(kInvocations));
  };
  const auto wrong = [=, &device]() -> std::string {
    run(kCheckedRounds);
    device.barrier();
    const auto sums = results->downloadValues<glm::vec4>();
    constexpr std::uint32_t kSamples = kCheckedRounds * kPerRound;
    // Half a texel of the coarsest level for `nearest`, the steps of a byte, and filter weights of eight
    // bits.
    const float tolerance = 2.0f / static_cast<float>(size) + 1.0f / 255.0f;
    for (std::uint32_t i = 0; i < kInvocations; i += 997) {
      const glm::vec3 expected = meanPosition(i, scattered, static_cast<std::uint32_t>(size), kCheckedRounds);
      const glm::vec4 got = sums[i] / static_cast<float>(kSamples);
      if (shadow) {
        // Lit where the position is in front of the stored depth. The expected value is known if all samples
        // are on one side.
        const bool known = !scattered && std::abs(expected.z - kShadowDepth) > 0.13f;
        if (!(got.x >= 0.0f && got.x <= 1.0f) ||
            (known && got.x != (expected.z < kShadowDepth ? 1.0f : 0.0f)))
          return fmt::format("invocation {} is lit by {}", i, got.x);
        continue;
      }
      const float error = std::max(std::abs(got.x - expected.x), std::abs(got.y - expected.y));
      const float deep = kind.kind == TextureKind::d3 ? std::abs(got.z - expected.z) : 0.0f;
      if (!(std::max(error, deep) <= tolerance))
        return fmt::format("invocation {} sampled ({}, {}, {}) in place of ({}, {}, {})", i, got.x, got.y,
                           got.z, expected.x, expected.y, expected.z);
    }
    return {};
  };
  return {1.0 * kInvocations * kPerRound, run, wrong};
}

// ---- images and buffers
// ------------------------------------------------------------------------------------

Kernel imageKernel(shader::ShaderLibrary& library, TextureKind kind, Format format, int formatVariant,
                   int access) {
  using Variant = code::image::Variant;
  gpu::Device& device = library.device();
  const bool volume = kind == TextureKind::d3, toOne = access == Variant::accessContend;
  const int size = volume ? kVolumeSize : kTargetSize;  // as many texels
  const auto target = texture(device, kind, format, size);
  const auto results = buffer(device, kInvocations * sizeof(glm::vec4));
  const auto* program = &library.program(
      code::image::kProgram,
      Variant{.kind = volume ? Variant::kindD3 : Variant::kindD2, .format = formatVariant, .access = access}
          .key());
  const std::uint32_t invocations = toOne ? kContenders : kInvocations;
  const auto run = [=, &library](std::uint32_t rounds) {
    code::image::Parameters parameters{};
    parameters.rounds = rounds;
    parameters.size = glm::ivec3(size, size, volume ? size : 1);
    library.dispatch(
        *program,
        {code::image::parameters(parameters), code::image::image(*target), code::image::imageWords(*target),
         code::image::volume(*target), code::image::volumeWords(*target), code::image::results(*results)},
        groups(invocations));
  };
  // The final value of a texel is its row in an image, or its slice in a volume.
  const auto texelsOfRow = static_cast<std::size_t>(volume ? size * size : size);
  const auto words = [=] {
    const std::vector<std::byte> bytes = target->download();
    std::vector<std::uint32_t> all(bytes.size() / 4);
    std::memcpy(all.data(), bytes.data(), bytes.size());
    return all;
  };
  const auto wrong = [=, &device]() -> std::string {
    constexpr float kValue = 3.0f;
    target->clear(glm::vec4(access == Variant::accessRead ? kValue : 0.0f));
    run(kCheckedRounds);
    device.barrier();
    if (access == Variant::accessRead) {
      for (const glm::vec4& sum : results->downloadValues<glm::vec4>())
        if (sum.x != kValue * kCheckedRounds * kPerRound) return fmt::format("a sum is {}", sum.x);
    } else if (format != Format::r32ui) {
      const std::vector<float> values = target->downloadFloats();
      for (std::size_t i = 0; i < values.size() / 4; ++i)
        if (values[4 * i] != static_cast<float>(i / texelsOfRow))
          return fmt::format("texel {} holds {}", i, values[4 * i]);
    } else {
      const std::vector<std::uint32_t> all = words();
      std::uint64_t sum = 0;
      for (std::size_t i = 0; i < all.size(); ++i) {
        sum += all[i];
        if (access == Variant::accessWrite && all[i] != i / texelsOfRow)
          return fmt::format("texel {} holds {}", i, all[i]);
      }
      const std::uint64_t added = std::uint64_t{invocations} * kCheckedRounds * kPerRound;
      if (access != Variant::accessWrite && sum != added)
        return fmt::format("{} of {} additions arrived", sum, added);
      if (toOne && all[0] != added) return "not all additions went to one texel";
    }
    return {};
  };
  return {1.0 * invocations * kPerRound, run, wrong};
}

Kernel bufferKernel(shader::ShaderLibrary& library, int access, std::uint64_t bytes) {
  using Variant = code::buffer::Variant;
  gpu::Device& device = library.device();
  const bool reads = access == Variant::accessRead || access == Variant::accessSame;
  const bool isAtomic = access == Variant::accessAdd || access == Variant::accessContend;
  const std::uint32_t elementBytes = isAtomic ? 4 : sizeof(glm::uvec4);
  const auto count = static_cast<std::uint32_t>(bytes / elementBytes);
  const auto elements = buffer(device, bytes), results = buffer(device, kInvocations * sizeof(glm::uvec4));
  if (reads) {
    std::vector<glm::uvec4> values(count);
    for (std::uint32_t i = 0; i < count; ++i) values[i] = glm::uvec4(i);
    elements->uploadValues(std::span<const glm::uvec4>(values));
  }
  const auto* program = &library.program(code::buffer::kProgram, Variant{.access = access}.key());
  const std::uint32_t invocations = access == Variant::accessContend ? kContenders : kInvocations;
  // Buffers larger than the caches are read completely.
  const std::uint32_t apart = bytes > kCachedBytes ? kInvocations : kCachedApart;
  const auto run = [=, &library](std::uint32_t rounds) {
    code::buffer::Parameters parameters{};
    parameters.rounds = rounds;
    parameters.mask = count - 1;
    parameters.apart = apart;
    library.dispatch(*program,
                     {code::buffer::parameters(parameters), code::buffer::elements(*elements),
                      code::buffer::words(*elements), code::buffer::results(*results)},
                     groups(invocations));
  };
  const auto wrong = [=, &device]() -> std::string {
    if (!reads) elements->clear();
    run(kCheckedRounds);
    device.barrier();
    if (reads) {
      const auto sums = results->downloadValues<glm::uvec4>();
      for (std::uint32_t i = 0; i < invocations; ++i) {
        std::uint32_t sum = 0;
        for (std::uint32_t k = 1; k <= kCheckedRounds * kPerRound; ++k)
          sum += ((access == Variant::accessSame ? 0 : i) + k * apart) & (count - 1);
        if (sums[i] != glm::uvec4(sum)) return fmt::format("the sum of invocation {} is {}", i, sums[i].x);
      }
    } else if (access == Variant::accessWrite) {
      const auto values = elements->downloadValues<glm::uvec4>();
      for (std::uint32_t i = 0; i < invocations; ++i)
        for (std::uint32_t k = 1; k <= kCheckedRounds * kPerRound; ++k)
          if (const std::uint32_t at = (i + k * apart) & (count - 1); values[at] != glm::uvec4(at))
            return fmt::format("element {} holds {}", at, values[at].x);
    } else {
      std::uint64_t sum = 0;
      const auto values = elements->downloadValues<std::uint32_t>();
      for (const std::uint32_t value : values) sum += value;
      const std::uint64_t added = std::uint64_t{invocations} * kCheckedRounds * kPerRound;
      if (sum != added) return fmt::format("{} of {} additions arrived", sum, added);
      if (access == Variant::accessContend && values[0] != added) return "not all additions went to one word";
    }
    return {};
  };
  return {(isAtomic ? 1.0 : elementBytes) * invocations * kPerRound, run, wrong};
}

// ---- arithmetic
// --------------------------------------------------------------------------------------------

std::uint32_t xorshift(std::uint32_t x) {
  x ^= x << 13u;
  x ^= x >> 17u;
  return x ^ x << 5u;
}

Kernel arithmeticKernel(shader::ShaderLibrary& library, int function, double operations) {
  using Variant = code::arithmetic::Variant;
  constexpr float kFactor = 0.5f, kAddend = 0.75f;
  gpu::Device& device = library.device();
  const auto results = buffer(device, kInvocations * sizeof(glm::vec4));
  const auto* program = &library.program(code::arithmetic::kProgram, Variant{.function = function}.key());
  const auto run = [=, &library](std::uint32_t rounds) {
    code::arithmetic::Parameters parameters{};
    parameters.rounds = rounds;
    parameters.factor = kFactor;
    parameters.addend = kAddend;
    library.dispatch(*program,
                     {code::arithmetic::parameters(parameters), code::arithmetic::results(*results)},
                     groups(kInvocations));
  };
  const auto wrong = [=, &device]() -> std::string {
    constexpr std::uint32_t kRounds =
        8;  // the slowest chain, the cosine, converges by a factor of 0.674 a step
    run(kRounds);
    device.barrier();
    if (function == Variant::functionInteger) {
      const auto values = results->downloadValues<glm::uvec4>();
      for (std::uint32_t i = 0; i < kInvocations; i += 997)
        for (std::uint32_t c = 0; c < 4; ++c) {
          std::uint32_t a = i + c + 1, b = a + 4;
          for (std::uint32_t k = 0; k < kRounds * kPerRound; ++k) a = xorshift(a), b = xorshift(b);
          if (values[i][static_cast<int>(c)] != (a ^ b))
            return fmt::format("invocation {} came to {}", i, values[i][static_cast<int>(c)]);
        }
      return {};
    }
    const double limit = function == Variant::functionExponential ? 0.5671432904
                         : function == Variant::functionSine      ? 0.7390851332
                         : function == Variant::functionRoot      ? 1.0
                                                                  : kAddend / (1.0 - kFactor);
    constexpr double kTolerance = 2e-3;  // error of the functions of a fast device
    for (const glm::vec4& value : results->downloadValues<glm::vec4>())
      for (int c = 0; c < 4; ++c)
        if (!(std::abs(value[c] - limit) <= kTolerance)) return fmt::format("a chain came to {}", value[c]);
    return {};
  };
  constexpr double kChains = 8.0;
  return {operations * kChains * kInvocations * kPerRound, run, wrong};
}

// ---- drawing, starting, moving
// -----------------------------------------------------------------------------

Kernel fillKernel(shader::ShaderLibrary& library, int shape, std::uint32_t triangles) {
  gpu::Device& device = library.device();
  const auto target = texture(device, TextureKind::d2, Format::rgba16f, kTargetSize);
  const auto* program = &library.program(code::fill::kProgram, code::fill::Variant{.shape = shape}.key());
  const auto run = [=, &library, &device](std::uint32_t rounds) {
    const gpu::Drawing drawing = device.drawTo({.colours = {{target.get()}}, .clear = false}, {});
    for (std::uint32_t i = 0; i < rounds; ++i)
      library.draw(*program, {code::fill::parameters({.side = kTargetSize})}, 3 * triangles);
  };
  const auto wrong = [=]() -> std::string {
    target->clear(glm::vec4(0.0f));
    run(kCheckedRounds);
    const std::vector<float> values = target->downloadFloats();
    std::uint32_t filled = 0;
    for (std::size_t i = 0; i < values.size(); i += 4) filled += values[i] == 0.25f && values[i + 2] == 0.75f;
    const std::uint32_t expected =
        shape == code::fill::Variant::shapeSmall ? triangles : kTargetSize * kTargetSize;
    return filled == expected ? "" : fmt::format("{} of {} pixels were filled", filled, expected);
  };
  const bool whole = shape == code::fill::Variant::shapeWhole;
  return {whole ? 1.0 * kTargetSize * kTargetSize : triangles, run, wrong};
}

Kernel drawKernel(shader::ShaderLibrary& library) {
  Kernel kernel = fillKernel(library, code::fill::Variant::shapeSmall, 1);
  kernel.perRound = 1.0;
  return kernel;
}

Kernel dispatchKernel(shader::ShaderLibrary& library, std::uint32_t groupsEach) {
  gpu::Device& device = library.device();
  const auto results = buffer(device, 16);
  const auto* program = &library.program(code::empty::kProgram, {});
  const auto run = [=, &library, &device](std::uint32_t rounds) {
    for (std::uint32_t i = 0; i < rounds; ++i) {
      library.dispatch(*program, {code::empty::results(*results)}, {groupsEach, 1, 1});
      device.barrier();
    }
  };
  const auto wrong = [=]() -> std::string {
    results->clear();
    run(1);
    return results->downloadValues<std::uint32_t>()[0] == 1u ? "" : "nothing was written";
  };
  return {1.0 * groupsEach, run, wrong};
}

enum class Transfer { upload, download, clear };

Kernel transferKernel(shader::ShaderLibrary& library, Transfer transfer) {
  const auto memory = buffer(library.device(), kTransferBytes);
  const auto bytes = std::make_shared<std::vector<std::byte>>(kTransferBytes, std::byte{7});
  const auto run = [=](std::uint32_t rounds) {
    for (std::uint32_t i = 0; i < rounds; ++i) {
      if (transfer == Transfer::upload) memory->upload(*bytes);
      if (transfer == Transfer::clear) memory->clear(0x07070707u);
      if (transfer == Transfer::download) *bytes = memory->download();
    }
  };
  const auto wrong = [=]() -> std::string {
    if (transfer == Transfer::download) memory->clear(0x05050505u);
    run(1);
    const std::vector<std::byte> there = memory->download();
    const std::byte expected{transfer == Transfer::download ? std::uint8_t{5} : std::uint8_t{7}};
    return there.back() == expected && bytes->front() == expected ? "" : "the bytes did not arrive";
  };
  return {1.0 * kTransferBytes, run, wrong};
}

// ---- the list
// ----------------------------------------------------------------------------------------------

void addSampling(std::vector<KernelEntry>& all) {
  using Variant = code::sample::Variant;
  std::vector<SampleKind> kinds;
  for (const auto& [kindName, variant, kind] : {std::tuple{"d2", int{Variant::kindD2}, TextureKind::d2},
                                                {"d3", int{Variant::kindD3}, TextureKind::d3}})
    for (const Format format : {Format::rgba8, Format::rgba16f, Format::rgba32f})
      for (const auto& [filter, sampling] : {std::pair{"nearest", Sampling::nearest},
                                             {"linear", Sampling::linear},
                                             {"mips", Sampling::linearMips}}) {
        kinds.push_back({kindName, variant, kind, format, sampling});
        for (const bool scattered : {false, true})
          all.push_back({fmt::format("texture_samples_{}_{}_{}{}", kindName, gpu::name(format), filter,
                                     scattered ? "_scattered" : ""),
                         "samples/s", [entry = kinds.back(), scattered](shader::ShaderLibrary& library) {
                           return sampleKernel(library, entry, scattered);
                         }});
      }
  for (const bool scattered : {false, true})
    all.push_back({std::string("texture_samples_d2_depth32f_shadow") + (scattered ? "_scattered" : ""),
                   "samples/s", [scattered](shader::ShaderLibrary& library) {
                     return sampleKernel(library,
                                         {"d2", Variant::kindShadow, TextureKind::d2Array, Format::depth32f,
                                          Sampling::shadow},
                                         scattered);
                   }});
}

void addImages(std::vector<KernelEntry>& all) {
  using Variant = code::image::Variant;
  const auto add = [&](const std::string& name, const char* unit, TextureKind kind, Format format,
                       int variant, int access) {
    all.push_back({name, unit, [=](shader::ShaderLibrary& library) {
                     return imageKernel(library, kind, format, variant, access);
                   }});
  };
  for (const auto& [kindName, kind] : {std::pair{"d2", TextureKind::d2}, {"d3", TextureKind::d3}})
    for (const auto& [format, variant] : {std::pair{Format::rgba16f, int{Variant::formatRgba16f}},
                                          {Format::rgba32f, int{Variant::formatRgba32f}},
                                          {Format::r32ui, int{Variant::formatR32ui}}}) {
      add(fmt::format("image_writes_{}_{}", kindName, gpu::name(format)), "writes/s", kind, format, variant,
          Variant::accessWrite);
      add(fmt::format("image_reads_{}_{}", kindName, gpu::name(format)), "reads/s", kind, format, variant,
          Variant::accessRead);
    }
  add("image_atomics", "operations/s", TextureKind::d3, Format::r32ui, Variant::formatR32ui,
      Variant::accessAdd);
  add("image_atomics_contended", "operations/s", TextureKind::d3, Format::r32ui, Variant::formatR32ui,
      Variant::accessContend);
}

std::vector<KernelEntry> makeKernels() {
  std::vector<KernelEntry> all;
  addSampling(all);
  addImages(all);
  const auto add = [&](const char* name, const char* unit, auto make) { all.push_back({name, unit, make}); };
  const auto ofBuffer = [](int access, std::uint64_t bytes) {
    return [=](shader::ShaderLibrary& library) { return bufferKernel(library, access, bytes); };
  };
  using Access = code::buffer::Variant;
  add("buffer_atomics", "operations/s", ofBuffer(Access::accessAdd, kCachedBytes));
  add("buffer_atomics_contended", "operations/s", ofBuffer(Access::accessContend, kCachedBytes));
  add("buffer_reads", "bytes/s", ofBuffer(Access::accessRead, kCachedBytes));
  add("buffer_reads_uniform", "bytes/s", ofBuffer(Access::accessSame, kCachedBytes));
  add("buffer_reads_memory", "bytes/s", ofBuffer(Access::accessRead, kMemoryBytes));
  add("buffer_writes", "bytes/s", ofBuffer(Access::accessWrite, kCachedBytes));
  add("buffer_writes_memory", "bytes/s", ofBuffer(Access::accessWrite, kMemoryBytes));
  const auto arithmetic = [](int function, double operations) {
    return [=](shader::ShaderLibrary& library) { return arithmeticKernel(library, function, operations); };
  };
  using Function = code::arithmetic::Variant;
  constexpr double kProductAndSum = 2.0, kShiftsAndSums = 6.0;
  add("float_operations", "operations/s", arithmetic(Function::functionProduct, kProductAndSum));
  add("float_operations_fused", "operations/s", arithmetic(Function::functionFused, kProductAndSum));
  add("integer_operations", "operations/s", arithmetic(Function::functionInteger, kShiftsAndSums));
  add("exponentials", "operations/s", arithmetic(Function::functionExponential, 1.0));
  add("sines", "operations/s", arithmetic(Function::functionSine, 1.0));
  add("inverse_square_roots", "operations/s", arithmetic(Function::functionRoot, 1.0));
  add("fragments", "fragments/s",
      [](shader::ShaderLibrary& library) { return fillKernel(library, code::fill::Variant::shapeWhole, 1); });
  add("triangles", "triangles/s", [](shader::ShaderLibrary& library) {
    return fillKernel(library, code::fill::Variant::shapeSmall, kTargetSize * kTargetSize);
  });
  add("dispatches", "dispatches/s",
      [](shader::ShaderLibrary& library) { return dispatchKernel(library, 1); });
  add("work_groups", "groups/s", [](shader::ShaderLibrary& library) {
    constexpr std::uint32_t kGroups = 4096;
    return dispatchKernel(library, kGroups);
  });
  add("draws", "draws/s", drawKernel);
  const auto moving = [](Transfer transfer) {
    return [=](shader::ShaderLibrary& library) { return transferKernel(library, transfer); };
  };
  add("upload_bytes", "bytes/s", moving(Transfer::upload));
  add("download_bytes", "bytes/s", moving(Transfer::download));
  add("clear_bytes", "bytes/s", moving(Transfer::clear));
  return all;
}

}  // namespace

const std::vector<KernelEntry>& kernels() {
  static const std::vector<KernelEntry> all = makeKernels();
  return all;
}

}  // namespace lumivox::roofline
