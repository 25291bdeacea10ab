#include "lumivox/results/text.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>

namespace lumivox {

std::string formatMilliseconds(double milliseconds) {
  constexpr double kWholeFrom = 99.95;  // rounds to 100 at three digits
  return std::abs(milliseconds) >= kWholeFrom ? fmt::format("{:.0f}", milliseconds)
                                              : fmt::format("{:.3g}", milliseconds);
}

std::string formatQuartiles(const TimingStatistics& time) {
  if (time.repeats < kLeastRepeats) return {};
  return fmt::format("[{}, {}]", formatMilliseconds(time.lowerQuartile),
                     formatMilliseconds(time.upperQuartile));
}

std::string formatThousands(double value) {
  constexpr std::array<const char*, 6> kThousands{"", " k", " M", " G", " T", " P"};
  constexpr double kNext = 999.5;  // rounds to 1000 at three digits
  std::size_t power = 0;
  while (value >= kNext && power + 1 < kThousands.size()) {
    value /= 1000.0;
    ++power;
  }
  return fmt::format("{:.3g}{}", value, kThousands[power]);
}

std::string formatPercent(double share) {
  return fmt::format("{:.0f} %", std::round(100.0 * share) + 0.0);  // adding a positive zero drops its sign
}

std::string pointText(const ParameterValues& parameters) {
  std::string text;
  for (const auto& [name, value] : parameters) text += (text.empty() ? "" : " ") + name + "=" + value.text();
  return text.empty() ? "default" : text;
}

std::string parametersText(const ParameterValues& values) {
  std::string text;
  for (const auto& [name, value] : values) text += (text.empty() ? "" : ", ") + name + " " + value.text();
  return text.empty() ? "default" : text;
}

std::string shortName(const std::string& pipelineFile) {
  return std::filesystem::path(pipelineFile).stem().string();
}

}  // namespace lumivox
