// The message of an interrupted process.
#pragma once

#include <string>

namespace lumivox {

/// While it lives, SIGINT (Ctrl-C), SIGTERM and SIGHUP end the process as usual, with a message on stderr
/// about what is kept. Of several objects the last one that set a message writes it.
class InterruptionNote {
 public:
  InterruptionNote();
  ~InterruptionNote();
  InterruptionNote(const InterruptionNote&) = delete;
  InterruptionNote& operator=(const InterruptionNote&) = delete;
  void say(const std::string& text);
};

}  // namespace lumivox
