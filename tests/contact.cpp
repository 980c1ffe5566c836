// The motion in contact with a compliant wall, what a wall is, and the work that motions do.
#include "impact_damper/motion/contact.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/motion/contact_work.hpp"
#include "impact_damper/motion/flight.hpp"
#include "impact_damper/motion/lead.hpp"
#include "impact_damper/motion/wall.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "shared_scenes.hpp"

using namespace impact_damper;
using reference::Quad;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

double magnitude(Quad x) { return double(reference::absolute(x)); }

// Equations (5)-(8) as one linear system of x, v, s q and w, with the force as two more unknowns; with s the
// wall's frequency all entries are of its order.
reference::Matrix<6> contact_matrix(Quad nu, Quad k, Quad c, Quad zeta, Quad f0, Quad omega, Quad s) {
  return {{{0, 1, 0, 0, 0, 0},
           {-1, -2 * zeta, nu * k / s, nu * c, f0, 0},
           {0, 0, 0, s, 0, 0},
           {1, 2 * zeta, -(1 + nu) * k / s, -(1 + nu) * c, -f0, 0},
           {0, 0, 0, 0, 0, omega},
           {0, 0, 0, 0, -omega, 0}}};
}

// x, v, q, w after a time t of contact.
template <class Real>
std::array<Quad, 4> shifted(const ContactModes<Real>& wall, const std::array<double, 4>& from, double begin,
                            double t) {
  const Quad nu = wall.nu, k = wall.stiffness, c = wall.damping, zeta = wall.zeta;
  const Quad f0 = wall.forcing.amplitude, omega = wall.forcing.frequency;
  const Quad s = std::sqrt(double(wall.stiffness));
  const auto a = contact_matrix(nu, k, c, zeta, f0, omega, s);
  const auto phase = reference::exponential<2>({{{0, omega}, {-omega, 0}}}, begin);
  const auto u = reference::applied<6>(reference::exponential(a, t),
                                       {from[0], from[1], from[2] * s, from[3], phase[0][1], phase[1][1]});
  return {u[0], u[1], u[2] / s, u[3]};
}

Scene random_scene(reference::Random& random) {
  Scene scene;
  scene.damper().mass_ratio = random.log_uniform(1e-8, 1e3);
  scene.damper().restitution = random.chance(0.1) ? double(random.chance(0.5)) : random.uniform(0, 1);
  scene.damper().wall_stiffness = random.log_uniform(1, 1e12);
  scene.damping_ratio = random.chance(0.3) ? 0 : random.log_uniform(1e-4, 10);
  if (random.chance(0.5)) {
    scene.force_amplitude = random.log_uniform(1e-3, 10);
    scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.1, 10);
  }
  return scene;
}

}  // namespace

TEST_CASE_TEMPLATE("the two quadratic factors give back the contact's characteristic polynomial", Real,
                   double, long double) {
  const double roundings = 64 * double(std::numeric_limits<Real>::epsilon());
  reference::Random random(11);
  for (int n = 0; n < 20000; ++n) {
    const Scene scene = random_scene(random);
    const Real nu = scene.damper().mass_ratio, zeta = scene.damping_ratio,
               k = Real(scene.damper().wall_stiffness) / nu;
    const Real c = 2 * zeta_m_closed_form(Real(scene.damper().restitution)) * square_root(k);
    const ContactFactors<Real> f = factor_contact(nu, zeta, k, c);
    INFO("n ", n, ", scene ", scene_text(scene));
    CHECK(f.p >= 0);
    CHECK(f.p2 >= 0);
    CHECK(f.b > 0);
    CHECK(f.b <= f.b2);
    const Quad p = f.p, b = f.b, p2 = f.p2, b2 = f.b2, z = zeta, m = nu, q = k, d = c;
    const auto check = [&](Quad found, Quad expected) {
      CHECK(magnitude(found - expected) <= roundings * magnitude(expected));
    };
    check(p + p2, 2 * z + d * (1 + m));
    check(b + b2 + p * p2, 1 + 2 * z * d + q * (1 + m));
    check(p * b2 + p2 * b, d + 2 * z * q);
    check(b * b2, q);
  }
}

