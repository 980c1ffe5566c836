#include "application/reproduction/measures.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "application/reproduction/measures_parts.hpp"
#include "application/reproduction/scene_runs.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"
#include "rejection.hpp"

using namespace impact_damper;

namespace {

Runs no_runs("no such folder");

double value(const std::string& name, std::map<std::string, double> numbers) {
  const Spread spread = measure(no_runs, {name, {}, std::move(numbers)});
  CHECK(spread.low == spread.median);
  CHECK(spread.high == spread.median);
  return spread.median;
}

// The mean over the bins of the analysis.
double spread_percent(const std::vector<Curve>& curves, double from, double to) {
  return mean(spreads_percent(curves, from, to, AnalysisOptions{}.bins));
}
double worst_spread_percent(const std::vector<Curve>& curves, double from, double to) {
  return most(spreads_percent(curves, from, to, AnalysisOptions{}.bins));
}

Curve power(double factor, double exponent, int points = 200) {
  Curve curve;
  for (int i = 0; i < points; ++i) {
    curve.x.push_back(6 * std::pow(0.01, double(i) / points));
    curve.y.push_back(factor * std::pow(curve.x.back(), exponent));
  }
  return curve;
}

}  // namespace

TEST_CASE("the slope of a power law is its exponent") {
  CHECK(log_slope(power(3, -0.7)) == doctest::Approx(-0.7).epsilon(1e-12));
}

TEST_CASE("curves a factor apart have the spread of that factor, equal ones none") {
  CHECK(spread_percent({power(1, -1), power(1, -1)}, 0.1, 6) == 0);
  // Bins hold the same points of both: (1.2 - 1) / 1.1 in each.
  CHECK(spread_percent({power(1, -1), power(1.2, -1)}, 0.1, 6) ==
        doctest::Approx(100 * 0.2 / 1.1).epsilon(1e-12));
  CHECK(spread_percent({power(1, 0), power(2, 0), power(4, 0)}, 0.1, 6) ==
        doctest::Approx(100 * 3 / (7 / 3.0)));
  CHECK(std::isnan(spread_percent({power(1, -1), power(1, -1)}, 10, 20)));
  CHECK(std::isnan(worst_spread_percent({power(1, -1), power(1, -1)}, 10, 20)));
  // A factor of 1.2 in one of the bins alone.
  Curve one = power(1, 0), other = one;
  for (std::size_t i = 0; i < one.x.size(); ++i)
    if (one.x[i] < 0.1 * std::pow(60, 1 / 12.0)) other.y[i] *= 1.2;
  CHECK(worst_spread_percent({one, other}, 0.1, 6) == doctest::Approx(100 * 0.2 / 1.1));
  CHECK(spread_percent({one, other}, 0.1, 6) == doctest::Approx(100 * 0.2 / 1.1 / 12));
}

TEST_CASE("the spread is averaged over twelve bins, equal in the logarithm") {
  // 1 and the root of x, each at points dense in ln x: the root's mean from l to h is 2 (sqrt h - sqrt l) /
  // ln(h/l).
  const double from = 0.1, to = 6, width = std::log(to / from) / 12;
  double sum = 0;
  for (int bin = 0; bin < 12; ++bin) {
    const double l = from * std::exp(width * bin), h = l * std::exp(width);
    const double mean = 2 * (std::sqrt(h) - std::sqrt(l)) / width;
    sum += std::abs(mean - 1) / ((mean + 1) / 2);
  }
  // The points at a bin's ends, one in several thousand, count for either.
  CHECK(spread_percent({power(1, 0, 60000), power(1, 0.5, 60000)}, from, to) ==
        doctest::Approx(100 * sum / 12).epsilon(1e-4));
}

TEST_CASE("measures have names of their own, in order, each with its meaning") {
  for (std::size_t i = 0; i < measures().size(); ++i) {
    CHECK(!measures()[i].meaning.empty());
    CHECK(measures()[i].scenes.least <= measures()[i].scenes.most);
    if (i > 0) CHECK(measures()[i - 1].name < measures()[i].name);
  }
  CHECK_THROWS_AS(measure(no_runs, {"no_such_measure", {}, {}}), std::invalid_argument);
}

