#include "gpu/driver_messages.h"

#include <fmt/format.h>

#include "lumivox/base/log.h"

namespace lumivox::gpu {

void DriverMessages::addError(std::string text) {
  constexpr std::size_t kKept = 8;  // the first ones explain the others
  if (errors_.size() < kKept) errors_.push_back(std::move(text));
}

void DriverMessages::hear(Kind kind, Severity severity, unsigned source, unsigned id, std::string text,
                          const std::string& pass) noexcept {
  try {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    if (kind == Kind::error) return addError(std::move(text));
    if (!told_.insert({kind, source, id}).second) return;
    const std::string where = pass.empty() ? "" : " in pass " + pass;
    if (kind == Kind::undefinedBehaviour || severity == Severity::high) {
      logWarning("the OpenGL driver says{}: {}", where, text);
    } else if (severity != Severity::notification) {
      logDetails("the OpenGL driver says{}: {}", where, text);
    }
  } catch (...) {
    // Out of memory while noting what the driver said: the next command will tell.
  }
}

std::string DriverMessages::takeErrors(const std::string& what) {
  std::string text = what;
  text += errors_.size() == 1 ? ": the OpenGL driver reports: " : ": the OpenGL driver reports:\n  ";
  text += fmt::format("{}", fmt::join(errors_, "\n  "));
  errors_.clear();
  return text;
}

}  // namespace lumivox::gpu