TEST_CASE("contact moves as the coupled linear system does, for every wall, mass ratio, damping and force") {
  reference::Random random(12);
  for (int n = 0; n < 4000; ++n) {
    const Scene scene = random_scene(random);
    const System<double> system(scene);
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const double root_k = std::sqrt(walls.stiffness), rate = walls.fast.rate();
    // An impact, or any overlap, of either mass's motion of any size.
    std::array<double, 4> from{random.uniform(-10, 10), random.uniform(-10, 10), 0,
                               -random.log_uniform(1e-6, 1e2)};
    if (random.chance(0.3)) from[2] = -random.log_uniform(1e-6, 1) / root_k;
    const double begin = random.chance(0.5) ? 0 : random.uniform(0, 50);
    const double t = random.log_uniform(1e-3 / rate, 20);
    if (rate * t > 1e8) continue;

    const Contact<double> contact(walls, begin, {from[0], from[1], from[2], from[3]}, Wall::left);
    const State<double> found = contact.at(t);
    const auto expected = shifted(walls, from, begin, t);

    // The sizes of the two motions, and how far rounding of the phase shifts what still rings.
    const double f0 = std::abs(scene.force_amplitude), nu = scene.damper().mass_ratio;
    const double slow = std::abs(from[0]) + std::abs(from[1]) + f0 * (1 + std::min(t, 20.0)) +
                        nu / (1 + nu) * (std::abs(from[3]) + root_k * std::abs(from[2]));
    const double fast = std::abs(from[3]) + root_k * std::abs(from[2]) + slow / std::max(root_k, 1.0);
    const double ringing = rate * std::min(t, 1 / std::max(walls.fast.a(), 1e-300));
    const double roundings = epsilon * (1 + ringing + (1 + scene.force_frequency) * (begin + t));
    const double share = nu / (1 + nu);
    const double errors[4] = {magnitude(found.x - expected[0]) / (slow + share * fast),
                              magnitude(found.v - expected[1]) / (slow + share * fast),
                              magnitude(found.y - expected[2]) / (fast / root_k),
                              magnitude(found.w - expected[3]) / fast};
    INFO("n ", n, ", scene ", scene_text(scene), ", t * rate ", t * rate, ", t ", t);
    for (int i = 0; i < 4; ++i) {
      CAPTURE(i);
      CHECK(errors[i] <= 64 * roundings);
    }
  }
}

namespace {

constexpr int samples_of_impact = 1000;

// What a scene's wall makes of an impact at unit relative velocity, both masses otherwise at rest at x = 0.
struct Impact {
  double restitution, momentum_change;
  double without_pull;  // the restitution if the masses parted where the wall's damper begins to pull
};
Impact impact_of(const Scene& scene, Calibration calibration) {
  const System<double> system(scene);
  const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), calibration));
  const Contact<double> contact(walls, 0.0, {0, 0, 0, -1}, Wall::left);
  Search<double> search{std::numeric_limits<double>::infinity()};
  const auto left = contact.leave(100.0, search);
  REQUIRE(left.has_value());
  const State<double> after = left->state;
  const double nu = scene.damper().mass_ratio;
  // y'' is proportional to the wall's force: y' is greatest where that changes its sign.
  double greatest = 0;
  for (int i = 0; i <= samples_of_impact; ++i)
    greatest = std::max(greatest, contact.at(left->time * i / samples_of_impact).w);
  return {after.w, (1 + nu) * after.v + nu * after.w + nu, greatest};
}

}  // namespace