TEST_CASE("measures of closed forms are those of theory") {
  CHECK(value("single_impact_fold", {{"restitution", 0.4}}) == fold_amplitude(0.4));
  CHECK(value("single_impact_peak_loss", {{"mass_ratio", 0.02}, {"restitution", 0.6}}) ==
        0.02 * peak_loss(0.6));
  CHECK(value("single_impact_peak_product", {{"restitution", 0.8}}) == peak_product_amplitude(0.8));
  CHECK(value("bounce_down_closed_form", {{"restitution", 0.6}}) == bounce_down_end(0.6));
  CHECK(std::isnan(measure(no_runs, {"bounce_down_closed_form", {}, {{"restitution", 1}}}).median));
}

TEST_CASE("a wall delivers the closed form's restitution, to a moving primary mass too") {
  for (double e : {0.3, 0.6, 0.9})
    for (double nu : {1e-9, 0.02, 0.5}) {
      // zeta_m is of a fixed wall. The primary mass's own spring takes part to the order of 1/k.
      const double z = zeta_m_closed_form(e) * std::sqrt(1 + nu);
      const double delivered = std::exp(-std::numbers::pi * z / std::sqrt((1 - z) * (1 + z)));
      CHECK(value("wall_restitution", {{"mass_ratio", nu}, {"restitution", e}}) ==
            doctest::Approx(delivered).epsilon(2 * nu * 1e-4 + 1e-8));
    }
}

TEST_CASE("the iterative damping ratio errs by what the closed form says of it") {
  using std::numbers::pi;
  for (const double e : {0.3, 0.6, 0.8}) {
    const double zeta = zeta_m_iterative(e).zeta_m, decrement = -std::log(e);
    const double delivered = std::exp(-pi * zeta / std::sqrt((1 - zeta) * (1 + zeta)));
    // Errors of about 1e-9, in which a hundred steps leave roundings of 1e-14.
    CHECK(value("zeta_error", {{"restitution", e}}) ==
          doctest::Approx(std::abs(delivered - e)).epsilon(1e-4).scale(0));
    CHECK(value("zeta_difference", {{"restitution", e}}) ==
          doctest::Approx(std::abs(zeta - decrement / std::hypot(pi, decrement))).epsilon(1e-4).scale(0));
    CHECK(value("zeta_error", {{"restitution", e}}) < 1e-8);
    CHECK(value("zeta_steps", {{"restitution", e}}) == 100);
  }
}

TEST_CASE("a contact lasts half a period of two free masses on the wall's spring and damper") {
  for (const double nu : {0.02, 0.5}) {
    const double decrement = -std::log(0.6), zeta = decrement / std::hypot(std::numbers::pi, decrement);
    // The primary mass's own spring takes part to the order of nu/k.
    CHECK(value("contact_frequency", {{"mass_ratio", nu}, {"restitution", 0.6}}) ==
          doctest::Approx(std::sqrt((1 + nu) / nu * (1 - zeta * zeta * (1 + nu)))).epsilon(nu * 1e-4));
  }
}

TEST_CASE("the limits and the slips are what theory says they are") {
  using std::numbers::pi;
  CHECK(value("step_limit", {}) == doctest::Approx(2).epsilon(1e-6));
  CHECK(value("viscous_loss", {{"damping_ratio", 0.004}}) ==
        doctest::Approx(1 + 89 / 30.0 * std::pow(pi * 0.004, 2)).epsilon(1e-6));
  CHECK(value("viscous_loss_per_cycle", {{"damping_ratio", 0.001}}) ==
        doctest::Approx(2 * std::sinh(pi * 0.001) / 0.001).epsilon(1e-5));
  CHECK(value("energy_drift_percent", {{"x0", 6}, {"until_time", 0.5}}) < 1e-12);
  // v = -6 sin(t), y' = -v: the paper's energy has nu (v^2 + v^2)/2 where there is none.
  const double v = 6 * std::sin(0.5);
  CHECK(value("paper_energy_drift_percent", {{"x0", 6}, {"until_time", 0.5}}) ==
        doctest::Approx(100 * 0.02 * v * v / 18).epsilon(1e-9));
  CHECK(value("impact_energy_without_wall_percent", {{"mass_ratio", 0.25}}) ==
        doctest::Approx(80).epsilon(1e-3));
  CHECK(std::abs(value("impact_energy_with_wall_percent", {{"mass_ratio", 0.25}})) < 1e-10);
  CHECK(value("stuck_forcing", {{"mass_ratio", 0.25}}) == doctest::Approx(0.8).epsilon(1e-5));
  for (const double nu : {0.25, 0.5, 2.0})
    CHECK(value("stuck_damping", {{"mass_ratio", nu}, {"damping_ratio", 0.1}}) ==
          doctest::Approx(1 / std::sqrt(1 + nu)).epsilon(1e-5));
}

