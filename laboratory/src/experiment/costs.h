// What the parts of a job took, and what follows for those that are left: the one estimate of remaining time.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

namespace lumivox::experiment {

/// Given as the time that is left: none is told.
inline constexpr double kUnknownSeconds = -1.0;

/// A part is some work on a subject, such as taking the times of a pipeline. Its weight is what is known of
/// its cost in advance, such as its frames, and makes parts of one work comparable.
class Costs {
 public:
  /// Only what was done here: a part that was found done elsewhere says nothing of those that are left.
  void add(const std::string& subject, const std::string& work, double weight, double seconds);

  /// s: as the same work on the same subject took. Before there is one: as that work took on other subjects,
  /// this one being as dear, compared with them, as in its other works. Nothing before there is such work.
  std::optional<double> expected(const std::string& subject, const std::string& work, double weight) const;

  /// s: as the dearest of the same work on the same subject; nothing before there is one.
  std::optional<double> most(const std::string& subject, const std::string& work, double weight) const;

 private:
  struct Taken {
    double weight = 0.0, seconds = 0.0, most = 0.0;  ///< sums; the most seconds for a weight of 1
    double parts = 0.0;
  };
  using Subjects = std::map<std::string, Taken>;

  /// Seconds of a part over its weight: of a work that of all subjects together, in which one that had more
  /// parts than others counts no more, but a dearer one does.
  static double meanRate(const Subjects& subjects);
  /// How dear a subject is, compared with all that had the same works: 1 where none of its works is known.
  double share(const std::string& subject) const;

  std::map<std::string, Subjects> works_;
};

}  // namespace lumivox::experiment
