#include "impact_damper/analysis/parallel.hpp"

#include <doctest/doctest.h>

#include <set>
#include <stdexcept>
#include <string>

using namespace impact_damper;

TEST_CASE("every index is worked on once, with any number of threads and of indices") {
  for (const std::int64_t count : {0, 1, 2, 1000}) {
    for (const Threads threads : {Threads{}, Threads{1}, Threads{2}, Threads{7}, Threads{50}}) {
      std::vector<int> times(static_cast<std::size_t>(count), 0);
      for_each_index(count, threads, [&](std::int64_t i) { ++times[static_cast<std::size_t>(i)]; });
      CHECK(times == std::vector<int>(static_cast<std::size_t>(count), 1));
    }
  }
}

TEST_CASE("no more threads work than are asked for, and each of them can") {
  std::mutex mutex;
  std::set<std::thread::id> workers;
  std::atomic<int> waiting{0};
  for_each_index(3, Threads{3}, [&](std::int64_t) {
    ++waiting;
    while (waiting < 3) std::this_thread::yield();  // so that none can take a second index
    const std::lock_guard lock(mutex);
    workers.insert(std::this_thread::get_id());
  });
  CHECK(workers.size() == 3);
  CHECK(workers.contains(std::this_thread::get_id()));

  workers.clear();
  for_each_index(100, Threads{1}, [&](std::int64_t) { workers.insert(std::this_thread::get_id()); });
  CHECK(workers == std::set{std::this_thread::get_id()});
}

TEST_CASE("what reaches the caller is what the smallest failing index throws, with any number of threads") {
  for (const std::int64_t threads : {1, 2, 7}) {
    for (int repeat = 0; repeat < 50; ++repeat) {
      std::string said;
      try {
        for_each_index(100, threads, [](std::int64_t i) {
          if (i == 40) std::this_thread::yield();  // gives the later ones a chance to be first
          if (i >= 40 && i % 2 == 0) throw std::runtime_error(std::to_string(i));
        });
      } catch (const std::runtime_error& error) {
        said = error.what();
      }
      CHECK(said == "40");
    }
  }
}
