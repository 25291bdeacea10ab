// Files written on a thread of their own, while the next ones are made.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace lumivox {

/// Runs what writes files (encoding an image takes as long as rendering one) in the order in which it is
/// given, one at a time.
class BackgroundWriter {
 public:
  BackgroundWriter() = default;
  /// Waits until everything is written, and logs a failure that was not thrown.
  ~BackgroundWriter();
  BackgroundWriter(const BackgroundWriter&) = delete;
  BackgroundWriter& operator=(const BackgroundWriter&) = delete;

  /// `write` throws when it fails; its message should name the file. Blocks while the queue is full. Throws
  /// the error of an earlier `write`: after a failure nothing more is written.
  void submit(std::function<void()> write);
  /// Waits until everything is written; throws the first failure.
  void finish();

 private:
  void run();
  void throwFailure();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  bool busy_ = false, ending_ = false, failed_ = false;
  std::exception_ptr failure_;  ///< not yet thrown to the user
  std::thread thread_;          ///< started with the first file
};

}  // namespace lumivox
