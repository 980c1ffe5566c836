#include "impact_damper/analysis/regimes.hpp"

#include <doctest/doctest.h>

#include <stdexcept>
#include <utility>

#include "impact_damper/motion/wall.hpp"

using namespace impact_damper;

namespace {

// Half cycles one unit of time long, row i ending at i + 1, amplitudes falling from 10 by 0.1.
Run rows_with_impacts(std::vector<std::int64_t> impacts) {
  Run run;
  run.engine = Exact{};
  run.half_cycles.emplace();
  for (std::size_t i = 0; i < impacts.size(); ++i) {
    run.half_cycles->zero_crossing.push_back(static_cast<double>(i) + 1);
    run.half_cycles->peak_time.push_back(static_cast<double>(i) + 0.5);
    run.half_cycles->amplitude.push_back(10 - 0.1 * static_cast<double>(i));
  }
  run.half_cycles->impacts = std::move(impacts);
  return run;
}
std::optional<std::size_t> row_of(const std::optional<HalfCycleRow>& half_cycle) {
  return half_cycle ? std::optional(half_cycle->row) : std::nullopt;
}
double amplitude_of(std::size_t row) { return 10 - 0.1 * static_cast<double>(row); }

// Sticks to the wall in the last tenth of each of these rows.
Run rows_sticking(std::size_t count, const std::vector<std::size_t>& rows) {
  Run run = rows_with_impacts(std::vector<std::int64_t>(count, 9));
  run.contacts.emplace();
  for (std::size_t row : rows) {
    run.contacts->begin.push_back(static_cast<double>(row) + 0.9);
    run.contacts->end.push_back(static_cast<double>(row) + 1.0);
    run.contacts->wall.push_back(Wall::left);
  }
  return run;
}

}  // namespace

TEST_CASE("a compliant contact is stuck once it outlasts a full period, a rigid one always") {
  Run run = rows_with_impacts({1, 1});
  const double nominal = nominal_contact_time(run.scene.damper());
  run.contacts = Contacts{{0.1, 0.3, 1.2},
                          {0.1 + nominal, 0.3 + 1.99 * nominal, 1.2 + 2.01 * nominal},
                          {Wall::left, Wall::right, Wall::left},
                          {}};
  CHECK(stuck_contacts(run).begin == std::vector<double>{1.2});
  run.engine = Restitution{};
  CHECK(stuck_contacts(run).begin.size() == 3);
}

TEST_CASE("stuck intervals are cut at the zero crossings and given in degrees") {
  Run run = rows_with_impacts({1, 1, 1, 1});
  run.engine = Restitution{};
  run.contacts = Contacts{{0.5, 1.5, 2.25}, {0.75, 2.125, 9}, {Wall::left, Wall::right, Wall::left}, {}};
  const StuckPhases phases = stuck_phases(run);
  CHECK(phases.begin_deg == std::vector<double>{90, 0, 45, 0});
  CHECK(phases.end_deg == std::vector<double>{180, 22.5, 180, 180});
  CHECK(phases.amplitude ==
        std::vector<double>{amplitude_of(1), amplitude_of(2), amplitude_of(2), amplitude_of(3)});
}

TEST_CASE("bounce-down ends with the first unbroken series of stuck half cycles") {
  CHECK(row_of(end_of_bounce_down(rows_sticking(20, {1, 2, 3, 4, 5, 6}))) == 6u);
  // Row 0 counts for nothing, and a stuck phase met by chance later on neither.
  CHECK(row_of(end_of_bounce_down(rows_sticking(20, {0, 1, 2, 3, 4, 9, 12}))) == 4u);
  CHECK(row_of(end_of_bounce_down(rows_sticking(20, {2, 5, 6, 9}))) == std::nullopt);
  CHECK(row_of(end_of_bounce_down(rows_sticking(20, {2, 5, 6, 9, 10, 11, 12, 13}))) == 13u);
  CHECK(row_of(end_of_bounce_down(rows_sticking(6, {1, 2, 3, 4, 5}))) == std::nullopt);
  CHECK(row_of(end_of_bounce_down(rows_sticking(6, {}))) == std::nullopt);
}

TEST_CASE("an impact that slips across a zero crossing is not missed") {
  CHECK(row_of(impact_failure(rows_with_impacts({1, 1, 2, 0, 1, 1, 0, 2, 1})).first_missed) == std::nullopt);
  CHECK(row_of(impact_failure(rows_with_impacts({0, 1, 1, 1, 1})).first_missed) == std::nullopt);
  const ImpactFailure once = impact_failure(rows_with_impacts({1, 2, 0, 1, 1, 0, 1, 1, 1, 1}));
  CHECK(row_of(once.first_missed) == 5u);
  CHECK(row_of(once.for_good) == std::nullopt);
}

