// Warnings with a place, and who takes them.
#pragma once

#include <utility>
#include <vector>

#include "lumivox/base/error.h"

namespace lumivox {

/// Logs a warning that has a place. One that was told before in this process is not told again.
void logFinding(const Diagnostic& finding);

/// Takes the warnings of this thread while it lives, in place of the log: those with a place as they are,
/// those of logWarning() without one. The innermost one takes them.
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
