#include "impact_damper/analysis/parallel.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <stdexcept>
#include <string>

using namespace impact_damper;

TEST_CASE("every index is worked on once, with any number of threads and of indices") {
  for (const std::int64_t count : {0, 1, 2, 1000})
    for (const Threads threads : {Threads{}, Threads{1}, Threads{2}, Threads{7}, Threads{50}}) {
      std::vector<int> times(static_cast<std::size_t>(count), 0);
      for_each_index(count, threads, [&](std::int64_t i) { ++times[static_cast<std::size_t>(i)]; });
      CHECK(times == std::vector<int>(static_cast<std::size_t>(count), 1));
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
  for (const std::int64_t threads : {1, 2, 7})
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

TEST_CASE("results come in the order of their indices, with any number of threads") {
  for (const std::int64_t threads : {1, 2, 7}) {
    std::vector<std::int64_t> taken;
    for_each_in_order(
        2000, Threads{threads},
        [](std::int64_t i) {
          if (i % 17 == 0)
            std::this_thread::sleep_for(std::chrono::microseconds(300));  // overtaken meanwhile
          return i;
        },
        [&](std::int64_t result) { taken.push_back(result); });
    REQUIRE(taken.size() == 2000);
    CHECK(std::is_sorted(taken.begin(), taken.end()));
    CHECK(taken.back() == 1999);
  }
}

TEST_CASE("where one result takes long, only so many later ones wait for it") {
  std::atomic<std::int64_t> furthest{0};
  std::int64_t furthest_at_end_of_first = 0;
  for_each_in_order(
      50'000, Threads{2},
      [&](std::int64_t i) {
        if (i == 0) {
          std::this_thread::sleep_for(std::chrono::milliseconds(200));
          furthest_at_end_of_first = furthest;
        }
        for (std::int64_t seen = furthest; seen < i && !furthest.compare_exchange_weak(seen, i);) {
        }
        return i;
      },
      [](std::int64_t) {});
  CHECK(furthest_at_end_of_first > 1000);
  CHECK(furthest_at_end_of_first <= 1 << 14);
}

TEST_CASE("what fails while results are made or taken ends all, and reaches the caller") {
  for (const std::int64_t threads : {1, 2, 7}) {
    const auto fails = [&](std::int64_t making, std::int64_t taking) {
      for_each_in_order(
          100'000, Threads{threads},
          [&](std::int64_t i) {
            if (i == making) throw std::runtime_error("made");
            return i;
          },
          [&](std::int64_t i) {
            if (i == taking) throw std::runtime_error("taken");
          });
    };
    CHECK_THROWS_WITH(fails(500, -1), "made");
    CHECK_THROWS_WITH(fails(-1, 500), "taken");
  }
}
