// Endings of files, patterns of names, and paths of objects.
#include <algorithm>

#include "scene/description.h"

namespace lumivox {

bool hasFormat(const std::string& name, const std::vector<std::string>& formats) {
  std::string lower = name;
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return std::any_of(formats.begin(), formats.end(), [&](const std::string& ending) {
    return lower.size() > ending.size() &&
           lower.compare(lower.size() - ending.size(), ending.size(), ending) == 0;
  });
}

bool matches(const std::string& pattern, const std::string& name) {
  // Greedy, with backtracking to the last star only: linear for usual patterns.
  std::size_t p = 0, n = 0, starAt = std::string::npos, resume = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      starAt = p++;
      resume = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p;
      ++n;
    } else if (starAt != std::string::npos) {
      p = starAt + 1;
      n = ++resume;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::string meshOf(const std::string& path) {
  return path.substr(0, path.find('/'));
}

}  // namespace lumivox
