// The programs that `lumivox device` times. Each does one thing as often as asked, and knows what must come
// out.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lumivox/shader/library.h"

namespace lumivox::roofline {

struct Kernel {
  double perRound = 0.0;                   ///< operations of one round
  std::function<void(std::uint32_t)> run;  ///< so many rounds
  std::function<std::string()> wrong;      ///< runs a few rounds; what is wrong with the result, or empty
};

struct KernelEntry {
  std::string name, unit;
  /// With its resources, which live as long as the kernel.
  std::function<Kernel(shader::ShaderLibrary&)> make;
};
const std::vector<KernelEntry>& kernels();

}  // namespace lumivox::roofline
