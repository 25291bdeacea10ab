// Loops over large arrays on all processors.
#pragma once

#include <algorithm>
#include <cstddef>
#include <thread>
#include <vector>

namespace lumivox {

/// Calls `work(begin, end)` for consecutive ranges of [0, count), one for each processor, at once. `work`
/// must not throw. Short loops stay on this thread.
template <class Work>
void inParallel(std::size_t count, const Work& work) {
  constexpr std::size_t kLeastPerThread = 1 << 15;  // a thread starts in the time of about so many steps
  const std::size_t threads =
      std::clamp<std::size_t>(count / kLeastPerThread, 1, std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < threads; ++i)
    others.emplace_back([&, i] { work(count * i / threads, count * (i + 1) / threads); });
  work(std::size_t{0}, count / threads);
}

}  // namespace lumivox
