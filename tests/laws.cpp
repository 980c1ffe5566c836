// Walls and springs with laws of their own (docs/mathematics.md, 18.6): against Boost.odeint, whose laws are
// written down anew here, and closed forms.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/engines/cem.hpp"
#include "impact_damper/engines/recorded.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/motion/force_law.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"
#include "impact_damper/steady/steady_state.hpp"
#include "reference.hpp"
#include "rejection.hpp"
#include "same_run.hpp"

using namespace impact_damper;
using reference::everything, reference::order;

namespace {

namespace odeint = boost::numeric::odeint;
using Numbers = std::vector<double>;

double interpolated(const Pairs& pairs, double at) {
  std::size_t i = 0;
  while (i + 2 < pairs.size() && at > pairs[i + 1][0]) ++i;
  const auto [x0, f0] = pairs[i];
  const auto [x1, f1] = pairs[i + 1];
  return f0 + (f1 - f0) * ((at - x0) / (x1 - x0));
}
// The force of a wall for an overlap > 0, and of the primary spring.
double wall_force(const SceneDamper& damper, double overlap) {
  return damper.wall.law == WallForm::table ? interpolated(damper.wall.pairs, overlap)
                                            : damper.wall_stiffness * std::pow(overlap, damper.wall.exponent);
}
double spring_force(const SpringLaw& spring, double x) {
  if (spring.law == SpringForm::cubic) return x + spring.cubic * std::pow(x, 3);
  if (spring.pairs.front()[0] < 0) return interpolated(spring.pairs, x);
  return std::copysign(interpolated(spring.pairs, std::abs(x)), x);
}
// chi v by bisection of ln((1 + u) / (1 - e u)) = (1 + e) u.
double loss_by_logarithms(double e) {
  double low = (1 - e) / e, high = 1 / e;
  for (int i = 0; i < 200; ++i) {
    const double u = (low + high) / 2;
    (std::log1p(u) - std::log1p(-e * u) < (1 + e) * u ? low : high) = u;
  }
  return low;
}

// The motion of a scene whose walls all have laws, without friction: x, x', and y and y' of each mass.
class Reference {
 public:
  explicit Reference(const Scene& scene) : scene_(scene), at_wall_(scene.dampers.size(), 0) {
    for (const SceneDamper& each : scene.dampers)
      chi_.push_back(loss_by_logarithms(each.restitution) / each.wall.speed.value_or(1));
  }

  void operator()(const Numbers& u, Numbers& du, double t) const {
    double primary = scene_.force_amplitude * std::sin(scene_.force_frequency * t) -
                     2 * scene_.damping_ratio * u[1] - spring_force(scene_.spring, u[0]);
    for (std::size_t i = 0; i < at_wall_.size(); ++i) {
      const SceneDamper& damper = scene_.dampers[i];
      const double y = u[2 + 2 * i], w = u[3 + 2 * i];
      double force = damper.drag * w;
      if (at_wall_[i] != 0) {
        const double overlap = at_wall_[i] < 0 ? -y : y - damper.clearance, rate = at_wall_[i] * w;
        if (overlap > 0)
          force += at_wall_[i] * wall_force(damper, overlap) / damper.mass_ratio * (1 + chi_[i] * rate);
      }
      primary += damper.mass_ratio * force;
      du[2 + 2 * i] = w;
      du[3 + 2 * i] = -force - scene_.weight;
    }
    du[0] = u[1];
    du[1] = primary;
    for (std::size_t i = 0; i < at_wall_.size(); ++i) du[3 + 2 * i] -= primary;
  }

  // Returns the state at a time, found in steps that end where a mass meets or leaves a wall.
  Numbers at(double until) {
    Numbers u{scene_.x0, scene_.v0};
    for (const SceneDamper& each : scene_.dampers) u.insert(u.end(), {each.y0, each.w0});
    odeint::runge_kutta_fehlberg78<Numbers> method;
    double t = 0;
    const double longest = 5e-4;  // an error of 1e-20 in each step
    while (t < until) {
      const double step = std::min(longest, until - t);
      Numbers next = u;
      method.do_step(*this, next, t, step);
      double part = step;
      const std::vector<int> changed = changes(next);
      if (changed != at_wall_) {
        double low = 0, high = step;
        for (int i = 0; i < 60; ++i) {
          part = (low + high) / 2;
          next = u;
          method.do_step(*this, next, t, part);
          (changes(next) == at_wall_ ? low : high) = part;
        }
        part = high;
        next = u;
        method.do_step(*this, next, t, part);
        at_wall_ = changes(next);
        ++meetings;
      }
      u = next;
      t += part;
    }
    return u;
  }
  int meetings = 0;

