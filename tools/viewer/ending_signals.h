// Handles SIGINT, SIGTERM and SIGHUP, so that the program removes its temporary files before it ends.
#pragma once

namespace lumivox::viewer {

/// While it lives, the first of these signals is only noted, so that the program can clean up and end. The
/// next one ends the process at once. Only one may exist at a time.
class EndingSignals {
 public:
  EndingSignals();
  ~EndingSignals();
  EndingSignals(const EndingSignals&) = delete;
  EndingSignals& operator=(const EndingSignals&) = delete;

  static bool came();
  /// Ends the process by the signal that came, as without a handler. Returns if none came.
  static void endByIt();
};

}  // namespace lumivox::viewer
