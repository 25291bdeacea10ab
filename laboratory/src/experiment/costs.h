// What the finished parts of a job took, and from that the estimate of the remaining time. Every estimate is
// made here.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

namespace lumivox::experiment {

/// Given as the remaining time where none is told.
inline constexpr double kUnknownSeconds = -1.0;

/// A part is one kind of work on one subject, such as timing a pipeline. Its weight, such as a number of
/// frames, is the cost that is known in advance; it makes parts of one kind of work comparable.
class Costs {
 public:
  /// Records a part that was done here. A part found done elsewhere says nothing about those that are left.
  void add(const std::string& subject, const std::string& work, double weight, double seconds);

  /// Expected time, s: as the same work on the same subject took. Before there is one, the time on other
  /// subjects, scaled by how dear this subject was in its other kinds of work. Empty before any such work.
  std::optional<double> expected(const std::string& subject, const std::string& work, double weight) const;

  /// Longest time, s: as the dearest part of the same work on the same subject; empty before there is one.
  std::optional<double> most(const std::string& subject, const std::string& work, double weight) const;

 private:
  struct Taken {
    double weight = 0.0, seconds = 0.0, most = 0.0;  ///< sums; the most seconds for a weight of 1
    double parts = 0.0;
  };
  using Subjects = std::map<std::string, Taken>;

  /// Seconds per weight over all subjects of one kind of work. A subject with more parts than others counts
  /// no more; a dearer one does.
  static double meanRate(const Subjects& subjects);
  /// Cost of a subject over that of all subjects with the same kinds of work; 1 where none of its work is
  /// known.
  double share(const std::string& subject) const;

  std::map<std::string, Subjects> works_;
};

}  // namespace lumivox::experiment