 private:
  // At which wall each mass is in the state u: -1 left, 1 right.
  std::vector<int> changes(const Numbers& u) const {
    std::vector<int> at;
    for (std::size_t i = 0; i < at_wall_.size(); ++i)
      at.push_back(int(u[2 + 2 * i] > scene_.dampers[i].clearance) - int(u[2 + 2 * i] < 0));
    return at;
  }

  const Scene& scene_;
  std::vector<int> at_wall_;
  Numbers chi_;
};

Numbers state_at_end(const Scene& scene, const Cem& options) {
  const double time = *scene.until_time;
  const Run run = simulate(scene, options, {.half_cycles = false, .history = {{time / 2, time, 2}}});
  Numbers u{run.history->x[1], run.history->v[1]};
  for (const History::Damper& each : run.history->dampers) u.insert(u.end(), {each.y[1], each.w[1]});
  return u;
}

// Like a measured one: soft, then hard.
const Pairs rubber{{0, 0}, {0.05, 0.3}, {0.1, 1.1}, {0.2, 4}, {0.3, 12}};

Scene random_scene(std::uint64_t seed) {
  reference::Random random(seed);
  Scene scene;
  scene.damping_ratio = random.uniform(0, 0.05);
  scene.x0 = random.uniform(0.5, 3);
  scene.force_amplitude = random.chance(0.5) ? random.uniform(0.1, 0.5) : 0;
  scene.force_frequency = random.uniform(0.7, 1.3);
  scene.weight = random.chance(0.5) ? random.uniform(0, 0.3) : 0;
  if (random.chance(0.5)) {
    scene.spring.cubic = random.uniform(0.02, 0.3);
  } else {
    scene.spring = {.law = SpringForm::table, .pairs = {{-2, -3}, {-0.5, -0.4}, {0, 0}, {1, 1.2}, {2, 4}}};
    if (random.chance(0.5))
      scene.spring.pairs.erase(scene.spring.pairs.begin(), scene.spring.pairs.begin() + 2);
  }
  scene.until_time = 3;
  scene.dampers.resize(random.chance(0.5) ? 1 : 2);
  for (SceneDamper& damper : scene.dampers) {
    damper.mass_ratio = random.uniform(0.02, 0.1);
    damper.restitution = random.uniform(0.3, 0.95);
    damper.clearance = random.chance(0.5) ? 1 : random.uniform(0.5, 1);
    damper.wall_stiffness = random.uniform(10, 50);
    damper.y0 = damper.clearance * random.uniform(0.1, 0.9);
    damper.w0 = random.uniform(-1, 1);
    damper.drag = random.chance(0.5) ? random.uniform(0, 0.2) : 0;
    damper.wall = {.law = WallForm::power, .exponent = random.uniform(1, 3)};
    if (random.chance(0.3)) damper.wall = {.law = WallForm::table, .pairs = rubber};
    if (random.chance(0.5)) damper.wall.speed = random.uniform(0.5, 2);
  }
  return scene;
}

}  // namespace

TEST_CASE(
    "laws: chi lets a mass at the stated speed leave a wall that stands still with e, whatever the law") {
  for (const double e : {0.001, 0.05, 0.3, 0.6, 0.9, 0.999, 1.0}) {
    CAPTURE(e);
    if (e >= 0.05 && e < 1)
      CHECK(loss_at_unit_speed(e) == doctest::Approx(loss_by_logarithms(e)).epsilon(1e-9));
    for (const double speed : {1.0, 2.5})
      for (const double exponent : {1.0, 1.5, 4.0, 0.0}) {
        SceneDamper damper{.restitution = e, .wall_stiffness = 30};
        damper.wall = {.law = WallForm::power, .exponent = exponent, .speed = speed};
        if (exponent == 0) damper.wall = {.law = WallForm::table, .pairs = rubber, .speed = speed};
        const double chi = loss_factor_of(damper);
        // q'' = -(1 + chi q') P / nu
        const auto motion = [&](const std::array<double, 2>& u, std::array<double, 2>& du, double) {
          du = {u[1], -(1 + chi * u[1]) * wall_force(damper, std::max(u[0], 0.0)) / damper.mass_ratio};
        };
        odeint::runge_kutta_fehlberg78<std::array<double, 2>> method;
        const auto speed_after = [&](double before) {
          std::array<double, 2> u{0, before};
          for (double step = 1e-5; u[0] > 0 || u[1] > 0;) {
            std::array<double, 2> next = u;
            method.do_step(motion, next, 0.0, step);
            if (next[0] < 0 && step > 1e-16)
              step /= 2;
            else
              u = next;
          }
          return -u[1];
        };
        if (e < 0.05) continue;  // slower and slower out of the wall
        CHECK(speed_after(speed) == doctest::Approx(e * speed).epsilon(1e-8));
        if (e < 1) CHECK(speed_after(2 * speed) < 1.999 * e * speed);
      }
  }
  CHECK(loss_at_unit_speed(1) == 0);
  CHECK(loss_at_unit_speed(1e-3) == doctest::Approx(1000));
}

