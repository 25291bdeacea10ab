// Messages of the driver while commands run. Without OpenGL, so that tests need no driver that sends any.
#pragma once

#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace lumivox::gpu {

/// Stores errors until a caller throws them. All other messages are advice, and each is logged once.
class DriverMessages {
 public:
  enum class Kind { error, undefinedBehaviour, advice };
  enum class Severity { notification, low, high };
  /// `source` and `id` identify a piece of advice, whatever buffer or program its text names. The driver
  /// calls this function, and no exception may pass through it: it throws nothing.
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

/// Why a context was lost, as the driver reports it (OpenGL 4.5, 2.3.2): by this process's commands, by those
/// of another, or for an unknown reason.
enum class Reset { own, others, unknown };
/// "the OpenGL context is lost: ..."; `pass`: the running pass, empty for none.
std::string lostContextText(Reset reset, const std::string& pass);

}  // namespace lumivox::gpu
