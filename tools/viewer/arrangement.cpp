#include "viewer/arrangement.h"

#include <algorithm>
#include <cmath>

namespace lumivox::viewer {

std::vector<double> roundNumbers(double low, double high) {
  constexpr std::size_t kEnough = 3;
  static const std::vector<std::vector<double>> kDigits{
      {1}, {1, 3}, {1, 2, 5}, {1, 2, 3, 5}, {1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9}};
  const int first = static_cast<int>(std::floor(std::log10(low))),
            last = static_cast<int>(std::floor(std::log10(high)));
  std::vector<double> numbers;
  for (const std::vector<double>& digits : kDigits) {
    numbers.clear();
    for (int power = first; power <= last; ++power)
      for (const double digit : digits)
        if (const double number = digit * std::pow(10.0, power); number >= low && number <= high)
          numbers.push_back(number);
    if (numbers.size() >= kEnough) break;
  }
  return numbers;
}

std::optional<float> heightAbovePanels(const Room& room, float aspect) {
  constexpr float kMostOfHeight = 0.6f;
  const float above = std::min(room.width / aspect, kMostOfHeight * room.height - room.aroundPictures),
              beside = std::min((room.width - room.panels) / aspect, room.height - room.aroundPictures);
  if (above <= beside) return std::nullopt;
  return above + room.aroundPictures;
}

}  // namespace lumivox::viewer
