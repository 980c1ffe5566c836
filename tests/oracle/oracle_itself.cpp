// The oracle held against closed forms: it must be right before anything is held against it.
#include <doctest/doctest.h>

#include <cmath>

#include "oracle.hpp"
#include "print.hpp"

extern "C" {
oracle::Quad sinq(oracle::Quad);
oracle::Quad cosq(oracle::Quad);
oracle::Quad sqrtq(oracle::Quad);
oracle::Quad expq(oracle::Quad);
oracle::Quad acosq(oracle::Quad);
}

using namespace oracle;
using impact_damper::Scene;
using impact_damper::Wall;

namespace {

// Some hundred roundings of quadruple precision.
constexpr double closely = 1e-31;

double off(Quad value, Quad truth) {
  CAPTURE(text(value));
  CAPTURE(text(truth));
  return double(magnitude(value - truth) / (1 + magnitude(truth)));
}

Quad pi() { return acosq(-1); }

// Alone in the cavity: no impact before `end`.
Question flight(double end) {
  Question question;
  question.scene.x0 = 0.25;
  question.scene.v0 = 0.125;
  question.scene.damper().y0 = 0.5;
  question.scene.damper().w0 = -0.125;  // the secondary mass at rest
  question.scene.until_time = end;
  return question;
}

Quad residual(const Answer& answer) {
  Quad losses = answer.contact_loss + answer.chatter_loss + answer.viscous_work;
  for (const Impact& each : answer.impacts) losses += each.loss;
  return answer.initial.total() + answer.forcing_work - answer.final.total() - losses;
}

}  // namespace

TEST_CASE("an undamped flight is a cosine, with its crossings and peaks where they are known") {
  Question question = flight(40);
  question.scene.v0 = question.scene.damper().w0 = 0;
  question.samples = {0, 1, 17.5, 40};
  const Answer answer = answer_to(question);
  CHECK(answer.impacts.empty());
  REQUIRE(answer.samples.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    const Quad t = question.samples[i];
    CHECK(off(answer.samples[i].x, Quad(0.25) * cosq(t)) < closely);
    CHECK(off(answer.samples[i].v, -Quad(0.25) * sinq(t)) < closely);
    CHECK(off(answer.samples[i].y, Quad(0.75) - Quad(0.25) * cosq(t)) < closely);
    CHECK(off(answer.samples[i].w, Quad(0.25) * sinq(t)) < closely);
  }
  REQUIRE(answer.half_cycles.size() == 13);
  for (std::size_t i = 0; i < answer.half_cycles.size(); ++i) {
    CHECK(off(answer.half_cycles[i].zero_crossing, (Quad(2 * double(i) + 1) / 2) * pi()) < closely);
    CHECK(off(answer.half_cycles[i].peak_time, Quad(double(i)) * pi()) < closely);
    CHECK(off(answer.half_cycles[i].amplitude, 0.25) < closely);
  }
}

TEST_CASE("damped and forced flights are what their closed forms say, at any damping") {
  for (const double zeta : {0.1, 0.5, 1.5, 40.0}) {
    for (const double omega : {0.01, 1.0, 30.0}) {
      CAPTURE(zeta);
      CAPTURE(omega);
      Question question = flight(3);
      question.scene.damping_ratio = zeta;
      question.scene.force_amplitude = 0.01;
      question.scene.force_frequency = omega;
      question.samples = {0.7, 3};
      const Answer answer = answer_to(question);
      REQUIRE(answer.samples.size() == 2);
      REQUIRE(answer.impacts.empty());
      // The response of the force by undetermined coefficients, the rest by the two exponentials.
      const Quad z = zeta, w = omega, a = 1 - w * w, b = 2 * z * w, scale = Quad(0.01) / (a * a + b * b);
      const Quad s = scale * a, c = -scale * b;  // x_p = s sin + c cos
      const Quad x0 = Quad(0.25) - c, v0 = Quad(0.125) - s * w;
      for (std::size_t i = 0; i < 2; ++i) {
        const Quad t = question.samples[i];
        Quad x = s * sinq(w * t) + c * cosq(w * t);
        if (zeta < 1) {
          const Quad d = sqrtq(1 - z * z);
          x += expq(-z * t) * (x0 * cosq(d * t) + (v0 + z * x0) / d * sinq(d * t));
        } else {
          const Quad d = sqrtq(z * z - 1), p = -z + d, q = -z - d;
          x += ((v0 - q * x0) * expq(p * t) - (v0 - p * x0) * expq(q * t)) / (p - q);
        }
        CHECK(off(answer.samples[i].x, x) < 1e-29);  // steps of overdamped motion: some hundred
      }
      CHECK(double(magnitude(residual(answer))) < 1e-28);
    }
  }
}

