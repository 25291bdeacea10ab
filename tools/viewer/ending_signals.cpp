#include "viewer/ending_signals.h"

#include <csignal>

namespace lumivox::viewer {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t noted = 0;

void note(int signal);

/// Async-signal-safe: note() calls it.
void replace(void (*from)(int), void (*to)(int)) {
  for (const int signal : kSignals) {
    struct sigaction current {};
    sigaction(signal, nullptr, &current);
    // A signal that the process was started to ignore (nohup) stays ignored.
    if (current.sa_handler == from) std::signal(signal, to);
  }
}

void note(int signal) {
  noted = signal;
  replace(note, SIG_DFL);
}

}  // namespace

EndingSignals::EndingSignals() {
  replace(SIG_DFL, note);
}

EndingSignals::~EndingSignals() {
  replace(note, SIG_DFL);
}

bool EndingSignals::came() {
  return noted != 0;
}

void EndingSignals::endByIt() {
  if (noted == 0) return;
  std::signal(noted, SIG_DFL);
  raise(noted);
}

}  // namespace lumivox::viewer