TEST_CASE("the release, less than a half cycle, makes no impact failure") {
  // Its row is among no three that are looked at: neither for the first missed impact nor for good.
  CHECK(row_of(impact_failure(rows_with_impacts({0, 0, 1, 2, 1, 1, 1})).first_missed) == std::nullopt);
  CHECK(row_of(impact_failure(rows_with_impacts({0, 0, 0, 1, 0})).first_missed) == 2u);
  CHECK(row_of(impact_failure(rows_with_impacts({0, 1, 0, 1, 0})).for_good) == 2u);
  CHECK(row_of(impact_failure(rows_with_impacts({0, 0, 0, 0, 0})).for_good) == 1u);
}

TEST_CASE("an impact missed in a chaotic range is no failure if regular impacting follows") {
  std::vector<std::int64_t> impacts{1, 1, 0, 1, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1, 0, 0, 0};
  CHECK(row_of(impact_failure(rows_with_impacts(impacts)).first_missed) == 14u);
  RegimeOptions longer;
  longer.window_half_cycles = 100;
  CHECK(row_of(impact_failure(rows_with_impacts(impacts), longer).first_missed) == 2u);
}

TEST_CASE("impact failure is for good where no three half cycles bring three impacts any more") {
  const Run run = rows_with_impacts({1, 1, 0, 1, 1, 1, 1, 0, 1, 0, 0, 1, 0, 0});
  const ImpactFailure failure = impact_failure(run);
  CHECK(failure_row(run) == 2);
  CHECK(row_of(failure.first_missed) == 2u);
  CHECK(row_of(failure.for_good) == 7u);
  CHECK(row_of(impact_failure(rows_with_impacts({1, 0})).for_good) == std::nullopt);
  CHECK(row_of(impact_failure(rows_with_impacts({})).for_good) == std::nullopt);
  CHECK(row_of(impact_failure(rows_with_impacts({1, 0, 0, 0, 3})).for_good) == std::nullopt);
}

TEST_CASE("half cycles of equal amplitude are told apart by their rows") {
  // Without viscous damping an amplitude is kept to the bit from one half cycle to the next.
  Run run = rows_sticking(12, {1, 2, 3, 4, 5});
  run.half_cycles->amplitude.assign(12, 2.5);
  run.half_cycles->impacts = {1, 1, 1, 1, 1, 1, 1, 0, 1, 0, 0, 0};
  const ImpactFailure failure = impact_failure(run);
  CHECK(row_of(failure.first_missed) == 7u);
  CHECK(row_of(failure.for_good) == 7u);
  CHECK(failure.first_missed->amplitude == 2.5);
  CHECK(failure_row(run) == 7);
  run.half_cycles->impacts.back() = 3;
  CHECK(row_of(end_of_bounce_down(run)) == 5u);
  CHECK(end_of_bounce_down(run)->amplitude == 2.5);
  CHECK(failure_row(rows_with_impacts({1, 1, 1, 1, 1, 1, 1, 1})) == 8);
}

TEST_CASE("regular windows are maximal series of equal counts") {
  const std::vector<RegularWindow> windows = regular_windows(rows_with_impacts(
      {3, 3, 3, 3, 3, 3, 3, 3, 3, 2, 1, 2, 2, 2, 2, 2, 2, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  REQUIRE(windows.size() == 1);
  CHECK(windows[0].impacts == 3);
  CHECK(windows[0].first == 1);
  CHECK(windows[0].last == 8);
  CHECK(windows[0].upper == amplitude_of(1));
  CHECK(windows[0].lower == amplitude_of(8));
  RegimeOptions shorter;
  shorter.window_half_cycles = 7;
  CHECK(regular_windows(rows_with_impacts({3, 2, 2, 2, 2, 2, 2, 2}), shorter).size() == 1);
}

TEST_CASE("the longest window of a count is chosen, the earlier of two equals") {
  const std::vector<RegularWindow> windows{{2, 1, 9, 5, 4}, {1, 10, 30, 4, 3}, {2, 31, 39, 3, 2}};
  CHECK(longest_window(windows, 2)->first == 1);
  CHECK(longest_window(windows, 1)->first == 10);
  CHECK(!longest_window(windows, 3));
}

TEST_CASE("the first half cycle below an amplitude is found, or its absence") {
  const Run run = rows_with_impacts({1, 1, 1});
  CHECK(first_row_below(*run.half_cycles, 9.95) == 1u);
  CHECK(first_row_below(*run.half_cycles, 11) == 0u);
  CHECK(!first_row_below(*run.half_cycles, 1));
}

TEST_CASE("a rule that lacks its columns says which") {
  Run run;
  CHECK_THROWS_AS(regular_windows(run), std::invalid_argument);
  CHECK_THROWS_AS(stuck_contacts(run), std::invalid_argument);
  CHECK_THROWS_AS(time_below(run, 1), std::invalid_argument);
}
