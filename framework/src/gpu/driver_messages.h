// Messages of the driver while commands run. No OpenGL here, so that it can be tested without a driver that
// speaks.
#pragma once

#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace lumivox::gpu {

/// Errors wait until somebody throws them; everything else is advice, which is logged once each.
class DriverMessages {
 public:
  enum class Kind { error, undefinedBehaviour, advice };
  enum class Severity { notification, low, high };
  /// `source` and `id` tell one piece of advice from another, whatever buffer or program its text names. May
  /// be called by the driver, through which no exception may pass: it throws nothing.
  void hear(Kind kind, Severity severity, unsigned source, unsigned id, std::string text,
            const std::string& pass) noexcept;

  bool hasErrors() const { return !errors_.empty(); }
  void addError(std::string text);
  /// "what: the OpenGL driver reports: ..."; the errors are then forgotten.
  std::string takeErrors(const std::string& what);
  void forgetErrors() { errors_.clear(); }

 private:
  std::vector<std::string> errors_;
  std::set<std::tuple<Kind, unsigned, unsigned>> told_;
};

/// Why a context was lost, as the driver tells it (OpenGL 4.5, 2.3.2): this process's own commands, somebody
/// else's, or nobody knows.
enum class Reset { own, others, unknown };
/// "the OpenGL context is lost: ..."; the pass is the one under way, empty for none.
std::string lostContextText(Reset reset, const std::string& pass);

}  // namespace lumivox::gpu
