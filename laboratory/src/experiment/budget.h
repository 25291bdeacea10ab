// The time for measuring that --budget grants.
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>

namespace lumivox::experiment {

/// Its time runs from construction, which is after the references are made. Nothing is begun that would end
/// after it.
class Budget {
 public:
  explicit Budget(double seconds) : seconds_(seconds) {}
  double spent() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  bool isLimited() const { return seconds_ > 0.0; }
  bool allows(double seconds) const { return !isLimited() || spent() + seconds <= seconds_; }
  /// s; infinite without a limit.
  double left() const {
    return isLimited() ? std::max(0.0, seconds_ - spent()) : std::numeric_limits<double>::infinity();
  }

 private:
  double seconds_;  ///< 0: no limit
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace lumivox::experiment