TEST_CASE("laws: the component element method meets Boost.odeint with second order, located or not") {
  int meetings = 0, scenes = 0;
  std::array<double, 2> sum_of_orders{};
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    CAPTURE(seed);
    const Scene scene = random_scene(seed);
    Reference motion(scene);
    const Numbers expected = motion.at(*scene.until_time);
    meetings += motion.meetings;
    ++scenes;
    for (const bool locate : {false, true}) {
      CAPTURE(locate);
      std::array<double, 2> error{};
      for (int i = 0; i < 2; ++i)
        error[i] = reference::farthest(
            state_at_end(scene, {.time_step = i == 0 ? 4e-4 : 1e-4, .locate = locate}), expected);
      CHECK(error[1] < 1e-4);
      sum_of_orders[locate] += order(error[0], error[1], 4);
    }
  }
  CHECK(meetings > 4 * scenes);
  for (const double sum : sum_of_orders) CHECK(sum / scenes == doctest::Approx(2).epsilon(0.05));
}

TEST_CASE("laws: the damper of a wall may lag") {
  // Of first order, as with linear walls.
  Scene scene{.x0 = 2, .until_time = 3, .dampers = {{.mass_ratio = 0.1, .wall_stiffness = 30, .y0 = 0.4}}};
  scene.damper().wall = {.law = WallForm::power, .exponent = 1.5};
  const Numbers expected = Reference(scene).at(3);
  std::array<double, 2> error{};
  for (int i = 0; i < 2; ++i)
    error[i] = reference::farthest(
        state_at_end(scene, {.time_step = 1e-3 / (1 << i), .damper = Damper::lagged, .locate = true}),
        expected);
  CHECK(order(error[0], error[1]) == doctest::Approx(1).epsilon(0.1));
}

TEST_CASE("laws: the energy balance closes with the square of the step") {
  int falling = 0;
  constexpr int scenes = 20;
  for (int n = 0; n < scenes; ++n) {
    CAPTURE(n);
    Scene scene = random_scene(100 + n);
    if (n % 2 == 0) scene.damper().friction = 0.1;
    std::array<double, 2> residual{};
    for (int i = 0; i < 2; ++i) {
      const Run run = simulate(scene, Cem{.time_step = 4e-4 / (1 << (2 * i)), .locate = true},
                               {.impacts = true, .energy = true});
      residual[i] = std::abs(run.energy->residual);
      const EnergyBalance& energy = *run.energy;
      CHECK(energy.initial.spring == doctest::Approx(ForceLaw::of_spring(scene.spring).energy(scene.x0)));
      for (const double loss : energy.impact_loss) CHECK(loss >= 0);
    }
    CHECK(residual[0] < 1e-4);
    falling += residual[1] < residual[0] / 4;
  }
  CHECK(falling >= scenes * 3 / 4);
}

TEST_CASE("laws: a mass that presses its wall holds the energy that the law's integral says") {
  Scene scene{.x0 = 0, .until_time = 1, .dampers = {{.wall_stiffness = 40, .y0 = -0.2}}};
  const auto energy = [&] { return simulate(scene, Cem{}, {.energy = true}).energy->initial.wall; };
  scene.damper().wall = {.law = WallForm::power, .exponent = 1.5};
  CHECK(energy() == doctest::Approx(40 * std::pow(0.2, 2.5) / 2.5));
  scene.damper().y0 = 1.25;
  scene.damper().wall = {.law = WallForm::table, .pairs = rubber};
  // Trapezoids to 0.2, and half a piece from there.
  CHECK(energy() == doctest::Approx(0.0075 + 0.035 + 0.255 + (4 + 8) / 2.0 * 0.05));
}