TEST_CASE("a mass that sticks moves by what the wall gives way under it") {
  // Stuck, nu x'' is the wall's force k q, and x'' = (f - x)/(1 + nu): the way of q during each lasting
  // contact beside that of a free mass, x - x(0) - v(0) t. The wall's damper adds 2/omega_m, omega_m = 2000,
  // in proportion.
  const Scene scene{.force_amplitude = 2,
                    .force_frequency = 0.4,
                    .until_time = 20,
                    .dampers = {{.mass_ratio = 0.25, .restitution = 0, .wall_stiffness = 1e6}}};
  const Record record{.contacts = true, .history = {{0, 20, 20001}}};
  const Run run = simulate(scene, Exact{}, record);
  const History& h = *run.history;
  double gives = 0, flies = 0;
  for (std::size_t c = 0; c < run.contacts->begin.size(); ++c) {
    const auto overlap = [&](std::size_t i) {
      const double force = scene.force_amplitude * std::sin(scene.force_frequency * h.time[i]);
      return scene.damper().mass_ratio * (force - h.x[i]) / (1 + scene.damper().mass_ratio) /
             scene.damper().wall_stiffness;
    };
    std::size_t begin = 0;
    for (std::size_t i = 1; i + 1 < h.time.size(); ++i) {
      if (h.time[i - 1] <= run.contacts->begin[c] + 0.2 || h.time[i + 1] >= run.contacts->end[c]) continue;
      if (begin == 0) begin = i;
      gives = std::max(gives, std::abs(overlap(i) - overlap(begin)));
      flies = std::max(flies, std::abs(h.x[i] - h.x[begin] - h.v[begin] * (h.time[i] - h.time[begin])));
    }
  }
  REQUIRE(flies > 1);
  CHECK(value("stuck_drift", {{"mass_ratio", 0.25}}) ==
        doctest::Approx(gives / flies).epsilon(3e-3).scale(0));
}

namespace {

// A folder with the run of a short decay, "short", and the other members of an ensemble of three.
struct ShortEnsemble {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("impact-damper-measures-test-" + std::to_string(::getpid()));
  Record record;
  Run first;

  ShortEnsemble() {
    const Scene scene{.until_amplitude = 5.5};
    record.contacts = true;
    first = simulate(scene, Exact{}, record);
    const std::vector<Scene> scenes = ensemble_of(scene, {.members = 3});
    write(run_file(), first);
    std::filesystem::create_directories(member_file(run_file(), 2).parent_path());
    for (int member = 2; member <= 3; ++member)
      write(member_file(run_file(), member), simulate(scenes[std::size_t(member) - 1], Exact{}, record));
  }
  ~ShortEnsemble() { std::filesystem::remove_all(folder); }
  ShortEnsemble(const ShortEnsemble&) = delete;
  ShortEnsemble& operator=(const ShortEnsemble&) = delete;

  std::filesystem::path run_file() const { return folder / "short.json"; }
  void write(const std::filesystem::path& file, const Run& run) const {
    std::filesystem::create_directories(file.parent_path());
    write_file(file, run_text(run));
  }
  // What reading the ensemble throws.
  template <class Error>
  std::string complaint(const EnsembleOptions& options = {.members = 3}) const {
    return rejection_of<Error>([&] { Runs(folder, options).ensemble("short"); });
  }
};

}  // namespace

