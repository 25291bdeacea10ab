// Warnings with a place, and who takes them.
#pragma once

#include <utility>
#include <vector>

#include "lumivox/base/error.h"

namespace lumivox {

/// Logs a warning with a place, once in this process.
void logFinding(const Diagnostic& finding);

/// Receives the warnings of this thread while it lives, in place of the log; those of logWarning() have no
/// place. The innermost object receives them.
class WarningCollector {
 public:
  WarningCollector();
  ~WarningCollector();
  WarningCollector(const WarningCollector&) = delete;
  WarningCollector& operator=(const WarningCollector&) = delete;
  const std::vector<Diagnostic>& findings() const { return findings_; }
  void add(Diagnostic finding) { findings_.push_back(std::move(finding)); }

 private:
  std::vector<Diagnostic> findings_;
  WarningCollector* outer_;
};

}  // namespace lumivox