TEST_CASE("laws: the step is limited by the steepest slope that a free motion meets") {
  Scene scene{.x0 = 2, .until_time = 20, .dampers = {{.mass_ratio = 0.1, .wall_stiffness = 100, .y0 = 0.5}}};
  scene.damper().restitution = 0.9;
  scene.damper().wall = {.law = WallForm::power, .exponent = 2};
  // All the energy in the wall: k q^3 / 3 = 2.
  const double overlap = std::cbrt(3 * 2.0 / 100), slope = 2 * 100 * overlap;
  const double omega_2 = slope * 11, limit = stability_limit(scene, Damper::centred, {});
  CHECK(limit == doctest::Approx(2 / std::sqrt(omega_2)).epsilon(1e-3));  // the primary spring takes part
  CHECK_NOTHROW(simulate(scene, Cem{.time_step = 0.999 * limit}, {}));
  CHECK(
      contains(rejection_of<InvalidArguments>([&] { simulate(scene, Cem{.time_step = 1.001 * limit}, {}); }),
               "time_step: must be <= "));
  // Of a table the steepest piece that can be reached.
  scene.damper().wall = {.law = WallForm::table, .pairs = {{0, 0}, {0.1, 10}, {100, 1e6}}};
  CHECK(stability_limit(scene, Damper::centred, {}) ==
        doctest::Approx(2 / std::sqrt((1e6 - 10) / 99.9 * 11)).epsilon(1e-3));
  scene.damper().wall.pairs = {{0, 0}, {100, 1e4}, {101, 1e9}};
  CHECK(stability_limit(scene, Damper::centred, {}) ==
        doctest::Approx(2 / std::sqrt(100 * 11)).epsilon(1e-2));
  scene.spring.cubic = 0.5;
  scene.x0 = 20;
  scene.damper().wall.pairs = {{0, 0}, {100, 1e2}};
  CHECK(stability_limit(scene, Damper::centred, {}) == doctest::Approx(2 / std::sqrt(602)).epsilon(0.01));
}

TEST_CASE("laws: a force that drives a motion beyond the step's limit ends the run with an error") {
  Scene scene{.x0 = 0, .force_amplitude = 5, .until_time = 200};
  scene.damper() = {.mass_ratio = 0.1, .restitution = 0.9, .wall_stiffness = 100, .y0 = 0.5};
  scene.damper().wall = {.law = WallForm::power, .exponent = 4};
  const double limit = stability_limit(scene, Damper::centred, {});
  CHECK(contains(rejection_of<NumericalError>([&] { simulate(scene, Cem{.time_step = limit}, {}); }),
                 "rises so steeply that time_step "));
  CHECK_NOTHROW(simulate(scene, Cem{.time_step = limit / 100}, {}));
}

TEST_CASE("laws: another order of dampers whose laws alone differ changes no bit") {
  Scene scene = random_scene(3);
  scene.dampers.resize(1);
  scene.dampers.push_back(scene.damper());
  scene.dampers[1].wall = {.law = WallForm::power, .exponent = 1.7};
  Scene turned = scene;
  std::swap(turned.dampers[0], turned.dampers[1]);
  const Record record{.half_cycles = false, .history = {{0, 3, 40}}};
  const Run run = simulate(scene, Cem{}, record), other = simulate(turned, Cem{}, record);
  CHECK(run.history->x == other.history->x);
  CHECK(run.history->dampers[0].y == other.history->dampers[1].y);
  CHECK(run.history->dampers[0].y != run.history->dampers[1].y);
}

