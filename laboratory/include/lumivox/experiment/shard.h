// A plan in shares, for several processes or machines.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lumivox {

/// Share `index` of `count`, from 1 on. One of one: the whole plan.
struct Shard {
  std::size_t index = 1, count = 1;
  bool isWhole() const { return count == 1; }
};
/// From "2/3". Error, naming --shard, for anything else.
Shard shardOf(const std::string& text);

/// Cuts a sequence of parts into `count` shares of successive parts whose costs differ as little as
/// succession allows: a part belongs to the share in which the middle of its cost lies. Parts without a cost
/// (0) count like the mean of the others; without any cost all count the same. Returns count + 1 positions,
/// from 0 to the number of parts.
std::vector<std::size_t> cutsOf(const std::vector<double>& costs, std::size_t count);

/// The shares of a plan as lists of positions in it, kept in a file so that every task has the same.
struct SharedPlan {
  std::string hash;        ///< of the plan
  std::size_t points = 0;  ///< in the plan
  std::vector<std::vector<std::size_t>> shares;

  void write(const std::filesystem::path& file) const;
  /// Error that names the file and the line for anything that write() has not written.
  static SharedPlan load(const std::filesystem::path& file);
};

inline constexpr std::size_t kMostTasks = 1000;  ///< Slurm's MaxArraySize is 1001 unless set otherwise
inline constexpr std::size_t kTasksUnknown = 16;
/// How many shares for parts of these costs, s (0: unknown): `tasks`; with 0, so many that each takes about
/// `taskSeconds`, or kTasksUnknown without any cost. Never more than parts, or than kMostTasks.
std::size_t tasksFor(const std::vector<double>& costs, std::size_t tasks, double taskSeconds);

/// Shares these positions, with their costs, of a plan of so many points.
SharedPlan sharedPlan(const std::string& hash, std::size_t points, const std::vector<std::size_t>& positions,
                      const std::vector<double>& costs, std::size_t tasks, double taskSeconds);

/// The positions of a share in a plan of so many points: successive ones, or, if a file is named, what it
/// says. Error that names a file of another plan, or with another number of shares.
std::vector<std::size_t> positionsOf(const Shard& shard, const std::filesystem::path& file,
                                     const std::string& hash, std::size_t points);

}  // namespace lumivox
