// SIGINT, SIGTERM and SIGHUP, which would leave behind what the program has among temporary files.
#pragma once

namespace lumivox::viewer {

/// While it lives, the first of these signals is only noted, so that the program can put away what it has and
/// end; one more ends it where it is. One of these at a time.
class EndingSignals {
 public:
  EndingSignals();
  ~EndingSignals();
  EndingSignals(const EndingSignals&) = delete;
  EndingSignals& operator=(const EndingSignals&) = delete;

  static bool came();
  /// Ends the process by the signal that came, as if nobody had waited; returns where none came.
  static void endByIt();
};

}  // namespace lumivox::viewer
