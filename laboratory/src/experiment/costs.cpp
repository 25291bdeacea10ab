#include "experiment/costs.h"

#include <algorithm>

namespace lumivox::experiment {

void Costs::add(const std::string& subject, const std::string& work, double weight, double seconds) {
  if (!(weight > 0.0) || !(seconds >= 0.0)) return;
  Taken& taken = works_[work][subject];
  taken.weight += weight;
  taken.seconds += seconds;
  taken.parts += 1.0;
  taken.most = std::max(taken.most, seconds / weight);
}

std::optional<double> Costs::expected(const std::string& subject, const std::string& work,
                                      double weight) const {
  const auto known = works_.find(work);
  if (known == works_.end()) return std::nullopt;
  const auto same = known->second.find(subject);
  if (same != known->second.end()) return weight * same->second.seconds / same->second.weight;
  // Rate of a subject as dear as the mean of all: the subjects that had this work may be dearer or cheaper
  // than that.
  double seconds = 0.0, weights = 0.0;
  for (const auto& [name, taken] : known->second) {
    seconds += taken.seconds / taken.parts;
    weights += taken.weight / taken.parts * share(name);
  }
  return weights > 0.0 ? weight * share(subject) * seconds / weights : 0.0;
}

std::optional<double> Costs::most(const std::string& subject, const std::string& work, double weight) const {
  const auto known = works_.find(work);
  if (known == works_.end() || !known->second.contains(subject)) return std::nullopt;
  return weight * known->second.at(subject).most;
}

double Costs::meanRate(const Subjects& subjects) {
  double seconds = 0.0, weights = 0.0;
  for (const auto& [name, taken] : subjects) {
    seconds += taken.seconds / taken.parts;
    weights += taken.weight / taken.parts;
  }
  return seconds / weights;
}

double Costs::share(const std::string& subject) const {
  double own = 0.0, mean = 0.0;
  for (const auto& [work, subjects] : works_) {
    const auto found = subjects.find(subject);
    if (found == subjects.end()) continue;
    own += found->second.seconds;
    mean += meanRate(subjects) * found->second.weight;
  }
  return mean > 0.0 ? own / mean : 1.0;
}

}  // namespace lumivox::experiment
