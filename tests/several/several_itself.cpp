// The oracle for several dampers against closed forms.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "several_compare.hpp"
#include "several_scenes.hpp"

using namespace several;
using namespace impact_damper;

namespace {

SceneDamper damper(double nu, double e, double clearance, double y0, double w0) {
  SceneDamper damper;
  damper.mass_ratio = nu, damper.restitution = e, damper.clearance = clearance;
  damper.y0 = y0, damper.w0 = w0;
  return damper;
}

Answer answer_for(const Scene& scene) {
  Question question;
  question.scene = scene;
  question.samples = {0, *scene.until_time / 3, *scene.until_time};
  return answer_to(question);
}

double off(Quad a, Quad b) { return double(oracle::magnitude(a - b)); }

}  // namespace

TEST_CASE("one damper with two impacts in each period moves as the closed form says") {
  // Undamped, at omega; the secondary mass flies with velocity u from the left wall to the right one in half
  // a period, theta. With x = a cos t + b sin t + X sin(omega t + tau) from the impact at the left wall on,
  // symmetry, restitution and momentum give a, b, X and tau.
  const double nu = 0.1, e = 0.6, clearance = 2, omega = 1.3, u = 0.4;
  const double theta = std::numbers::pi / omega, x0 = (clearance - u * theta) / 2;
  const double before = u * (1 + 2 * nu - e) / (1 + e);
  const double a = nu * u * std::tan(theta / 2), b = -nu * u;
  const double sine = x0 - a, cosine = (before - nu * u) / omega;
  const double size = std::hypot(sine, cosine), tau = std::atan2(sine, cosine);
  // The scene begins where the force is zero, in that half period.
  double start = std::fmod(-tau / omega, theta);
  if (start < 0) start += theta;
  Scene scene;
  scene.damping_ratio = 0, scene.force_frequency = omega;
  scene.force_amplitude = size * (1 - omega * omega) * (std::cos(omega * start + tau) > 0 ? 1 : -1);
  const auto x = [&](double t) {
    return a * std::cos(t) + b * std::sin(t) + size * std::sin(omega * t + tau);
  };
  scene.x0 = x(start);
  scene.v0 = -a * std::sin(start) + b * std::cos(start) + size * omega * std::cos(omega * start + tau);
  scene.dampers = {damper(nu, e, clearance, x0 + u * start - scene.x0, u - scene.v0)};
  scene.until_time = 8 * theta;
  const Answer answer = answer_for(scene);
  REQUIRE(answer.impacts.size() == 8);
  for (int i = 0; i < 8; ++i) {
    const Impact& each = answer.impacts[i];
    CHECK(each.wall == (i % 2 == 0 ? Wall::right : Wall::left));
    const double sign = i % 2 == 0 ? 1 : -1;
    CHECK(off(each.time, (i + 1) * theta - start) < 1e-10);
    CHECK(off(each.relative_velocity, sign * (u + before)) < 1e-10);
    CHECK(off(each.displacement, -sign * x0) < 1e-10);
  }
}

TEST_CASE("masses that meet a wall at one instant share their impulses") {
  Scene scene;
  scene.x0 = 0, scene.until_time = 0.1;
  scene.dampers = {damper(0.5, 1, 1, 0, -1), damper(0.5, 0.5, 1, 0, -1), damper(0.5, 0.5, 1, 0, 0)};
  // J = -(0.5 2 + 0.5 1.5)/(1 + 0.5 + 0.5): the third rests there and is left behind.
  Answer answer = answer_for(scene);
  REQUIRE(answer.impacts.size() == 2);
  CHECK(answer.samples[0].v == Quad(-0.875));
  CHECK(answer.samples[0].w[0] == 1);
  CHECK(answer.samples[0].w[1] == Quad(0.5));
  CHECK(answer.samples[0].w[2] == Quad(0.875));
  // At the other side the third is pushed: 1 + 0.5 is struck.
  scene.dampers = {damper(0.5, 0.5, 1, 0, -1), damper(0.5, 0.5, 1, 1, 0)};
  answer = answer_for(scene);
  CHECK(off(answer.samples[0].v, -Quad(0.75) / 2) < 1e-30);
  CHECK(answer.samples[0].w[1] == 0);
}

TEST_CASE("equal dampers are one of their masses together, sticking included") {
  for (const double e : {0.0, 0.25, 1.0}) {
    Scene one, two;
    one.until_time = two.until_time = 20;
    one.x0 = two.x0 = 3;
    one.damping_ratio = two.damping_ratio = 0.05;
    one.dampers = {damper(0.25, e, 1, 0.3, 0)};
    two.dampers = {damper(0.125, e, 1, 0.3, 0), damper(0.125, e, 1, 0.3, 0)};
    const Answer a = answer_for(one), b = answer_for(two);
    REQUIRE(b.impacts.size() == 2 * a.impacts.size());
    REQUIRE(b.contacts.size() == 2 * a.contacts.size());
    CHECK(a.impacts.size() > 5);
    CAPTURE(e);
    CHECK((e == 1) == a.contacts.empty());
    for (std::size_t i = 0; i < a.impacts.size(); ++i) {
      CHECK(b.impacts[2 * i + 1].damper == 1);
      CHECK(off(a.impacts[i].time, b.impacts[2 * i].time) < 1e-22);
      CHECK(b.impacts[2 * i].time == b.impacts[2 * i + 1].time);
      CHECK(off(a.impacts[i].loss, b.impacts[2 * i].loss + b.impacts[2 * i + 1].loss) < 1e-22);
    }
    CHECK(off(a.samples[2].x, b.samples[2].x) < 1e-20);
  }
}

