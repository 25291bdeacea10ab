// A thread that works on the latest wish only, and skips older ones that it has not begun.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace lumivox::viewer {

/// `Wish` describes the work, `Result` its result. The work runs on its own thread, which sleeps while there
/// is no wish, and may give several results for one wish.
template <class Wish, class Result>
class LatestWorker {
 public:
  class Turn;
  /// Does the work of one wish: gives results, and returns early once Turn::outdated() is true. It must not
  /// throw.
  using Work = std::function<void(const Wish& wish, Turn& turn)>;

  /// The worker's interface to the work.
  class Turn {
   public:
    void give(Result result) { worker_.deliver(std::move(result)); }
    /// True once another wish waits or the wish was withdrawn.
    const std::atomic<bool>& outdated() const { return worker_.outdated_; }

   private:
    friend class LatestWorker;
    explicit Turn(LatestWorker& worker) : worker_(worker) {}
    LatestWorker& worker_;
  };

  /// `makeWork` is called on the new thread, so that objects of the work (a device) are created and destroyed
  /// there. `wake` is called from that thread after each result.
  LatestWorker(std::function<Work()> makeWork, std::function<void()> wake)
      : wake_(std::move(wake)), thread_([this, makeWork = std::move(makeWork)] { run(makeWork()); }) {}
  ~LatestWorker() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
      outdated_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  LatestWorker(const LatestWorker&) = delete;
  LatestWorker& operator=(const LatestWorker&) = delete;

  void want(Wish wish) {
    {
      const std::lock_guard lock(mutex_);
      wish_ = std::move(wish);
      outdated_ = true;
    }
    changed_.notify_all();
  }
  /// Withdraws the current wish and the waiting one.
  void stop() {
    const std::lock_guard lock(mutex_);
    wish_.reset();
    outdated_ = true;
  }
  /// The latest result, if it was not taken yet.
  std::optional<Result> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(result_, std::nullopt);
  }
  /// Whether a wish is not finished yet.
  bool busy() const {
    const std::lock_guard lock(mutex_);
    return works_ || wish_.has_value();
  }

 private:
  void deliver(Result result) {
    {
      const std::lock_guard lock(mutex_);
      result_ = std::move(result);
    }
    wake_();
  }
  void run(const Work& work) {
    Turn turn(*this);
    for (;;) {
      std::optional<Wish> wish;
      {
        std::unique_lock lock(mutex_);
        works_ = false;
        changed_.wait(lock, [this] { return ends_ || wish_.has_value(); });
        if (ends_) return;
        wish = std::exchange(wish_, std::nullopt);
        outdated_ = false;
        works_ = true;
      }
      work(*wish, turn);
    }
  }

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Wish> wish_;
  std::optional<Result> result_;
  bool works_ = false, ends_ = false;
  std::atomic<bool> outdated_{false};
  std::thread thread_;  // last member: the thread uses all others
};

}  // namespace lumivox::viewer
