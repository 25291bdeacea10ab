#include "gpu/driver_messages.h"

#include <fmt/format.h>

#include "lumivox/base/log.h"

namespace lumivox::gpu {

void DriverMessages::addError(std::string text) {
  constexpr std::size_t kKept = 8;  // the first messages explain the others
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
    // Out of memory while a message was stored: the next command reports it.
  }
}

std::string DriverMessages::takeErrors(const std::string& what) {
  std::string text = what;
  text += errors_.size() == 1 ? ": the OpenGL driver reports: " : ": the OpenGL driver reports:\n  ";
  text += fmt::format("{}", fmt::join(errors_, "\n  "));
  errors_.clear();
  return text;
}

std::string lostContextText(Reset reset, const std::string& pass) {
  const char* why =
      reset == Reset::own ? "GL_GUILTY_CONTEXT_RESET: the device was reset while it ran commands of "
                            "this process, which took too long or reached beyond a resource"
      : reset == Reset::others
          ? "GL_INNOCENT_CONTEXT_RESET: the device was reset while it ran commands of another process"
          : "GL_UNKNOWN_CONTEXT_RESET: the device was reset, and the driver does not know why";
  const std::string where =
      pass.empty() ? ""
                   : fmt::format("; pass {} was under way, but an earlier command may be the cause", pass);
  return fmt::format("the OpenGL context is lost with all that it held ({}{}); run it again", why, where);
}

}  // namespace lumivox::gpu