TEST_CASE("an ensemble is the run file and the files of the same scene released otherwise") {
  const ShortEnsemble files;
  CHECK(member_file(files.run_file(), 2) == files.folder / "short.members/02.json");
  CHECK(member_file("a.b/some.csv", 100) == "a.b/some.csv.members/100.json");
  Runs runs(files.folder, {.members = 3});
  CHECK(runs.file("short").scene == files.first.scene);
  const std::vector<Run>& members = runs.ensemble("short");
  REQUIRE(members.size() == 3);
  CHECK(members[0].scene == files.first.scene);
  for (std::size_t member = 1; member < 3; ++member) {
    CHECK(members[member].scene == ensemble_of(files.first.scene)[member]);
    CHECK(run_text(members[member]) ==
          run_text(simulate(members[member].scene, files.first.engine, files.record)));
  }
  // A measure that needs what the file does not hold says so instead of guessing.
  CHECK_THROWS_AS(measure(runs, {"wall_overlap", {"short"}, {}}), std::invalid_argument);
  CHECK(measure(runs, {"stuck_share", {"short"}, {{"from", 5.5}, {"to", 5.9}}}).low == 1);
  // As many as are asked for; nothing of an ensemble is needed for one.
  CHECK(Runs(files.folder, {.members = 2}).ensemble("short").size() == 2);
  std::filesystem::remove_all(member_file(files.run_file(), 2).parent_path());
  CHECK(Runs(files.folder, {.members = 1}).ensemble("short").size() == 1);
}

TEST_CASE("without a folder an ensemble is simulated") {
  const ShortEnsemble files;
  Runs runs(std::nullopt, {.members = 3});
  CHECK_THROWS_WITH_AS(runs.file("short"), "there is no run of scene short", std::invalid_argument);
  runs.put("short", files.first);
  const std::vector<Run>& simulated = runs.ensemble("short");
  REQUIRE(simulated.size() == 3);
  Runs read(files.folder, {.members = 3});
  for (std::size_t member = 0; member < 3; ++member)
    CHECK(simulated[member].half_cycles->amplitude == read.ensemble("short")[member].half_cycles->amplitude);
}

TEST_CASE("a further run is read from its files, and without a folder simulated from its scene's run") {
  const ShortEnsemble files;
  const CatalogueRun rigid{"short.rigid", "short", {{"x0", 6.5}}, Restitution{}, Record{}};
  const CatalogueRun stiff{
      "short.stiff", "short", {{"wall_stiffness", 1e5}, {"until_amplitude", 5.7}}, {}, Record{}};
  Scene changed = files.first.scene;
  changed.x0 = 6.5;
  const std::vector<Scene> scenes = ensemble_of(changed, {.members = 3});
  const std::filesystem::path file = files.folder / "short.rigid.json";
  for (int member = 1; member <= 3; ++member)
    files.write(member == 1 ? file : member_file(file, member),
                simulate(scenes[std::size_t(member) - 1], Restitution{}, Record{}));
  Runs read(files.folder, {.members = 3}, {rigid}), simulated(std::nullopt, {.members = 3}, {rigid, stiff});
  simulated.put("short", files.first);
  REQUIRE(read.ensemble("short.rigid").size() == 3);
  REQUIRE(simulated.ensemble("short.rigid").size() == 3);
  for (std::size_t member = 0; member < 3; ++member) {
    const Run &one = read.ensemble("short.rigid")[member], &other = simulated.ensemble("short.rigid")[member];
    CHECK(one.scene == scenes[member]);
    CHECK(other.scene == scenes[member]);
    CHECK(std::holds_alternative<Restitution>(other.engine));
    CHECK(one.half_cycles->amplitude == other.half_cycles->amplitude);
  }
  CHECK(simulated.file("short.stiff").scene.damper().wall_stiffness == 1e5);
  CHECK(simulated.file("short.stiff").scene.until_amplitude == 5.7);
  CHECK(simulated.file("short.stiff").engine == files.first.engine);
  // Further runs are no part of whose verdicts these are.
  read.file("short");
  CHECK(read.engine() == "exact");
  CHECK(simulated.engine() == "exact");

  // Times are saved of the median.
  std::vector<double> saved, theirs;
  for (const Run& run : read.ensemble("short.rigid")) theirs.push_back(run.half_cycles->peak_time.back());
  for (const Run& run : read.ensemble("short"))
    saved.push_back(100 * (1 - run.half_cycles->peak_time.back() / spread_of(theirs).median));
  const Spread found = measure(read, {"time_saved_percent", {"short", "short.rigid"}, {{"amplitude", 5.5}}});
  CHECK(found.median == spread_of(saved).median);
  CHECK(found.low == spread_of(saved).low);
  CHECK(found.high == spread_of(saved).high);

  // Of another scene there is another further run.
  Run other = files.first;
  other.scene.damper().restitution = 0.7;
  simulated.put("short", other);
  CHECK(simulated.file("short.rigid").scene.damper().restitution == 0.7);
  CHECK(simulated.file("short.rigid").scene.x0 == 6.5);
}

