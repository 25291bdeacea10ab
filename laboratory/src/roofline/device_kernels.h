// The programs that `lumivox device` times. Each repeats one operation and checks its result.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "lumivox/shader/library.h"

namespace lumivox::roofline {

struct Kernel {
  double perRound = 0.0;                   ///< operations of one round
  std::function<void(std::uint32_t)> run;  ///< runs this many rounds
  std::function<std::string()>
      wrong;  ///< runs a few rounds and describes a wrong result, or returns an empty text
};

struct KernelEntry {
  std::string name, unit;
  /// Makes the kernel with its resources, which live as long as the kernel.
  std::function<Kernel(shader::ShaderLibrary&)> make;
};
const std::vector<KernelEntry>& kernels();

}  // namespace lumivox::roofline
