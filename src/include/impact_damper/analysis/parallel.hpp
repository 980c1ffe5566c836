// Independent pieces of work, spread over threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace impact_damper {

// Number of threads. Absent: one for each processor. A number below 1 counts as 1.
using Threads = std::optional<std::int64_t>;

inline std::int64_t number_of(const Threads& threads) {
  return std::max<std::int64_t>(1, threads ? *threads : std::int64_t(std::thread::hardware_concurrency()));
}

// Calls work(i) once for every i in [0, count), in this thread and in others. Any free thread takes the next
// index, so work(i) must write only what belongs to i; results then do not depend on the number of threads.
// After an exception no further index is begun. When all threads have ended the exception of the smallest
// index that threw is rethrown, so that does not depend on the number of threads either.
template <class Work>
void for_each_index(std::int64_t count, const Threads& threads, Work&& work) {
  std::atomic<std::int64_t> next{0};
  std::atomic<bool> failed{false};
  std::mutex mutex;
  std::int64_t first_failure = count;
  std::exception_ptr failure;
  // Indices are taken in order: when one fails, every smaller one has been taken and is worked through.
  const auto take_indices = [&] {
    while (!failed) {
      const std::int64_t i = next++;
      if (i >= count) return;
      try {
        work(i);
      } catch (...) {
        failed = true;
        const std::lock_guard lock(mutex);
        if (i < first_failure) {
          first_failure = i;
          failure = std::current_exception();
        }
      }
    }
  };
  {
    struct Helpers {
      std::vector<std::thread> threads;
      ~Helpers() {
        for (std::thread& each : threads) each.join();
      }
    } helpers;
    try {
      for (std::int64_t n = std::min(number_of(threads), count); n > 1; --n)
        helpers.threads.emplace_back(take_indices);
    } catch (const std::system_error&) {
      // No more threads can be started: those that there are do the work.
    }
    take_indices();
  }
  if (failure) std::rethrow_exception(failure);
}

// Calls make(i) as for_each_index does work(i), and take(result) for the results in the order of i, one at a
// time. While one takes long, no more than most_ahead results of later ones wait for it.
template <class Make, class Take>
void for_each_in_order(std::int64_t count, const Threads& threads, Make&& make, Take&& take) {
  constexpr std::int64_t most_ahead = 1 << 14;
  std::mutex mutex;
  std::condition_variable moved;
  std::deque<std::optional<decltype(make(count))>> waiting;  // results of `next`, next + 1, ...
  std::int64_t next = 0;
  bool failed = false;
  for_each_index(count, threads, [&](std::int64_t i) {
    {
      std::unique_lock lock(mutex);
      moved.wait(lock, [&] { return i - next < most_ahead || failed; });
    }
    try {
      auto result = make(i);
      const std::lock_guard lock(mutex);
      const auto place = static_cast<std::size_t>(i - next);
      if (waiting.size() <= place) waiting.resize(place + 1);
      waiting[place] = std::move(result);
      for (; !failed && !waiting.empty() && waiting.front(); ++next) {
        take(std::move(*waiting.front()));
        waiting.pop_front();
      }
      moved.notify_all();
    } catch (...) {
      const std::lock_guard lock(mutex);
      failed = true;
      moved.notify_all();
      throw;
    }
  });
}

}  // namespace impact_damper
