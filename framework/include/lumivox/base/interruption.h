// What a process says when it is interrupted.
#pragma once

#include <string>

namespace lumivox {

/// While it lives, SIGINT (Ctrl-C), SIGTERM and SIGHUP end the process as ever, but with a word on stderr
/// about what is kept. Of several the last to speak is heard.
class InterruptionNote {
 public:
  InterruptionNote();
  ~InterruptionNote();
  InterruptionNote(const InterruptionNote&) = delete;
  InterruptionNote& operator=(const InterruptionNote&) = delete;
  void say(const std::string& text);
};

}  // namespace lumivox