TEST_CASE("the first three derivatives of x at a contact's beginning are those of its motion") {
  reference::Random random(13);
  for (int n = 0; n < 500; ++n) {
    const Scene scene = random_scene(random);
    const System<double> system(scene);
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const bool at_rest = random.chance(0.2);  // then the force's own jerk may be all there is
    const double x = at_rest ? 0 : random.uniform(-6, 6), v = at_rest ? 0 : random.uniform(-6, 6);
    const double w = at_rest ? 0 : random.uniform(-6, 0), begin = at_rest ? 0 : random.uniform(0, 10);
    const Contact<double> contact(walls, begin, {x, v, 0, w}, Wall::left);
    // From velocities a short time before and behind; the next derivatives are larger by the fastest rate.
    const double rate = std::max({1.0, walls.fast.rate(), scene.force_frequency}), h = 1e-7 / rate;
    const std::array<double, 4> start{x, v, 0, w};
    const Quad before = shifted(walls, start, begin, -h)[1], behind = shifted(walls, start, begin, h)[1];
    const double x2 = double((behind - before) / (2 * Quad(h)));
    const double x3 = double((behind - 2 * Quad(v) + before) / (Quad(h) * h));
    const double size =
        std::abs(x) + (1 + scene.damping_ratio) * std::abs(v) + std::abs(scene.force_amplitude) +
        scene.damper().mass_ratio * (walls.damping * std::abs(w) + walls.stiffness * std::abs(w) / rate);
    const std::array<double, 4> leads = contact.leads_of_x();
    CAPTURE(n);
    CHECK(leads[0] == x);
    CHECK(leads[1] == v);
    CHECK(std::abs(leads[2] - x2) <= 1e-10 * size);
    CHECK(std::abs(leads[3] - x3) <= 1e-6 * size * rate * (1 + scene.damper().mass_ratio));
    if (at_rest && scene.force_amplitude != 0)
      CHECK(leads[3] == doctest::Approx(scene.force_amplitude * scene.force_frequency));
  }
}

TEST_CASE("the velocities at the end of a short contact are off by a few roundings") {
  // An error of the series about T, the same in each of a run's contacts, would add up over thousands.
  reference::Random random(716);
  int contacts = 0;
  for (int i = 0; i < 400; ++i) {
    Scene scene;
    scene.damper().mass_ratio = random.log_uniform(0.01, 20);
    scene.damper().restitution = random.uniform(0.3, 1);
    scene.damper().wall_stiffness = random.log_uniform(1e3, 1e8);
    if (random.chance(0.5)) scene.damping_ratio = random.uniform(0, 0.1);
    if (random.chance(0.5)) scene.force_amplitude = random.uniform(0, 2);
    const System<double> system(scene);
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const double size = random.log_uniform(1, 1000);  // of x, in units of the velocities
    for (int touch = 0; touch < 20; ++touch) {
      const double x = random.uniform(-size, size), v = random.uniform(-1, 1), w = random.uniform(-1, -0.05);
      const double begin = random.uniform(0, 6);
      Search<double> search{2};
      const auto end = Contact<double>(walls, begin, {x, v, 0, w}, Wall::left).leave(1.0, search);
      if (!end || !(std::abs(end->time * walls.fast.rate() - std::numbers::pi) < 0.5)) continue;
      ++contacts;
      const auto truth = shifted(walls, {x, v, 0, w}, begin, end->time);
      INFO("mass_ratio ", scene.damper().mass_ratio, ", x ", x);
      // 8 was seen for w, 5 for v; an impulse that acts on x has its rounding, too.
      CHECK(magnitude(truth[3] - Quad(end->state.w)) < 16 * 0x1p-53 * (-w + std::abs(x) * end->time));
      CHECK(magnitude(truth[1] - Quad(end->state.v)) <
            16 * 0x1p-53 * (std::abs(v) - w + std::abs(x) * end->time));
    }
  }
  CHECK(contacts > 4000);
}

