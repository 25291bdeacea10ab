#include "lumivox/roofline/peak_rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include "base/process.h"
#include "lumivox/base/error.h"
#include "lumivox/base/log.h"
#include "lumivox/results/runs.h"
#include "lumivox/results/store.h"
#include "roofline/device_kernels.h"

namespace lumivox {

using namespace roofline;

namespace {

constexpr std::uint32_t kMostRounds = 1u << 24;

/// Milliseconds of this many rounds; the device is idle before and after.
double millisecondsOf(gpu::Device& device, const Kernel& kernel, std::uint32_t rounds) {
  return device
      .time([&] {
        kernel.run(rounds);
        device.barrier();
      })
      .deviceMs;
}

/// The number of rounds that take about the given time.
std::uint32_t roundsFor(gpu::Device& device, const Kernel& kernel, double milliseconds) {
  kernel.run(1);  // the driver compiles at the first use
  std::uint32_t rounds = 1;
  for (;;) {
    const double took = millisecondsOf(device, kernel, rounds);
    if (took >= milliseconds || rounds >= kMostRounds) return rounds;
    // Short times are mostly start-up cost and say little about longer ones.
    const double factor = took > 0.2 * milliseconds ? milliseconds / took : 4.0;
    const double wanted = std::max(rounds + 1.0, std::ceil(rounds * factor));
    rounds = static_cast<std::uint32_t>(std::min<double>(wanted, kMostRounds));
  }
}

// ---- how far from the limit -----------------------------------------------------------------------------

/// Resources of the device by prefixes of operation names.
constexpr std::array<std::pair<std::string_view, const char*>, 20> kResources{{
    {"texture_samples", "texture sampling"},
    {"image_reads", "image access"},
    {"image_writes", "image access"},
    {"image_atomics", "atomics"},
    {"buffer_atomics", "atomics"},
    {"buffer_reads", "buffer access"},
    {"buffer_writes", "buffer access"},
    {"float_operations", "arithmetic"},
    {"integer_operations", "arithmetic"},
    {"exponentials", "arithmetic"},
    {"sines", "arithmetic"},
    {"inverse_square_roots", "arithmetic"},
    {"fragments", "pixel fill"},
    {"triangles", "triangle set-up"},
    {"dispatches", "starting work"},
    {"work_groups", "starting work"},
    {"draws", "starting work"},
    {"upload_bytes", "transfers"},
    {"download_bytes", "transfers"},
    {"clear_bytes", "transfers"},
}};
/// Worst-case rates give no lower bound of time.
constexpr std::array<std::string_view, 3> kWorst{"_scattered", "_contended", "_memory"};

bool isWorst(const std::string& name) {
  return std::any_of(kWorst.begin(), kWorst.end(), [&](std::string_view end) { return name.ends_with(end); });
}

std::set<std::string> wordsOf(const std::string& name) {
  std::set<std::string> words;
  for (std::size_t start = 0; start < name.size();) {
    const std::size_t end = std::min(name.find('_', start), name.size());
    words.insert(name.substr(start, end - start));
    start = end + 1;
  }
  return words;
}

/// Operations a second of `name`: the best of the repeats, since noise never makes one faster than the
/// device. 0 if nothing similar was measured.
double peakRateOf(const std::string& name, std::string_view begin, const std::vector<PeakRate>& peakRates) {
  const std::set<std::string> words = wordsOf(name);
  double rate = 0.0;
  std::size_t closest = 0;
  for (const PeakRate& peakRate : peakRates) {
    if (!peakRate.name.starts_with(begin) || isWorst(peakRate.name)) continue;
    if (peakRate.name == name) return peakRate.rate.largest;
    std::size_t same = 0;
    for (const std::string& word : wordsOf(peakRate.name)) same += words.count(word);
    if (same < closest) continue;
    rate = same > closest ? peakRate.rate.largest : std::max(rate, peakRate.rate.largest);
    closest = same;
  }
  return rate;
}

}  // namespace

std::vector<std::string> peakRateNames() {
  std::vector<std::string> names;
  for (const KernelEntry& entry : kernels()) names.push_back(entry.name);
  return names;
}

std::vector<PeakRate> measurePeakRates(gpu::Device& device, const PeakRateOptions& options) {
  const std::vector<std::string> known = peakRateNames();
  for (const std::string& name : options.names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(
          fmt::format("the device has no peak rate '{}'; expected one of {}", name, fmt::join(known, ", ")));
  std::vector<const KernelEntry*> chosen;
  for (const KernelEntry& entry : kernels())
    if (options.names.empty() ||
        std::find(options.names.begin(), options.names.end(), entry.name) != options.names.end())
      chosen.push_back(&entry);

  shader::ShaderLibrary library(device);
  const DeviceIdentity identity = identityOf(device);
  std::vector<PeakRate> peakRates;
  for (const KernelEntry* entry : chosen) {
    if (options.progress) options.progress(peakRates.size(), chosen.size(), entry->name);
    const MachineLock alone(MachineLock::For::timing);
    const Kernel kernel = entry->make(library);
    if (const std::string wrong = kernel.wrong(); !wrong.empty())
      throw Error(
          fmt::format("measuring {} on {}: the result is wrong: {}", entry->name, identity.device, wrong));
    const std::uint32_t rounds = roundsFor(device, kernel, options.repeatMs);
    std::vector<double> rates;
    for (int repeat = 0; repeat < options.repeats; ++repeat)
      rates.push_back(kernel.perRound * rounds / millisecondsOf(device, kernel, rounds) * 1000.0);
    peakRates.push_back({entry->name, entry->unit, statisticsOf(std::move(rates)), dateText(),
                         LUMIVOX_VERSION, identity.device, identity.driver, identity.shaderInput,
                         identity.host});
  }
  return peakRates;
}

std::vector<PeakRate> storedPeakRates(const gpu::Device& device, const std::filesystem::path& store) {
  const DeviceIdentity identity = identityOf(device);
  for (const std::filesystem::path& file : {store, ResultsStore::defaultFile()}) {
    std::error_code ignored;
    if (file.empty() || !std::filesystem::exists(file, ignored)) continue;
    try {
      auto peakRates = ResultsStore(file, ResultsStore::Mode::read)
                           .peakRates(identity.device, identity.driver, identity.shaderInput, identity.host);
      if (!peakRates.empty()) return peakRates;
    } catch (const Error& error) {
      // Measurements work without peak rates.
      logWarning("no peak rates of the device: {}", error.what());
    }
  }
  return {};
}

std::vector<WorkBound> lowerBounds(const Work& work, const std::vector<PeakRate>& peakRates) {
  std::map<std::string, double> milliseconds;
  for (const auto& [name, count] : work)
    for (const auto& [begin, resource] : kResources) {
      if (!name.starts_with(begin)) continue;
      if (const double rate = peakRateOf(name, begin, peakRates); rate > 0.0)
        milliseconds[resource] += count / rate * 1000.0;
    }
  std::vector<WorkBound> bounds;
  for (const auto& [resource, ms] : milliseconds) bounds.push_back({resource, ms});
  std::stable_sort(bounds.begin(), bounds.end(), [](const auto& a, const auto& b) { return a.ms > b.ms; });
  return bounds;
}

}  // namespace lumivox
