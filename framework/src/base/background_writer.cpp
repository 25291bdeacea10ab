#include "lumivox/base/background_writer.h"

#include <utility>

#include "lumivox/base/log.h"

namespace lumivox {
namespace {

/// Beside the image being written, one waiting image keeps the thread busy; more would only take memory.
constexpr std::size_t kMostWaiting = 1;

}  // namespace

BackgroundWriter::~BackgroundWriter() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (!failure_) return;
  try {
    std::rethrow_exception(failure_);
  } catch (const std::exception& error) {
    logWarning("{}", error.what());
  } catch (...) {
    logWarning("a file could not be written");
  }
}

void BackgroundWriter::submit(std::function<void()> write) {
  std::unique_lock lock(mutex_);
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  changed_.wait(lock, [this] { return waiting_.size() < kMostWaiting || failed_; });
  throwFailure();
  if (failed_) return;  // the failure was reported before
  waiting_.push_back(std::move(write));
  lock.unlock();
  changed_.notify_all();
}

void BackgroundWriter::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.empty() && !busy_; });
  throwFailure();
}

void BackgroundWriter::throwFailure() {
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void BackgroundWriter::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return !waiting_.empty() || ending_; });
    if (waiting_.empty()) return;
    std::function<void()> write = std::move(waiting_.front());
    waiting_.pop_front();
    busy_ = true;
    lock.unlock();
    changed_.notify_all();
    std::exception_ptr failure;
    try {
      write();
    } catch (...) {
      failure = std::current_exception();
    }
    write = nullptr;  // frees its images before the next are taken
    lock.lock();
    busy_ = false;
    if (failure) {
      failure_ = failure;
      failed_ = true;
      waiting_.clear();
    }
    changed_.notify_all();
  }
}

}  // namespace lumivox