namespace {

Quad root(Quad x) {
  Quad s = std::sqrt(double(x));
  for (int i = 0; i < 3; ++i) s = (s + x / s) / 2;
  return s;
}

// Errors of short contacts that are the same in each, in units of 2^-53: means over many contacts, in which
// those that differ average out. Of the energy, by what it was at the touch; of w at the end, by w at the
// touch; of the time, by the time the contact lasts.
struct CommonError {
  double energy, w, time;
};
CommonError common_error(const Scene& scene) {
  const System<double> system(scene);
  const double damping_ratio = zeta_m<double>(scene.damper(), Calibration::fixed_wall);
  const ContactModes<double> walls(system, damping_ratio);
  const double T = walls.fast.half_period();
  // The scene's own stiffness and damping, not as they are rounded.
  const Quad nu = scene.damper().mass_ratio, k = scene.damper().wall_stiffness / nu,
             c = 2 * damping_ratio * root(k);
  const Quad zeta = scene.damping_ratio, f0 = scene.force_amplitude, omega = scene.force_frequency;
  const Quad s = std::sqrt(double(k));
  const reference::Matrix<6> a = contact_matrix(nu, k, c, zeta, f0, omega, s),
                             until_T = reference::exponential(a, T);
  reference::Random random(717);
  CommonError sum{0, 0, 0};
  double contacts = 0;
  for (int i = 0; i < 3000; ++i) {
    const double x = random.uniform(-4, 4), v = random.uniform(-2, 2), w = random.uniform(-2, -0.5);
    const double begin = random.uniform(0, 6);
    const SinCos<double> phase = system.forcing.phase(begin);
    const auto end = walls.short_contact.end(
        {x, v, w, scene.force_amplitude * phase.sin, scene.force_amplitude * phase.cos});
    if (!end || !(std::abs(end->time / T - 1) < 0.05)) continue;
    auto truth = reference::applied<6>(until_T, {x, v, 0, w, phase.sin, phase.cos}), term = truth;
    const Quad rest = Quad(end->time) - Quad(T);
    for (int n = 1; n < 15; ++n) {
      term = reference::applied<6>(a, term);
      for (std::size_t j = 0; j < 6; ++j) truth[j] += term[j] *= rest / n;
    }
    const Quad dx = end->x - truth[0], dv = end->v - truth[1], dw = end->w - truth[3];
    const double energy = 0.5 * (x * x + v * v + scene.damper().mass_ratio * (v + w) * (v + w));
    sum.energy += double(truth[0] * dx + truth[1] * dv + nu * (truth[1] + truth[3]) * (dv + dw)) / energy;
    sum.w += double(dw) / w;
    sum.time += double(truth[2] / s / truth[3]) / T;
    ++contacts;
  }
  REQUIRE(contacts > 2000);
  const double each = 0x1p53 / contacts;
  return {sum.energy * each, sum.w * each, sum.time * each};
}

}  // namespace

TEST_CASE("errors that are the same in every short contact are well below a rounding") {
  for (double nu : {0.05, 0.37, 3.1})
    for (double e : {0.6, 1.0})
      for (double stiffness : {1.3e4, 1e6, 1e8})
        for (bool driven : {false, true}) {
          Scene scene{.dampers = {{.mass_ratio = nu, .restitution = e, .wall_stiffness = stiffness * nu}}};
          if (driven) scene.damping_ratio = 0.02, scene.force_amplitude = 1, scene.force_frequency = 0.9;
          const CommonError error = common_error(scene);
          INFO("nu ", nu, ", e ", e, ", stiffness ", stiffness, ", driven ", driven);
          // What averages out leaves about 0.03, 0.01 and 0.01 in the mean.
          CHECK(std::abs(error.energy) < 0.15);
          CHECK(std::abs(error.w) < 0.1);
          CHECK(std::abs(error.time) < 0.05);
        }
}

TEST_CASE("a single impact delivers the restitution of the effective damping ratio zeta_m sqrt(1 + nu)") {
  for (double nu : {1e-6, 0.02, 0.3, 5.0})
    for (double e : {0.2, 0.6, 0.9, 1.0}) {
      const Scene scene{.dampers = {{.mass_ratio = nu, .restitution = e, .wall_stiffness = 1e14}}};
      const double z = zeta_m_closed_form(e) * std::sqrt(1 + nu);
      if (z > 0.99) continue;
      INFO("nu ", nu, ", e ", e);
      // In its short time, about pi sqrt(nu/k), the spring acts on the primary mass: relative order 1/K.
      const double allowed = 1e-11 + 100 * nu / scene.damper().wall_stiffness;
      const Impact fixed = impact_of(scene, Calibration::fixed_wall);
      CHECK(std::abs(fixed.restitution - std::exp(-std::numbers::pi * z / std::sqrt(1 - z * z))) < allowed);
      CHECK(std::abs(fixed.momentum_change) < allowed * nu + 1e-15);
      // Half a sample beside its greatest y' is less by (omega_m T / samples)^2 / 8 of it.
      const double root = std::sqrt((1 - z) * (1 + z)), part = std::numbers::pi / root / samples_of_impact;
      CHECK(std::abs(fixed.without_pull - std::exp(-2 * z * std::acos(z) / root)) <
            allowed + part * part / 8);
      CHECK(std::abs(impact_of(scene, Calibration::two_body).restitution - e) < allowed);
    }
  Scene paper{.dampers = {{.wall_stiffness = 1e14}}};
  CHECK(impact_of(paper, Calibration::fixed_wall).restitution ==
        doctest::Approx(0.597).epsilon(5e-4 / 0.597));
  paper.damper().mass_ratio = 1e-6;  // a primary mass that stands still
  CHECK(impact_of(paper, Calibration::fixed_wall).without_pull ==
        doctest::Approx(0.632).epsilon(5e-4 / 0.632));
}