TEST_CASE("a further run that is missing, or of another scene or engine than the catalogue's, is rejected") {
  const ShortEnsemble files;
  const SceneRuns folders{files.folder, files.folder / "scenes"};
  std::filesystem::create_directories(folders.scenes);
  write_file(folders.scenes / "short.json", scene_text(files.first.scene));
  CatalogueRun wanted{"short.later", "short", {{"x0", 6.5}}, Restitution{}, Record{}};
  const std::filesystem::path file = folders.file_of(wanted.name);
  const auto complaint = [&] { return rejection_of([&] { folders.read(wanted); }); };
  CHECK(contains(complaint(), "made by: impact-damper run --scene " +
                                  (folders.scenes / "short.json").string() + " -o " + file.string()));
  const auto becomes = [&](const Scene& scene, const Engine& engine) {
    files.write(file, simulate(scene, engine, Record{}));
    return complaint();
  };
  Scene changed = files.first.scene;
  CHECK(contains(becomes(changed, Restitution{}),
                 "/scene/x0: must be 6.5 as in run short.later of the catalogue, got 6"));
  changed.x0 = 6.5;
  CHECK(becomes(changed, Restitution{}) == not_rejected);
  CHECK(contains(becomes(changed, Restitution{.accumulation_tolerance = 1e-6}),
                 "/engine: must be that of run short.later of the catalogue, restitution, with its options"));
  wanted.engine.reset();
  CHECK(contains(complaint(), "/engine: must be that of " + folders.file_of("short").string() +
                                  ", exact, with its options, got restitution"));
  CHECK(becomes(changed, Exact{}) == not_rejected);
}

TEST_CASE("a member that is missing, of another release or engine, or contradicts itself is rejected") {
  const ShortEnsemble files;
  const std::filesystem::path third = member_file(files.run_file(), 3);
  const Run member = read_run(third);
  CHECK(files.complaint<std::exception>() == not_rejected);
  CHECK(files.complaint<IoError>({.members = 4}) ==
        member_file(files.run_file(), 4).string() +
            ": cannot be read: No such file or directory; made by: impact-damper run --members 4 -o " +
            files.run_file().string() + ", with the other options that made that run");

  files.write(third, read_run(member_file(files.run_file(), 2)));
  CHECK(files.complaint<InputError>().starts_with(third.string() + ": /scene/x0: must be "));
  CHECK(contains(files.complaint<InputError>(),
                 " as in member 3 of the ensemble of " + files.run_file().string()));
  CHECK(files.complaint<std::exception>({.members = 2}) == not_rejected);

  files.write(third, simulate(member.scene, Exact{.calibration = Calibration::two_body}, files.record));
  CHECK(files.complaint<InputError>().starts_with(third.string() + ": /engine: must be that of "));

  Run wrong = member;
  wrong.half_cycles->amplitude[0] *= 1.5;
  files.write(third, wrong);
  CHECK(files.complaint<InputError>().starts_with(third.string() +
                                                  ": /half_cycles/amplitude/0: contradicts the rest"));

  files.write(third, member);
  CHECK(files.complaint<std::exception>() == not_rejected);
}

TEST_CASE("members record all that is asked for but the history and the energy balance") {
  const Record record{.half_cycles = false,
                      .impacts = true,
                      .contacts = true,
                      .energy = true,
                      .history = {{0, 1, 2}},
                      .history_below = {{1, 1, 2}}};
  const Record kept = record_of_member(record);
  CHECK(kept.impacts);
  CHECK(kept.contacts);
  CHECK(!kept.half_cycles);
  CHECK(!kept.energy);
  CHECK(kept.history.empty());
  CHECK(kept.history_below.empty());
}
