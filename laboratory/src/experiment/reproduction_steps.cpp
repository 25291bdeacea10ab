#include "experiment/reproduction_steps.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "lumivox/measure/metrics.h"

namespace lumivox::experiment {
namespace {

constexpr const char *kOpened = "opened", *kStored = "stored", *kPanel = "panel", *kTraced = "traced panel";

double secondsSince(ReproductionSteps::Clock::time_point start) {
  return std::chrono::duration<double>(ReproductionSteps::Clock::now() - start).count();
}

}  // namespace

void ReproductionSteps::expect(const std::vector<std::string>& setUps, std::vector<bool> traced) {
  for (const std::string& setUp : setUps) setUps_[setUp] = Stage::placed;
  traced_ = std::move(traced);
  total_ = setUps.size() * (stores_ ? 3 : 2) + traced_.size();
}

void ReproductionSteps::opened(const std::string& setUp, Clock::time_point start) {
  costs_.add(setUp, kOpened, 1.0, secondsSince(start));
  setUps_[setUp] = Stage::opened;
  tell();
}

void ReproductionSteps::timed(const std::string& setUp) {
  setUps_[setUp] = Stage::timed;
  tell();
}

void ReproductionSteps::stored(const std::string& setUp, Clock::time_point start, bool isNew) {
  if (isNew) costs_.add(setUp, kStored, 1.0, secondsSince(start));
  setUps_[setUp] = Stage::stored;
  tell();
}

void ReproductionSteps::shownPanel(Clock::time_point start) {
  costs_.add("", traced_[shownPanels_] ? kTraced : kPanel, 1.0, secondsSince(start));
  ++shownPanels_;
  tell();
}

void ReproductionSteps::tell() {
  done_ = std::min(done_ + 1, total_);  // a set-up may be opened twice
  if (options_.progress) options_.progress(done_, total_, secondsLeft());
}

double ReproductionSteps::secondsLeft() const {
  std::optional<double> left = 0.0;
  const auto add = [&](std::optional<double> seconds) {
    left = left && seconds ? std::optional(*left + *seconds) : std::nullopt;
  };
  // Some frames are rendered once more for the times of passes; a store also takes following frames.
  const double frames = options_.repeats + kLeastRepeats + (stores_ ? 2 * options_.repeats : 0);
  for (const auto& [setUp, stage] : setUps_) {
    const std::optional<double> opened = costs_.expected(setUp, kOpened, 1.0);
    if (stage < Stage::opened) add(opened);
    if (stage < Stage::timed) add(opened ? std::optional(frames * *opened) : std::nullopt);
    if (stage < Stage::stored && stores_) add(costs_.expected(setUp, kStored, 1.0));
  }
  for (std::size_t i = shownPanels_; i < traced_.size(); ++i)
    add(costs_.expected("", traced_[i] ? kTraced : kPanel, 1.0));
  return left.value_or(kUnknownSeconds);
}

}  // namespace lumivox::experiment
