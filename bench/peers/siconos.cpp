// Siconos, on rigid walls: Moreau and Jean's time stepping, and its event-driven simulation with LSODAR.
//
// All masses are one Lagrangian system of absolute positions (x, z1, z2, ...) with two unilateral constraints
// for each secondary mass, z - x >= 0 and c - z + x >= 0, and Newton's impact law. Between the steps or
// events that Siconos delivers x is harmonic where nothing damps or forces it, so its largest value follows
// from x and x' at hand: the peaks cost the peer no accuracy.
#include "peers/siconos.hpp"

#include <SiconosKernel.hpp>
#include <cmath>
#include <memory>

#include "rows.hpp"

namespace impact_damper::bench {
namespace {

struct Model {
  SP::LagrangianLinearTIDS masses;
  SP::NonSmoothDynamicalSystem system;

  explicit Model(const SiconosScene& scene) {
    const unsigned n = unsigned(scene.dampers.size());
    auto position = std::make_shared<SiconosVector>(1 + n), velocity = std::make_shared<SiconosVector>(1 + n);
    auto mass = std::make_shared<SimpleMatrix>(1 + n, 1 + n),
         stiffness = std::make_shared<SimpleMatrix>(1 + n, 1 + n),
         damping = std::make_shared<SimpleMatrix>(1 + n, 1 + n);
    (*position)(0) = scene.x0;
    (*velocity)(0) = scene.v0;
    (*mass)(0, 0) = 1;
    (*stiffness)(0, 0) = 1;
    (*damping)(0, 0) = 2 * scene.damping_ratio;
    for (unsigned i = 0; i < n; ++i) {
      (*position)(1 + i) = scene.x0 + scene.dampers[i].y0;
      (*velocity)(1 + i) = scene.v0 + scene.dampers[i].w0;
      (*mass)(1 + i, 1 + i) = scene.dampers[i].mass_ratio;
    }
    masses = std::make_shared<LagrangianLinearTIDS>(position, velocity, mass, stiffness, damping);

    system = std::make_shared<NonSmoothDynamicalSystem>(0, scene.until_time + 1);
    system->insertDynamicalSystem(masses);
    for (unsigned i = 0; i < n; ++i) {
      for (const double side : {1.0, -1.0}) {
        auto direction = std::make_shared<SimpleMatrix>(1, 1 + n);
        (*direction)(0, 0) = -side;
        (*direction)(0, 1 + i) = side;
        auto offset = std::make_shared<SiconosVector>(1);
        (*offset)(0) = side > 0 ? 0 : scene.dampers[i].clearance;
        auto law = std::make_shared<NewtonImpactNSL>(scene.dampers[i].restitution);
        auto relation = std::make_shared<LagrangianLinearTIR>(direction, offset);
        system->link(std::make_shared<Interaction>(law, relation), masses);
      }
    }
  }
};

// From one state to the next, whose interval no impact interrupts.
class Watch {
 public:
  explicit Watch(const SiconosScene& scene) : rows_(scene.x0), x_(scene.x0), v_(scene.v0) {}

  void look(double time, double x, double v) {
    if (v_ * v < 0 || v == 0) {
      const bool nearer = std::abs(v_) < std::abs(v);
      rows_.peak(time, nearer ? std::hypot(x_, v_) : std::hypot(x, v));
    }
    if ((x_ > 0) != (x > 0)) rows_.zero_crossing(time_ + (time - time_) * x_ / (x_ - x));
    time_ = time;
    x_ = x;
    v_ = v;
  }
  // After an impact: x' has jumped.
  void jump(double x, double v) {
    rows_.peak(time_, x);
    rows_.impact();
    x_ = x;
    v_ = v;
  }
  Rows finish() { return rows_.finish(); }

 private:
  RowBook rows_;
  double time_ = 0, x_, v_;
};

}  // namespace

Rows siconos_moreau_jean(const SiconosScene& scene, double h) {
  Model model(scene);
  auto clock = std::make_shared<TimeDiscretisation>(0, h);
  auto integrator = std::make_shared<MoreauJeanOSI>(0.5);
  auto impacts = std::make_shared<LCP>();
  const auto simulation = std::make_shared<TimeStepping>(model.system, clock, integrator, impacts);
  Watch watch(scene);
  while (simulation->nextTime() <= scene.until_time) {
    simulation->computeOneStep();
    watch.look(simulation->nextTime(), (*model.masses->q())(0), (*model.masses->velocity())(0));
    simulation->nextStep();
  }
  return watch.finish();
}

Rows siconos_event_driven(const SiconosScene& scene, double bounce_tolerance, double tolerance) {
  Model model(scene);
  auto clock = std::make_shared<TimeDiscretisation>(0, 0.1);
  auto integrator = std::make_shared<LsodarOSI>();
  const auto simulation = std::make_shared<EventDriven>(model.system, clock);
  simulation->insertIntegrator(integrator);
  simulation->associate(integrator, model.masses);
  simulation->insertNonSmoothProblem(std::make_shared<LCP>(), SICONOS_OSNSP_ED_IMPACT);
  simulation->insertNonSmoothProblem(std::make_shared<LCP>(), SICONOS_OSNSP_ED_SMOOTH_ACC);
  simulation->setPrintStat(false);
  simulation->setToleranceED(bounce_tolerance);
  simulation->initialize();
  integrator->setMaxNstep(100000);
  integrator->setTol(1, tolerance, tolerance);
  Watch watch(scene);
  while (simulation->hasNextEvent() && simulation->nextTime() <= scene.until_time) {
    simulation->advanceToEvent();
    const bool impact = simulation->eventsManager()->nextEvent()->getType() == 2;
    watch.look(simulation->nextTime(), (*model.masses->q())(0), (*model.masses->velocity())(0));
    simulation->processEvents();
    if (impact) watch.jump((*model.masses->q())(0), (*model.masses->velocity())(0));
  }
  return watch.finish();
}

}  // namespace impact_damper::bench
