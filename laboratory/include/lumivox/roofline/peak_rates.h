// Measured peak rates of this device, and how far a pass is from them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "lumivox/gpu/device.h"
#include "lumivox/results/records.h"
#include "lumivox/shader/work.h"

namespace lumivox {

struct PeakRateOptions {
  int repeats = 5;
  double repeatMs = 25.0;          ///< a repeat takes at least this long, and less than about twice as long
  std::vector<std::string> names;  ///< those alone; empty: all of them. Error for an unknown one
  /// Told before each: how many of how many, and its name.
  std::function<void(std::size_t done, std::size_t total, const std::string& name)> progress;
};

/// Times small programs that do one thing each, and checks what they compute. The clock is that of
/// gpu::Device::time. Names and units are those of Work, with "/s"; a name that ends in _scattered,
/// _contended or _memory is the same at its worst: positions anywhere, all on one word, more bytes than
/// caches hold.
std::vector<PeakRate> measurePeakRates(gpu::Device& device, const PeakRateOptions& options = {});
std::vector<std::string> peakRateNames();

/// Of this device, driver and host, the store's peak rates: those of options.store, else of the store of a
/// user who names none. Empty when they were not measured.
std::vector<PeakRate> storedPeakRates(const gpu::Device& device, const std::filesystem::path& store);

/// One bound per resource, the largest first: no pass can be faster than that. On one resource times add;
/// different resources may work side by side. A name that has no peak rate of its own takes the fastest of
/// the most similar ones, so that the bound stays one; what has no similar one either is left out.
std::vector<WorkBound> lowerBounds(const Work& work, const std::vector<PeakRate>& peakRates);

}  // namespace lumivox