TEST_CASE("those that stick move with the primary mass until x'' is zero") {
  // At rest on the right wall, x0 > 0: x = cos(t / sqrt(1.5)) until x = 0, then all fly with x' as it is.
  Scene scene;
  scene.x0 = 1, scene.until_time = 3;
  scene.dampers = {damper(0.25, 0.5, 10, 10, 0), damper(0.25, 0, 20, 20, 0)};
  const Answer answer = answer_for(scene);
  REQUIRE(answer.contacts.size() == 2);
  const double release = std::numbers::pi / 2 * std::sqrt(1.5);
  for (const Contact& each : answer.contacts) {
    CHECK(each.begin == 0);
    CHECK(off(each.end, release) < 1e-15);
    CHECK(each.wall == Wall::right);
  }
  const double speed = 1 / std::sqrt(1.5);
  CHECK(off(answer.samples[2].x, -speed * std::sin(3 - release)) < 1e-14);
  CHECK(off(answer.samples[2].y[0], 10 - speed * (3 - release) + speed * std::sin(3 - release)) < 1e-14);
}

TEST_CASE("energy is kept, and no order of the dampers changes anything") {
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed)
    for (Scene scene : {random_scene(seed), round_scene(seed)}) {
      CAPTURE(text_of(scene));
      const Answer a = answer_for(scene);
      if (!a.complete) continue;
      ++compared;
      Quad losses = 0;
      for (const Quad each : a.damper_loss) losses += each;
      const Quad all = a.initial.total() + a.turnover;
      CHECK(off(a.initial.total() + a.forcing_work, a.final.total() + losses + a.viscous_work) <=
            1e-20 * double(1 + all));
      for (const auto& each : a.samples)
        for (std::size_t n = 0; n < scene.dampers.size(); ++n) {
          CHECK(each.y[n] >= Quad(-1e-25L));
          CHECK(each.y[n] <= scene.dampers[n].clearance + Quad(1e-25L));
        }
      std::reverse(scene.dampers.begin(), scene.dampers.end());
      const Answer b = answer_for(scene);
      CHECK(a.samples.size() == 3);
      if (a.impacts.size() > 200) continue;  // else rounding may grow too far
      CHECK(a.impacts.size() == b.impacts.size());
      CHECK(off(a.samples[2].x, b.samples[2].x) < 1e-12);
    }
  CHECK(compared > 50);
}

TEST_CASE("scenes in which the engine was wrong once") {
  const auto agrees = [](Scene scene, const std::vector<SceneDamper>& dampers) {
    scene.until_time = 3;
    scene.damping_ratio = 0;
    scene.dampers = dampers;
    CAPTURE(text_of(scene));
    const Comparison result = compare(scene, {});
    CHECK(result.until == 3);
    CHECK(result.differences.size() == 0);
    if (!result.differences.empty()) MESSAGE(result.differences[0]);
  };
  Scene scene;
  // One that rests on the other wall takes part in an impact, and is not met by it.
  scene.x0 = 0;
  agrees(scene, {damper(2, 0, 0.5, 0.5, -1), damper(0.02, 0, 2, 2, 0)});
  // Those that leave a wall together from rest return to it together.
  scene.x0 = -0.5, scene.v0 = 1;
  agrees(scene, {damper(2, 1, 2, 2, 0), damper(2, 1, 2, 2, 0)});
  scene.x0 = 2.0356854212966793, scene.v0 = -4.7602761214230815;
  agrees(scene, {damper(0.0127, 1, 5, 0, 0), damper(0.0063, 0.5, 5, 0, 0)});
  // Chattering of one throws the other, which rests, off its wall: briefly if it is light.
  scene.x0 = 6, scene.v0 = 0;
  agrees(scene, {damper(1e-6, 0.6, 1, 1, 1e-4), damper(10, 0, 1, 1, 0)});
  agrees(scene, {damper(0.1, 0, 1, 1, 1e-3), damper(0.3, 0.7, 1, 1, 0)});
  agrees(scene, {damper(5, 0.9, 1, 1, 1e-5), damper(4, 0.1, 1, 1, 0)});
  scene.x0 = -0.5, scene.v0 = 1;
  // The return to the wall that a mass has left from rest, while another one flies.
  scene.x0 = -0.5, scene.v0 = 1;
  agrees(scene, {damper(2, 1, 2, 2, 0), damper(1, 0.25, 2, 0, 1)});
}