TEST_CASE("laws: files hold them, dimensionless and in units, and a run has the numbers of a table's file") {
  for (const char* const text :
       {R"({"wall": {"law": "power", "exponent": 1.5}, "spring": {"cubic": 0.1}, "until_time": 1})",
        R"({"restitution": [[0, 0.8], [2, 0.5]], "until_time": 1})",
        R"({"spring": {"law": "table", "pairs": [[-1, -2], [0, 0], [1, 1.5]]}, "dampers": [{},
            {"wall": {"law": "table", "pairs": [[0, 0], [0.1, 5]], "speed": 2}}], "until_time": 1})"}) {
    const Scene scene = parse_scene("s.json", text);
    CHECK(has_laws(scene));
    CHECK(parse_scene("s.json", scene_text(scene)) == scene);
  }
  CHECK(!contains(scene_text({.until_time = 1}), "wall\""));

  const SceneFile in_units = parse_scene_file(
      "s.json", R"({"mass": 40, "stiffness": 1e6, "until_seconds": 1, "spring": {"cubic": 10}, "dampers": [
                  {"secondary_mass": 1, "clearance": 2, "restitution": [[100, 0.5], [200, 0.25]]},
                  {"secondary_mass": 2, "clearance": 3, "contact_stiffness": 1e7,
                   "wall": {"law": "table", "pairs": [[0, 0], [0.1, 500]], "speed": 300}}]})");
  const double velocity = 2 * std::sqrt(1e6 / 40);  // mm/s; the unit of force is 2000 N
  CHECK(in_units.scene.spring.cubic == doctest::Approx(10 * 8 / 2000.0));
  const auto& [first, second] = std::array{in_units.scene.dampers[0], in_units.scene.dampers[1]};
  CHECK(first.restitution_by_speed[0][0] == doctest::Approx(100 / velocity));
  CHECK(first.restitution_by_speed[1] == std::array{first.restitution_by_speed[0][0] * 2, 0.25});
  CHECK(second.wall.pairs[1][0] == doctest::Approx(0.05));
  CHECK(second.wall.pairs[1][1] == doctest::Approx(0.25));
  CHECK(*second.wall.speed == doctest::Approx(300 / velocity));

  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("impact-damper-laws-test-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, const char* text) { std::ofstream(folder / name) << text; };
  write("s.json", R"({"wall": {"law": "table", "file": "wall.csv"}, "until_time": 1})");
  write("wall.csv", "overlap,force\n0,0\n0.05,0.3\n0.1,1.1\n");
  const Scene scene = read_scene(folder / "s.json");
  CHECK(scene.damper().wall.pairs == Pairs{{0, 0}, {0.05, 0.3}, {0.1, 1.1}});
  const Run run = simulate(scene, Cem{}, {});
  CHECK(parse_run("r.json", run_text(run, {})).scene == scene);
  const auto told = [&] { return rejection_of<InputError>([&] { read_scene(folder / "s.json"); }); };
  write("wall.csv", "0,0\n0.05;0.3\n");
  CHECK(contains(told(), "/wall/file: wall.csv, line 2: must be two numbers"));
  std::filesystem::remove(folder / "wall.csv");
  CHECK(contains(told(), "/wall/file: "));
  std::filesystem::remove_all(folder);
  CHECK(contains(rejection_of<InputError>([] {
                   parse_scene("s.json",
                               R"({"wall": {"law": "table", "file": "wall.csv"}, "until_time": 1})");
                 }),
                 "/wall/file: is for a scene in a file: give its pairs instead"));
}

TEST_CASE("laws: an engine without them names the one that has them") {
  Scene scene{.force_amplitude = 0.1, .until_time = 1};
  const auto told = [&](const Engine& engine) {
    return rejection_of<InvalidArguments>([&] { simulate(scene, engine, {}); });
  };
  const auto steady = [&](const Engine& engine) {
    return rejection_of<InvalidArguments>([&] { ForcedScene(scene, engine); });
  };
  scene.damper().wall = {.law = WallForm::power, .exponent = 1.5};
  scene.spring.cubic = 0.1;
  for (const Engine& engine : {Engine(Exact{}), Engine(Restitution{})}) {
    const std::string name(name_of(engine));
    for (const std::string& text : {told(engine), steady(engine)}) {
      CHECK(contains(text, "wall: must be linear with the " + name +
                               " engine: only the cem engine has walls with laws of their own"));
      CHECK(contains(text, "spring: must be linear with the " + name +
                               " engine: only the cem engine has springs with laws of their own"));
    }
  }
  Recorder recorder(Record{});
  CHECK_THROWS_AS(run_cem(checked(scene, Cem{}), recorder), InvalidArguments);
  CHECK(contains(told(Cem{.large_step = 0.01}),
                 "large_step: must be absent beside walls and springs with laws of their own"));
  scene.damper().wall = {};
  scene.spring = {};
  scene.damper().restitution_by_speed = {{0, 0.5}, {1, 0.4}};
  const std::string who = " engine: only the restitution engine has one that depends on the speed";
  CHECK(contains(told(Exact{}), "restitution: must be one number with the exact" + who));
  CHECK(contains(told(Cem{}), "restitution: must be one number with the cem" + who));
  CHECK(contains(steady(Restitution{}), "restitution: must be one number: steady motions"));
  CHECK_NOTHROW(simulate(scene, Restitution{}, {}));
}

