#include "lumivox/experiment/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox {
namespace {

constexpr const char* kHead = "lumivox plan 1";

/// A whole number that is all of the text.
std::optional<std::size_t> wholeNumber(const std::string& text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// The mean of the costs that are known, s; none where none is.
std::optional<double> meanOf(const std::vector<double>& costs) {
  double known = 0.0;
  std::size_t parts = 0;
  for (const double cost : costs)
    if (cost > 0.0) known += cost, ++parts;
  if (parts == 0) return std::nullopt;
  return known / static_cast<double>(parts);
}

}  // namespace

Shard shardOf(const std::string& text) {
  const std::size_t slash = text.find('/');
  const auto index = wholeNumber(text.substr(0, slash));
  const auto count = slash == std::string::npos ? std::nullopt : wholeNumber(text.substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count)
    throw Error(fmt::format("--shard '{}': expected a share of so many, from 1/n to n/n, such as 2/3", text));
  return {*index, *count};
}

std::vector<std::size_t> cutsOf(const std::vector<double>& costs, std::size_t count) {
  const double mean = meanOf(costs).value_or(1.0);
  const auto costOf = [&](double cost) { return cost > 0.0 ? cost : mean; };
  double total = 0.0;
  for (const double cost : costs) total += costOf(cost);
  std::vector<std::size_t> cuts{0};
  double before = 0.0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const double cost = costOf(costs[i]);
    const auto share = std::min(
        count - 1, static_cast<std::size_t>((before + 0.5 * cost) / total * static_cast<double>(count)));
    while (cuts.size() <= share) cuts.push_back(i);
    before += cost;
  }
  cuts.resize(count + 1, costs.size());
  return cuts;
}

void SharedPlan::write(const std::filesystem::path& file) const {
  std::string text = fmt::format("{}\n{} {} {}\n", kHead, hash, points, shares.size());
  for (const std::vector<std::size_t>& share : shares) {
    std::string line;
    for (std::size_t i = 0; i < share.size();) {
      std::size_t end = i + 1;
      while (end < share.size() && share[end] == share[end - 1] + 1) ++end;
      line += line.empty() ? "" : " ";
      line += end == i + 1 ? fmt::format("{}", share[i]) : fmt::format("{}-{}", share[i], share[end - 1]);
      i = end;
    }
    text += line + "\n";
  }
  writeFileAtomically(file, text);
}

SharedPlan SharedPlan::load(const std::filesystem::path& file) {
  std::istringstream lines(readFile(file));
  std::size_t number = 0;
  std::string line;
  const auto fail = [&](const char* expected) {
    throw Error(fmt::format("{}:{}: '{}'; expected {}", file.string(), number, line, expected));
  };
  const auto next = [&](const char* expected) {
    ++number;
    if (!std::getline(lines, line)) fail(expected);
  };
  next("the first line of a plan");
  if (line != kHead) fail("the first line of a plan of this version");
  SharedPlan plan;
  std::size_t shares = 0;
  next("a hash and two numbers");
  std::istringstream head(line);
  if (!(head >> plan.hash >> plan.points >> shares)) fail("a hash and two numbers");
  for (std::size_t i = 0; i < shares; ++i) {
    next("a share");
    std::vector<std::size_t>& share = plan.shares.emplace_back();
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      const std::size_t dash = word.find('-');
      const auto first = wholeNumber(word.substr(0, dash));
      const auto last = dash == std::string::npos ? first : wholeNumber(word.substr(dash + 1));
      if (!first || !last || *last < *first || *last >= plan.points) fail("positions in the plan");
      for (std::size_t position = *first; position <= *last; ++position) share.push_back(position);
    }
  }
  return plan;
}

std::size_t tasksFor(const std::vector<double>& costs, std::size_t tasks, double taskSeconds) {
  if (tasks == 0) {
    const std::optional<double> mean = meanOf(costs);
    tasks = mean
                ? static_cast<std::size_t>(std::ceil(*mean * static_cast<double>(costs.size()) / taskSeconds))
                : kTasksUnknown;
  }
  return std::min({std::max<std::size_t>(tasks, 1), std::max<std::size_t>(costs.size(), 1), kMostTasks});
}

SharedPlan sharedPlan(const std::string& hash, std::size_t points, const std::vector<std::size_t>& positions,
                      const std::vector<double>& costs, std::size_t tasks, double taskSeconds) {
  SharedPlan plan{hash, points, {}};
  if (positions.empty()) return plan;
  const std::vector<std::size_t> cuts = cutsOf(costs, tasksFor(costs, tasks, taskSeconds));
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
    if (cuts[i] < cuts[i + 1])
      plan.shares.emplace_back(positions.begin() + static_cast<std::ptrdiff_t>(cuts[i]),
                               positions.begin() + static_cast<std::ptrdiff_t>(cuts[i + 1]));
  return plan;
}

std::vector<std::size_t> positionsOf(const Shard& shard, const std::filesystem::path& file,
                                     const std::string& hash, std::size_t points) {
  if (file.empty()) {
    const std::vector<std::size_t> cuts = cutsOf(std::vector<double>(points, 0.0), shard.count);
    std::vector<std::size_t> positions(cuts[shard.index] - cuts[shard.index - 1]);
    std::iota(positions.begin(), positions.end(), cuts[shard.index - 1]);
    return positions;
  }
  SharedPlan plan = SharedPlan::load(file);
  if (plan.hash != hash || plan.points != points)
    throw Error(fmt::format(
        "{}: it shares another plan, of {} points; expected that of this command, of {}: the same scenes, "
        "pipelines and options as when it was written",
        file.string(), plan.points, points));
  if (plan.shares.size() != shard.count)
    throw Error(fmt::format("{}: it has {} shares; expected --shard i/{}, found {}/{}", file.string(),
                            plan.shares.size(), plan.shares.size(), shard.index, shard.count));
  return std::move(plan.shares[shard.index - 1]);
}

}  // namespace lumivox
