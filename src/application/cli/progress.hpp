// Messages about the progress of a command that takes long.
#pragma once

#include <chrono>
#include <condition_variable>
#include <iostream>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

namespace impact_damper::cli {

// Reports on stderr what is being done: nothing in the first two seconds, then once a second if it has
// changed, and at least every ten seconds; after minutes less often, so that the log of a day has 500 lines.
// A thread of its own reports it, also during a long simulation.
class ProgressOnStderr {
 public:
  explicit ProgressOnStderr(std::string command) : command_(std::move(command)) {
    try {
      teller_ = std::thread([this] { tell(); });
    } catch (const std::system_error&) {
      // Without a thread the work continues without messages.
    }
  }
  ProgressOnStderr(const ProgressOnStderr&) = delete;
  ProgressOnStderr& operator=(const ProgressOnStderr&) = delete;
  ~ProgressOnStderr() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    changed_.notify_all();
    if (teller_.joinable()) teller_.join();
  }
  void operator()(const std::string& doing) {
    const std::lock_guard lock(mutex_);
    doing_ = doing;
  }

 private:
  void tell() {
    using namespace std::chrono_literals;
    constexpr int first = 2, at_least_every = 10;  // seconds
    constexpr int minute = 60;                     // after n minutes at most a line in n seconds
    std::string told;
    std::unique_lock lock(mutex_);
    for (int second = 1, last = 0; !changed_.wait_for(lock, 1s, [&] { return ended_; }); ++second) {
      const int silent = second - last;
      if (second < first || doing_.empty() || silent < second / minute) continue;
      if (doing_ == told && silent < at_least_every) continue;
      std::cerr << command_ << ": " << doing_
                << (doing_ == told ? ", " + std::to_string(second) + " s since the start" : "") << std::endl;
      told = doing_;
      last = second;
    }
  }

  std::string command_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string doing_;
  bool ended_ = false;
  std::thread teller_;
};

}  // namespace impact_damper::cli