namespace {

// A run with rigid walls, without damping, force, friction and drag, by a search for each impact in small
// steps.
Numbers bounced(const Scene& scene) {
  const SceneDamper& damper = scene.damper();
  const double nu = damper.mass_ratio, all = *scene.until_time;
  double t = 0, x = scene.x0, v = scene.v0, y = damper.y0, w = damper.w0;
  const auto x_at = [&](double s) { return x * std::cos(s) + v * std::sin(s); };
  const auto y_at = [&](double s) { return y + (v + w) * s + x - x_at(s) - scene.weight * s * s / 2; };
  for (;;) {
    const auto outside = [&](double s) { return y_at(s) < 0 || y_at(s) > damper.clearance; };
    double low = 1e-4, high = 1e-4;
    while (t + high < all && !outside(high)) low = high, high += 1e-4;
    const bool ends = !(t + high < all);
    for (int i = 0; i < 60 && !ends; ++i) (outside((low + high) / 2) ? high : low) = (low + high) / 2;
    const double s = ends ? all - t : high, next = v * std::cos(s) - x * std::sin(s);
    y = y_at(s), x = x_at(s), w += v - next - scene.weight * s, v = next, t += s;
    if (ends) return {x, v, y, w};
    double e = damper.restitution;
    if (const Pairs& pairs = damper.restitution_by_speed; !pairs.empty())
      e = interpolated(pairs, std::clamp(std::abs(w), pairs.front()[0], pairs.back()[0]));
    y = y > damper.clearance / 2 ? damper.clearance : 0;
    v += nu * (1 + e) * w / (1 + nu);
    w *= -e;
  }
}

}  // namespace

TEST_CASE("laws: impacts have the restitution of their speed, in both engines with rigid walls") {
  Scene scene{.x0 = 5, .until_time = 12, .dampers = {{.mass_ratio = 0.1, .y0 = 0.3}}};
  scene.damper().restitution_by_speed = {{0.5, 0.9}, {1, 0.7}, {2, 0.4}};
  const Numbers expected = bounced(scene);
  const Record record{.half_cycles = false, .impacts = true, .energy = true, .history = {{6, 12, 2}}};
  const Run run = simulate(scene, Restitution{}, record);
  REQUIRE(run.impacts->time.size() > 8);
  double slowest = 9, fastest = 0;
  for (const double w : run.impacts->relative_velocity)
    slowest = std::min(slowest, std::abs(w)), fastest = std::max(fastest, std::abs(w));
  CHECK(slowest < 1);
  CHECK(fastest > 2);
  const History& end = *run.history;
  CHECK(reference::farthest({end.x[1], end.v[1], end.dampers[0].y[1], end.dampers[0].w[1]}, expected) < 1e-7);
  CHECK(std::abs(run.energy->residual) < 1e-12);
  // The same scene in another unit of length is a list.
  Scene twice = scene;
  twice.x0 *= 2;
  twice.damper().clearance = 2;
  twice.damper().y0 *= 2;
  for (auto& each : twice.damper().restitution_by_speed) each[0] *= 2;
  const Run list = simulate(twice, Restitution{}, record);
  CHECK(list.history->x[1] / 2 == doctest::Approx(expected[0]).epsilon(1e-8));
  CHECK(list.history->dampers[0].w[1] / 2 == doctest::Approx(expected[3]).epsilon(1e-8));
  CHECK(std::abs(list.energy->residual) < 1e-12);
}

