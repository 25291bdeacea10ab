#include "base/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/start_process.h"

namespace lumivox {
namespace {

using Clock = std::chrono::steady_clock;

/// The number of kept bytes of standard error.
constexpr std::size_t kWordsKept = 4096;

}  // namespace

Child::Child(const std::vector<std::string>& words, const std::vector<std::string>& environment) {
  int requests[2], answers[2], messages[2];
  // A socket, because a write to a closed socket can be told not to raise a signal.
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, requests) != 0 || pipe2(answers, O_CLOEXEC) != 0 ||
      pipe2(messages, O_CLOEXEC) != 0)
    throw Error(fmt::format("cannot start '{}': {}", words.at(0), std::strerror(errno)));
  const auto closeAll = [](std::initializer_list<int> files) {
    for (const int file : files) close(file);
  };
  try {
    // In a process group of its own, so that its children end with it.
    process_ = startProcess({words, environment, requests[1], answers[1], messages[1], true});
  } catch (const Error&) {
    closeAll({requests[0], requests[1], answers[0], answers[1], messages[0], messages[1]});
    throw;
  }
  closeAll({requests[1], answers[1], messages[1]});
  requests_ = requests[0];
  answers_ = answers[0];
  messages_ = messages[0];
}

Child::~Child() {
  if (!status_) {
    kill(-process_, SIGKILL);
    int status = 0;
    waitpid(process_, &status, 0);
  }
  for (const int file : {requests_, answers_, messages_}) close(file);
}

void Child::send(const std::string& line) {
  const std::string text = line + "\n";
  write(std::as_bytes(std::span(text.data(), text.size())));
}

bool Child::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    // Its messages are read meanwhile, so that it never waits for a reader.
    pollfd files[] = {{requests_, POLLOUT, 0}, {messagesOpen_ ? messages_ : -1, POLLIN, 0}};
    poll(files, 2, -1);
    if (files[1].revents != 0) readMessages();
    if (files[0].revents == 0) continue;
    const ssize_t count = ::send(requests_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

void Child::closeInput() {
  shutdown(requests_, SHUT_WR);
}

void Child::read(int file, std::string& into, bool& open) {
  char buffer[4096];
  const ssize_t count = ::read(file, buffer, sizeof(buffer));
  if (count > 0)
    into.append(buffer, static_cast<std::size_t>(count));
  else if (count == 0 || errno != EINTR)
    open = false;
}

void Child::readMessages() {
  read(messages_, errors_, messagesOpen_);
  if (errors_.size() > 2 * kWordsKept) errors_.erase(0, errors_.size() - kWordsKept);
}

Child::Answer Child::receive(double seconds) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    if (const std::size_t newline = pending_.find('\n'); newline != std::string::npos) {
      Answer answer{State::answered, pending_.substr(0, newline)};
      pending_.erase(0, newline + 1);
      return answer;
    }
    if (!answersOpen_) {
      // Its last messages may contain the reason.
      while (messagesOpen_) readMessages();
      return {State::ended, {}};
    }
    const double left = std::chrono::duration<double>(end - Clock::now()).count();
    if (left <= 0.0) return {State::silent, {}};
    pollfd files[] = {{answers_, POLLIN, 0}, {messagesOpen_ ? messages_ : -1, POLLIN, 0}};
    poll(files, 2, static_cast<int>(std::ceil(std::min(left, 3600.0) * 1000.0)));
    if (files[1].revents != 0) readMessages();
    if (files[0].revents != 0) read(answers_, pending_, answersOpen_);
  }
}

void Child::waitForEnd() {
  if (status_) return;
  // Its children are killed before its process number can be reused.
  siginfo_t information{};
  while (waitid(P_PID, static_cast<id_t>(process_), &information, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  kill(-process_, SIGKILL);
  int status = 0;
  if (waitpid(process_, &status, 0) == process_) status_ = status;
}

bool Child::succeeded() {
  waitForEnd();
  return status_ && WIFEXITED(*status_) && WEXITSTATUS(*status_) == 0;
}

std::string Child::ending() {
  waitForEnd();
  if (!status_) return "ended";
  if (WIFSIGNALED(*status_))
    return fmt::format("killed by signal {} ({})", WTERMSIG(*status_), strsignal(WTERMSIG(*status_)));
  return fmt::format("ended with exit code {}", WEXITSTATUS(*status_));
}

std::string Child::lastWords() const {
  std::string words = errors_.size() > kWordsKept ? errors_.substr(errors_.size() - kWordsKept) : errors_;
  while (!words.empty() && words.back() == '\n') words.pop_back();
  return words;
}

std::filesystem::path programOnPath(const std::string& name, const std::string& purpose,
                                    const std::string& package, const std::string& otherwise) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path program = std::filesystem::path(folder.empty() ? "." : folder) / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(program, ignored) && access(program.c_str(), X_OK) == 0)
      return program;
  }
  throw AbsentError(fmt::format("{}, {}, is not on the PATH; install it (Debian: apt-get install {}), or {}",
                                name, purpose, package, otherwise));
}

}  // namespace lumivox