TEST_CASE("a rigid wall gives back e times the relative velocity and keeps the momentum") {
  Question question;
  question.walls = Walls::rigid;
  Scene& scene = question.scene;
  scene.x0 = 0, scene.v0 = 0, scene.damper().y0 = 0.5, scene.damper().w0 = 2,
  scene.damper().mass_ratio = 0.25, scene.damper().restitution = 0.5;
  scene.until_time = 0.3;
  question.samples = {0.3};
  const Answer answer = answer_to(question);
  REQUIRE(answer.impacts.size() == 1);
  CHECK(off(answer.impacts[0].time, 0.25) < closely);
  CHECK(off(answer.impacts[0].relative_velocity, 2) < closely);
  CHECK(answer.impacts[0].wall == Wall::right);
  // v = nu (1 + e) w / (1 + nu) = 0.25 * 1.5 * 2 / 1.25, loss nu (1 - e^2) w^2 / (2 (1 + nu)) = 0.3.
  CHECK(off(answer.impacts[0].loss, Quad(3) / 10) < closely);
  const Quad v = Quad(3) / 5, t = Quad(0.3) - Quad(0.25);
  CHECK(off(answer.samples[0].x, v * sinq(t)) < closely);
  CHECK(off(answer.samples[0].y, 1 - t - (v * sinq(t) - v * t)) < closely);
}

TEST_CASE("a compliant wall that is held by a heavy primary mass gives back e, half a period later") {
  Question question;
  Scene& scene = question.scene;
  scene.x0 = 0, scene.damper().y0 = 0.5, scene.damper().w0 = 1, scene.damper().mass_ratio = 1e-30,
  scene.damper().restitution = 0.5;
  scene.damper().wall_stiffness = 1e-26;  // omega_m = 100
  scene.until_time = 1;
  question.samples = {1};
  const Answer answer = answer_to(question);
  REQUIRE(answer.contacts.size() == 1);
  const Quad l = -std::log(0.5L), ratio = double(l) / std::sqrt(M_PI * M_PI + double(l) * double(l));
  const Quad length = pi() / (100 * sqrtq(1 - ratio * ratio));
  CHECK(off(answer.contacts[0].begin, 0.5) < closely);
  CHECK(off(answer.contacts[0].end - answer.contacts[0].begin, length) < 1e-15);  // the ratio in double
  CHECK(off(answer.samples[0].w, -0.5) < 1e-27);  // the mass ratio itself moves the wall
}

TEST_CASE("a plastic impact sticks until the pair's acceleration changes its sign, under force") {
  // Both masses at rest at the right wall's impact: (1 + nu) x'' + x = f0 sin(omega t) from then on.
  Question question;
  question.walls = Walls::rigid;
  Scene& scene = question.scene;
  scene.x0 = 0, scene.damper().y0 = 0, scene.damper().restitution = 0, scene.damper().mass_ratio = 0.5;
  scene.force_amplitude = 1, scene.force_frequency = 0.5;
  scene.until_time = 10;
  question.samples = {0.5, 1};
  const Answer answer = answer_to(question);
  // Pressed at once: x = (f0 sin(omega t) - f0 (omega/s) sin(s t)) / (1 - (1+nu) omega^2), s^2 = 1/(1+nu).
  const Quad m = Quad(3) / 2, s = 1 / sqrtq(m), w = Quad(1) / 2, c = 1 / (1 - m * w * w);
  REQUIRE(!answer.contacts.empty());
  CHECK(answer.contacts[0].begin == 0);
  for (std::size_t i = 0; i < 2; ++i) {
    const Quad t = question.samples[i];
    CHECK(off(answer.samples[i].x, c * (sinq(w * t) - w / s * sinq(s * t))) < closely);
    CHECK(answer.samples[i].y == 0);
  }
  const Quad t = answer.contacts[0].end;
  CHECK(off(-w * w * sinq(w * t) + w * s * sinq(s * t), 0) < closely);
  CHECK(double(magnitude(residual(answer))) < 1e-28);
}