TEST_CASE("a critically or overdamped wall gives nothing back until something pulls the masses apart") {
  // e = 0 is zeta_m = 1: critical on a fixed wall, overdamped on a free primary mass. The relative motion
  // alone never comes back to the wall; here the primary mass, thrown to the right of x = 0, takes it along
  // until it has turned and x'' > 0 no longer presses.
  for (double nu : {1e-6, 0.5, 30.0}) {
    const Scene scene{.dampers = {{.mass_ratio = nu, .restitution = 0}}};
    const System<double> system(scene);
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const Contact<double> contact(walls, 0.0, {-1, 0, 0, -1}, Wall::left);
    Search<double> search{std::numeric_limits<double>::infinity()};
    const auto left = contact.leave(100.0, search);
    REQUIRE(left.has_value());
    CAPTURE(nu);
    // Joined, the masses pass x = 0 a quarter period of sqrt(1 + nu) after x = -1, a little less for the
    // velocity -nu/(1+nu) that the impact gives them, and the wall takes about 2 zeta_m/omega_m to let go.
    const double root = std::sqrt(1 + nu), v = -nu / (1 + nu);
    const double crossing = root * (std::numbers::pi - std::atan2(1.0, -v * root));
    CHECK(left->time > 0.9 * (crossing - 1e-3));
    CHECK(left->time < crossing + 20 / std::sqrt(walls.stiffness) * (1 + nu));
  }
}

TEST_CASE("a flight that dies away loses all its energy to its damper, in however long a time") {
  for (double zeta : {1e-3, 0.5, 0.9, 1.0, 1.1, 30.0, 1e6}) {
    const Scene scene{.damping_ratio = zeta};
    const System<double> system(scene);
    for (double v : {0.0, -3.0}) {
      const Flight<double> flight(system, 0, {2, v, 0.5, 0});
      // The slower rate is never below 1/(2 zeta): exp(-80) is left.
      const double duration = 40 * (2 * zeta + 1 / zeta);
      Search<double> search{1};
      const Work<double> works = work_of(system, flight, 0.0, duration, 0.0, search);
      INFO("zeta ", zeta, ", v ", v);
      CHECK(std::abs(works.viscous / ((4 + v * v) / 2) - 1) < 2e-13);  // a sum of up to 2e5 terms
    }
  }
}

namespace {

// Contacts that ring through hundreds to thousands of swings in their time, however pressed the masses are.
Scene random_contact(reference::Random& random) {
  Scene scene;
  scene.damper().mass_ratio = random.log_uniform(1e-3, 10);
  scene.damper().restitution = random.chance(0.3) ? 1 : random.uniform(0.1, 1);
  scene.damper().wall_stiffness = random.log_uniform(1e3, 1e5);
  scene.damping_ratio = random.chance(0.3) ? 0 : random.log_uniform(1e-3, 3);
  if (random.chance(0.6)) {
    scene.force_amplitude = random.log_uniform(1e-2, 10);
    scene.force_frequency = random.chance(0.3) ? 1 : random.log_uniform(0.1, 4);
  }
  scene.until_time = random.uniform(5, 20);
  return scene;
}

}  // namespace

