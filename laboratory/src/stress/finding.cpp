#include <cmath>
#include <cstddef>

#include "lumivox/base/error.h"
#include "stress/cases.h"

namespace lumivox::stress {

Finding judged(std::string measure, Measured value, double limit, std::string detail) {
  Finding finding;
  finding.measure = std::move(measure);
  finding.value = value;
  finding.limit = limit;
  finding.detail = std::move(detail);
  finding.outcome = value.value <= limit ? StressOutcome::stable : StressOutcome::biased;
  return finding;
}

double relativeDifference(const ImageBuffer& image, const ImageBuffer& wanted) {
  const std::vector<float>&a = image.values(), &b = wanted.values();
  if (a.size() != b.size()) throw Error("two images of different shapes cannot be compared");
  if (a.empty()) return 0.0;
  double squares = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = static_cast<double>(a[i]) - b[i];
    squares += difference * difference;
    sum += b[i];
  }
  const auto count = static_cast<double>(a.size());
  const double mean = sum / count;
  return std::sqrt(squares / count) / (mean > 0.0 ? mean : 1.0);
}

}  // namespace lumivox::stress
