// The progress of reproducing a published result.
#pragma once

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "experiment/costs.h"
#include "lumivox/experiment/reproduce.h"

namespace lumivox::experiment {

/// Tells ReproduceOptions::progress after every step: a set-up is opened, timed and, where there is a store,
/// stored; a panel is shown.
class ReproductionSteps {
 public:
  ReproductionSteps(const ReproduceOptions& options, bool stores) : options_(options), stores_(stores) {}

  /// Call before the first step. `traced`: for each panel, whether it shows the path-traced reference.
  void expect(const std::vector<std::string>& setUps, std::vector<bool> traced);

  using Clock = std::chrono::steady_clock;
  void opened(const std::string& setUp, Clock::time_point start);
  void timed(const std::string& setUp);
  /// `isNew`: the store lacked it.
  void stored(const std::string& setUp, Clock::time_point start, bool isNew);
  void shownPanel(Clock::time_point start);

 private:
  enum class Stage { placed, opened, timed, stored };
  void tell();
  /// s; kUnknownSeconds before there is one step of each kind.
  double secondsLeft() const;

  const ReproduceOptions& options_;
  const bool stores_;
  std::map<std::string, Stage> setUps_;
  std::vector<bool> traced_;
  std::size_t shownPanels_ = 0, done_ = 0, total_ = 0;
  Costs costs_;
};

}  // namespace lumivox::experiment