TEST_CASE("laws: one restitution at all speeds is a number, and chattering ends with that of slow impacts") {
  Scene scene{.x0 = 3, .until_time = 150};
  const Record record = reference::everything();
  for (const double clearance : {1.0, 0.8}) {
    CAPTURE(clearance);
    scene.damper() = {.restitution = 0.55, .clearance = clearance};
    Run run = simulate(scene, Restitution{}, record);
    REQUIRE(run.energy->bounce_downs > 0);
    Scene pairs = scene;
    pairs.damper().restitution = 0.9;
    pairs.damper().restitution_by_speed = {{1e-3, 0.55}, {2, 0.55}};
    Run same = simulate(pairs, Restitution{}, record);
    same.scene = run.scene;
    CHECK(same.half_cycles->amplitude == run.half_cycles->amplitude);
    CHECK(same.energy->bounce_down_loss == run.energy->bounce_down_loss);
    // Only slow impacts differ: more of them are followed before the limit, which is that of e(0).
    pairs.damper().restitution_by_speed = {{0, 0.45}, {1e-4, 0.55}, {2, 0.55}};
    pairs.until_time = scene.until_time = 20;
    const Run other = simulate(pairs, Restitution{}, record);
    CHECK(other.energy->bounce_downs > 0);
    CHECK(other.energy->bounce_down_loss < 1e-18);
    CHECK(reference::farthest(other.half_cycles->amplitude,
                              simulate(scene, Restitution{}, record).half_cycles->amplitude) < 1e-3);
  }
}

TEST_CASE("laws: impacts have the restitution of their speed under weight, in lists and in a fluid, too") {
  Scene scene{.x0 = 5, .weight = 0.4, .until_time = 12, .dampers = {{.mass_ratio = 0.1, .y0 = 0.3}}};
  scene.damper().restitution_by_speed = {{0.5, 0.9}, {1, 0.7}, {2, 0.4}};
  const Numbers expected = bounced(scene);
  const Record record{.half_cycles = false, .energy = true, .history = {{6, 12, 2}}};
  for (const double drag : {0.0, 1e-11}) {  // so little that it says nothing, but takes the motion of drag
    scene.damper().drag = drag;
    for (const bool list : {false, true}) {
      CAPTURE(drag);
      CAPTURE(list);
      if (list) scene.dampers = {scene.damper(), {.mass_ratio = 1e-9, .clearance = 20, .y0 = 10}};
      const Run run = simulate(scene, Restitution{}, record);
      const History& end = *run.history;
      CHECK(reference::farthest({end.x[1], end.v[1], end.dampers[0].y[1], end.dampers[0].w[1]}, expected) <
            1e-7);
      CHECK(std::abs(run.energy->residual) < 1e-12);
      scene.dampers.resize(1);
    }
  }
}

TEST_CASE("laws: a ball whose restitution depends on the speed bounces down under weight and friction") {
  const double gamma = 2, height = 0.5, nu = 1e-9;
  const Pairs to_less{{1e-8, 0.45}, {3e-8, 0.95}, {0.5, 0.9}, {2, 0.3}}, to_one{{0, 1}, {1, 0.5}};
  for (const double phi : {0.0, 0.7}) {
    for (const Pairs& pairs : {to_less, to_one}) {
      const double e_0 = pairs[0][1], out = gamma + phi, back = gamma - phi, r = std::sqrt(back / out);
      if (e_0 * r == 1) continue;
      CAPTURE(phi);
      CAPTURE(e_0);
      Scene scene{.x0 = 0, .weight = gamma, .until_time = 90, .dampers = {{.mass_ratio = nu, .y0 = height}}};
      scene.damper().friction = phi;
      scene.damper().restitution_by_speed = pairs;
      const Run run = simulate(scene, Restitution{}, everything());
      const auto e_of = [&](double w) {
        return interpolated(pairs, std::clamp(w, pairs.front()[0], pairs.back()[0]));
      };
      double time = std::sqrt(2 * height / back), speed = back * time, way = height;
      const Impacts& impacts = *run.impacts;
      REQUIRE(impacts.time.size() > 20);
      for (std::size_t i = 0; speed > 1e-12; ++i) {
        if (i < 20) {
          CHECK(impacts.time[i] == doctest::Approx(time).epsilon(1e-7));
          CHECK(impacts.relative_velocity[i] == doctest::Approx(-speed).epsilon(1e-7));
        }
        const double rises = e_of(speed) * speed;
        time += rises / out + r * rises / back, way += rises * rises / out, speed = r * rises;
      }
      REQUIRE(run.contacts->begin.size() == 1);
      CHECK(run.contacts->begin[0] == doctest::Approx(time).epsilon(1e-7));
      CHECK(run.energy->friction_loss == doctest::Approx(nu * phi * way).epsilon(1e-7));
      CHECK(std::abs(run.energy->residual) < 1e-14);
      // Impacts are followed until the next one has e(0) within the tolerance of (M18.19).
      const double last = -impacts.relative_velocity.back(), next = r * e_of(last) * last;
      CHECK(std::abs(e_of(next) - e_0) <= 1e-8 * (1 - r * e_0));
    }
  }
}