TEST_CASE("a long contact's works are those of a quadrature that follows all its ringing") {
  reference::Random random(31);
  for (int n = 0; n < 200; ++n) {
    const Scene scene = random_contact(random);
    const double duration = *scene.until_time;
    const System<double> system(scene);
    const ContactModes<double> walls(system, zeta_m<double>(scene.damper(), Calibration::fixed_wall));
    const double begin = random.uniform(0, 10), root_k = std::sqrt(walls.stiffness);
    const Contact<double> contact(
        walls, begin, {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2) / root_k, -1.5},
        Wall::left);
    const double wall_damping = system.nu * walls.damping;
    Search<double> search{1};
    const Work<double> found = work_of(system, contact, begin, duration, wall_damping, search);
    const Work<double> expected =
        work_of<Contact<double>>(system, contact, begin, duration, wall_damping, search);
    INFO("n ", n, ", scene ", scene_text(scene));
    // Energies are of order one; a swing's phase is rounded by epsilon times its number of radians.
    const double radians = walls.fast.rate() * duration;
    const double allowed = 1e-15 * (16 + radians) * (1 + expected.turnover);
    CHECK(std::abs(found.viscous - expected.viscous) < allowed);
    CHECK(std::abs(found.wall - expected.wall) < allowed);
    CHECK(std::abs(found.forcing - expected.forcing) < allowed);
  }
}

TEST_CASE("the closed form gives back the restitution it came from") {
  for (double e : {1e-6, 0.01, 0.4, 0.6, 0.8, 0.99, 1 - 1e-12}) {
    const double z = zeta_m_closed_form(e);
    CHECK(std::exp(-std::numbers::pi * z / std::sqrt((1 - z) * (1 + z))) == doctest::Approx(e).epsilon(1e-9));
  }
  CHECK(zeta_m_closed_form(1.0) == 0);
  CHECK(zeta_m_closed_form(0.0) == 1);
}

TEST_CASE(
    "the paper's iterative subroutine finds the closed form's zeta_m to its 1e-8 in at least 100 steps") {
  for (double e : {1.0, 0.99, 0.8, 0.6, 0.4, 0.1, 0.01}) {
    const IterativeZeta found = zeta_m_iterative(e);
    CHECK(found.steps >= 100);
    CHECK(found.velocity_error <= 1e-8);
    // |de/dzeta| >= 0.03 over these e: a velocity error of 1e-8 is at most 4e-7 in zeta_m.
    CHECK(std::abs(found.zeta_m - zeta_m_closed_form(e)) < 4e-7);
    CHECK(std::abs(zeta_m_iterative(e, 1e-13).zeta_m - zeta_m_closed_form(e)) < 4e-12);
  }
}

// --- At rest on a wall where x'' and x''' vanish -----------------------------------------------------------

// Which way it goes: docs/mathematics.md, 7.3.

namespace {

using Walls = std::vector<PushedWall<double>>;

Lead<double> lead_at(const Forcing<double>& force, const SinCos<double>& phase, double zeta, double x,
                     double v, const Walls& walls = {}) {
  return lead_of_x<double>(2 * zeta, 1.0, force, phase, x, v, walls);
}

Run run_of(const Scene& scene, const Engine& engine) {
  return simulate(scene, engine, {.impacts = true, .contacts = true, .energy = true});
}

}  // namespace

TEST_CASE("the first derivative of x that is not zero to rounding leads") {
  reference::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Forcing<double> force{random.log_uniform(1e-6, 1e6) * random.sign(), random.log_uniform(1e-6, 1e3)};
    const double zeta = random.log_uniform(1e-3, 1e3), angle = random.uniform(0.1, 1.4);
    const SinCos<double> phase{std::sin(angle), std::cos(angle)};
    const double f = force.amplitude * phase.sin, f1 = force.amplitude * force.frequency * phase.cos;
    CAPTURE(i);

    const Lead<double> second = lead_at(force, phase, zeta, -f, 0);
    CHECK(second.order == 2);
    CHECK(second.value == f + f);
    const double v = 3 * f1;
    const Lead<double> third = lead_at(force, phase, zeta, f - 2 * zeta * v, v);
    CHECK(third.order == 3);
    CHECK(third.value == doctest::Approx(f1 - v));
    const Lead<double> fourth = lead_at(force, phase, zeta, f - 2 * zeta * f1, f1);
    CHECK(fourth.order == 4);
    CHECK(fourth.value == doctest::Approx(-force.frequency * force.frequency * f));
    const double across = force.amplitude * force.frequency;
    const Lead<double> fifth = lead_at(force, {0, 1}, zeta, -2 * zeta * across, across);
    CHECK(fifth.order == 5);
    CHECK(fifth.value == doctest::Approx(-force.frequency * force.frequency * across));
  }
  CHECK(lead_at({0, 1}, {0, 1}, 0.3, 0, 0).order == 0);
}