TEST_CASE("a complete chattering ends where the sum of its bounces does") {
  // A force of frequency 1e-9 is constant as long as this lasts, but for 1e-18 of it, and the primary mass
  // does not answer it if it is 1e9 times as heavy: the relative acceleration is -1 at first and falls with
  // x.
  Question question;
  question.walls = Walls::rigid;
  Scene& scene = question.scene;
  scene.x0 = -1, scene.damper().y0 = 0, scene.damper().w0 = 1e-6, scene.damper().mass_ratio = 1e-9,
  scene.damper().restitution = 0.5;
  scene.until_time = 1;
  const Answer answer = answer_to(question);
  REQUIRE(!answer.contacts.empty());
  // x'' = 1 - t^2/2 - ..: the first flight 2 w0, then each half as long: 4 w0 in all, to 1e-12 of itself.
  CHECK(double(magnitude(answer.contacts[0].begin / Quad(4e-6L) - 1)) < 1e-9);
  CHECK(double(magnitude(residual(answer))) < 1e-28);
}

TEST_CASE("a chattering whose bounces become slower than rounding is complete") {
  // What presses is zero at first: bounces of 1e-25 and less fill 1e-13.
  Question question;
  question.walls = Walls::rigid;
  Scene& scene = question.scene;
  scene.damper().mass_ratio = 0.1, scene.damper().restitution = 0.3702936918017719,
  scene.damping_ratio = 0.999999999999;
  scene.x0 = -2, scene.v0 = 1, scene.damper().y0 = 1, scene.force_amplitude = -0.5;
  scene.force_frequency = 33.166247903554, scene.until_time = 0.01;
  const Answer answer = answer_to(question);
  REQUIRE(answer.contacts.size() == 1);
  REQUIRE(answer.impacts.size() > 5);
  for (const Impact& each : answer.impacts)
    CHECK((each.accumulation && *each.accumulation == answer.contacts[0].begin));
}

TEST_CASE("the energy balance closes in decays with impacts, contacts, force and damping") {
  for (const Walls walls : {Walls::compliant, Walls::rigid}) {
    for (const double zeta : {0.0, 0.3, 3.0}) {
      for (const double force : {0.0, 1.0}) {
        Question question;
        question.walls = walls;
        question.scene.damping_ratio = zeta;
        question.scene.force_amplitude = force;
        question.scene.force_frequency = 0.7;
        question.scene.until_time = 12;
        question.most_steps = 4000;
        const Answer answer = answer_to(question);
        CAPTURE(zeta);
        CAPTURE(force);
        CHECK(answer.stop == Stop::time);
        CHECK(answer.impacts.size() >= 2);
        CHECK(double(magnitude(residual(answer)) / answer.initial.total()) < 1e-28);
      }
    }
  }
}

TEST_CASE("the mirrored scene has the mirrored run") {
  Question question, mirrored;
  question.scene.damper().y0 = 0.25;
  question.scene.damper().w0 = 0.5;
  question.scene.force_amplitude = 1;
  question.scene.until_time = 15;
  mirrored = question;
  mirrored.scene.x0 *= -1, mirrored.scene.damper().w0 *= -1, mirrored.scene.force_amplitude *= -1;
  mirrored.scene.damper().y0 = 0.75;
  const Answer a = answer_to(question), b = answer_to(mirrored);
  REQUIRE(a.impacts.size() == b.impacts.size());
  for (std::size_t i = 0; i < a.impacts.size(); ++i) {
    CHECK(off(a.impacts[i].time, b.impacts[i].time) < 1e-26);  // roundings, grown
    CHECK(a.impacts[i].wall != b.impacts[i].wall);
  }
}

TEST_CASE("roots are isolated, also where two lie close together or one at the end") {
  // (s - 1/2)^2 - d^2: two roots 2 d apart, none for the other sign; s = 1 belongs to the interval, s = 0
  // not.
  for (const double d : {1e-3, 1e-8, 1e-15}) {
    Polynomial p;
    p.degree = 2;
    p.at[0] = Quad(0.25) - Quad(d) * d, p.at[1] = -1, p.at[2] = 1;
    const auto roots = changes_of_sign(p);
    REQUIRE(roots.size() == 2);
    CHECK(double(magnitude(roots[1].s - roots[0].s - 2 * Quad(d))) < 1e-33 / d);  // as ill as it is
    CHECK(roots[0].direction == -1);
    p.at[0] = Quad(0.25) + Quad(d) * d;
    CHECK(changes_of_sign(p).empty());
  }
  Polynomial line;
  line.degree = 1;
  line.at[0] = -1, line.at[1] = 1;
  REQUIRE(changes_of_sign(line).size() == 1);
  CHECK(changes_of_sign(line)[0].s == 1);
  line.at[0] = 0;
  CHECK(changes_of_sign(line).empty());
}