TEST_CASE("laws: one restitution at all speeds is a number beside friction, weight and drag, too") {
  Scene scene{.x0 = 3, .until_time = 60};
  scene.dampers = {{.restitution = 0.55, .friction = 0.02}, {.restitution = 0.4, .clearance = 0.8}};
  for (const double drag : {0.0, 0.01}) {
    CAPTURE(drag);
    scene.dampers[1].drag = drag;
    const Run run = simulate(scene, Restitution{}, everything());
    REQUIRE(run.energy->bounce_downs > 0);
    Scene pairs = scene;
    for (SceneDamper& each : pairs.dampers)
      each.restitution_by_speed = {{1e-3, each.restitution}, {2, each.restitution}};
    Run same = simulate(pairs, Restitution{}, everything());
    CHECK(same.half_cycles->amplitude == run.half_cycles->amplitude);
    CHECK(same.energy->bounce_down_loss == run.energy->bounce_down_loss);
  }
}

TEST_CASE("laws: invalid ones are rejected") {
  const auto told = [](const auto& change) {
    Scene scene{.until_time = 1};
    change(scene, scene.damper());
    const std::vector<Problem> problems = problems_of(scene);
    return problems.empty() ? std::string() : problems[0].field + ": " + problems[0].message;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto table = [&](const Pairs& pairs) {
    return told([&](Scene&, SceneDamper& d) { d.wall = {.law = WallForm::table, .pairs = pairs}; });
  };
  CHECK(table({{0, 0}, {1, 2}}).empty());
  CHECK(contains(table({{0, 0}}), "wall.pairs: must be 2 to 1000 pairs, got 1"));
  for (const Pairs& pairs :
       {Pairs{{0, 0}, {1, 2}, {2, 2}}, {{0, 0}, {1, 2}, {1, 3}}, {{0, 0}, {1, 2}, {2, 1}}})
    CHECK(contains(table(pairs), "wall.pairs: must rise from pair to pair"));
  CHECK(contains(table({{0, 0}, {nan, 2}}), "wall.pairs: must have lengths up to"));
  CHECK(contains(table({{0, 1}, {1, 2}}), "wall.pairs: must begin with the pair [0, 0], got [0, 1]"));
  const auto power = [&](double exponent, double speed) {
    return told([&](Scene&, SceneDamper& d) {
      d.wall = {.law = WallForm::power, .exponent = exponent, .speed = speed};
    });
  };
  CHECK(power(1, 1e-6).empty());
  for (const double exponent : {0.99, 10.1, nan})
    CHECK(contains(power(exponent, 1), "wall.exponent: must be >= 1"));
  for (const double speed : {0.0, -1.0, nan})
    CHECK(contains(power(2, speed), "wall.speed: must be >= 1e-06"));
  CHECK(contains(told([](Scene&, SceneDamper& d) {
                   d.restitution = 0;
                   d.wall.law = WallForm::power;
                 }),
                 "restitution: must be >= 0.001 beside a wall"));
  CHECK(contains(told([](Scene& s, SceneDamper&) { s.spring.cubic = -1; }), "spring.cubic: must be >= 0"));
  CHECK(contains(told([](Scene& s, SceneDamper&) {
                   s.spring = {.law = SpringForm::table, .pairs = {{1, 1}, {2, 2}}};
                 }),
                 "spring.pairs: must have the pair [0, 0]"));
  const auto by_speed = [&](const Pairs& pairs) {
    return told([&](Scene&, SceneDamper& d) { d.restitution_by_speed = pairs; });
  };
  CHECK(by_speed({{0, 1}, {1, 0}}).empty());
  CHECK(contains(by_speed({{0, 1}, {1, 1.01}}),
                 "restitution: must have an e of 0 to 1 at each speed, got [1, 1.01]"));
  for (const Pairs& pairs : {Pairs{{-1, 0.5}}, {{0, 0.5}, {0, 0.4}}, {{nan, 0.5}}})
    CHECK(contains(by_speed(pairs), "restitution: must have speeds that rise"));
}
