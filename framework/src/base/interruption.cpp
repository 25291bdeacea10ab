#include "lumivox/base/interruption.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <deque>

namespace lumivox {
namespace {

constexpr int kInterruptions[] = {SIGINT, SIGTERM, SIGHUP};

std::atomic<const std::string*> lastWord{nullptr};
static_assert(std::atomic<const std::string*>::is_always_lock_free);

/// All texts so far. None is freed, since a signal handler may be reading it.
std::deque<std::string> wordsSaid;
int notes = 0;

/// Calls only what may be called from a signal handler.
void endWithWord(int signal) {
  if (const std::string* word = lastWord.load()) [[maybe_unused]]
    const ssize_t written = write(STDERR_FILENO, word->data(), word->size());
  std::signal(signal, SIG_DFL);
  raise(signal);
}

void replaceHandler(int signal, void (*from)(int), void (*to)(int)) {
  struct sigaction current {};
  sigaction(signal, nullptr, &current);
  // A process that was started with the signal ignored goes on ignoring it.
  if (current.sa_handler == from) std::signal(signal, to);
}

}  // namespace

InterruptionNote::InterruptionNote() {
  if (notes++ > 0) return;
  for (const int signal : kInterruptions) replaceHandler(signal, SIG_DFL, endWithWord);
}

InterruptionNote::~InterruptionNote() {
  if (--notes > 0) return;
  for (const int signal : kInterruptions) replaceHandler(signal, endWithWord, SIG_DFL);
  lastWord = nullptr;
}

void InterruptionNote::say(const std::string& text) {
  // On a line of its own, since the current one may hold "^C" or a progress bar.
  wordsSaid.push_back("\n" + text + "\n");
  lastWord = &wordsSaid.back();
}

}  // namespace lumivox