TEST_CASE("walls that others push lead x by later derivatives, or hold it for ever") {
  // A wall without damping that is met with the speed w: x''' = nu K w + f0 omega_f, x^(5) = K f0 omega_f -
  // f0 omega_f^3 if that is zero, and x stays at rest if omega_f^2 = K as well.
  const double stiffness = 64, nu = 0.25, f0 = 3;
  for (const double omega : {2.0, 8.0, 16.0}) {
    const Walls wall{{nu, stiffness, 0, 0, -f0 * omega / (nu * stiffness)}};
    const Lead<double> lead = lead_at({f0, omega}, {0, 1}, 0.125, 0, 0, wall);
    CAPTURE(omega);
    CHECK(lead.order == (omega == 8 ? 0u : 5u));
    CHECK(lead.value == f0 * omega * (stiffness - omega * omega));
  }
}

TEST_CASE(
    "a mass at rest on a wall where y'' and y''' vanish sticks or leaves as the fifth derivative tells") {
  reference::Random random(2);
  for (int i = 0; i < 60; ++i) {
    Scene scene;
    scene.damper().mass_ratio = random.log_uniform(1e-3, 10);
    scene.damper().restitution = i % 4 == 0 ? 0 : random.uniform(0.1, 0.9);
    scene.damping_ratio = i % 3 == 0 ? 0 : random.log_uniform(1e-3, 2);
    scene.damper().wall_stiffness = random.log_uniform(1e2, 1e8);
    scene.force_amplitude = random.log_uniform(0.1, 10) * random.sign();
    scene.force_frequency = random.log_uniform(0.2, 2);
    scene.v0 = scene.force_amplitude * scene.force_frequency;
    scene.x0 = -2 * scene.damping_ratio * scene.v0;
    scene.damper().y0 = i % 2;
    scene.until_time = 3 / scene.force_frequency;
    // y^(5) = f0 omega_f^3.
    const bool sticks = (scene.damper().y0 == 0) == (scene.force_amplitude < 0);
    std::array<double, 2> parts{};  // when the mass leaves the wall, with either kind
    for (const Engine& engine : {Engine(Restitution{}), Engine(Exact{})}) {
      INFO("i ", i, ", engine ", name_of(engine));
      const Run one = run_of(scene, engine), list = run_of(list_of_one(scene), engine);
      for (const Run* run : {&one, &list}) {
        CHECK(run->stop_reason == StopReason::time);
        CHECK(run->impacts->time.size() < 200);
        CHECK(std::fabs(run->energy->residual) < 1e-13);
        if (sticks) {
          REQUIRE(!run->contacts->begin.empty());
          CHECK(run->contacts->begin[0] == 0);
          CHECK(run->contacts->end[0] > 0.1 / scene.force_frequency);
        }
        // Nothing is met soon.
        const double soon = sticks ? run->contacts->end[0] : 1e-2;
        CHECK((run->impacts->time.empty() || run->impacts->time[0] > soon));
      }
      if (sticks) {
        CHECK(std::fabs(one.contacts->end[0] - list.contacts->end[0]) < 1e-11);
        parts[std::holds_alternative<Exact>(engine)] = one.contacts->end[0];
      }
    }
    if (sticks && scene.damper().wall_stiffness > 1e4 * scene.damper().mass_ratio)
      CHECK(std::fabs(parts[0] - parts[1]) <
            20 * std::sqrt(scene.damper().mass_ratio / scene.damper().wall_stiffness));
  }
}

TEST_CASE("the paper's stuck regime begins with a mass that the fifth derivative presses to its wall") {
  const Scene scene{.x0 = 0,
                    .v0 = 1,
                    .force_amplitude = 1,
                    .force_frequency = 1,
                    .until_time = 1,
                    .dampers = {{.mass_ratio = 1, .y0 = 1}}};
  const Cem options{.stuck_speed = 0.01};
  const Run run = run_of(scene, options);
  CHECK(run.impacts->time.empty());
  REQUIRE(run.contacts->begin.size() == 1);
  CHECK(run.contacts->begin[0] == 0);
  CHECK(run.contacts->end[0] == 1);
}
