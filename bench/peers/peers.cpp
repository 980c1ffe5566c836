#include <stdexcept>
#include <utility>

#include "contender.hpp"

#ifdef HAVE_SICONOS
#include "peers/siconos.hpp"
#endif

namespace impact_damper::bench {

#ifdef HAVE_SICONOS
namespace {

SiconosScene siconos_scene(const Scene& scene) {
  if (!scene.until_time || scene.force_amplitude != 0) throw std::invalid_argument("not a scene for Siconos");
  SiconosScene same{scene.damping_ratio, scene.x0, scene.v0, *scene.until_time, {}};
  for (const SceneDamper& d : scene.dampers)
    same.dampers.push_back({d.mass_ratio, d.restitution, d.clearance, d.y0, d.w0});
  if (has_one_damper(scene))
    same.dampers = {
        {scene.damper().mass_ratio, scene.damper().restitution, 1, scene.damper().y0, scene.damper().w0}};
  return same;
}

}  // namespace

std::vector<Contender> siconos_peers() {
  // Pairs of tolerances, found by trial, that bring the event-driven simulation through a bounce-down; most
  // others do not.
  static constexpr std::pair<double, double> working[] = {{1e-4, 1e-8}, {1e-5, 1e-10}, {1e-6, 1e-11}};
  return {{"Siconos Moreau-Jean", Walls::rigid, "time step",
           [](const Scene&) { return geometric(1.0 / 64, 0.5, 8); },
           [](const Scene& scene, double step) { return siconos_moreau_jean(siconos_scene(scene), step); },
           "time stepping, theta = 1/2, impacts by LCP; Siconos", true},
          {"Siconos event-driven", Walls::rigid, "tolerance",
           [](const Scene& scene) {
             std::vector<double> tolerances;
             if (scene.dampers.size() >= 100) return tolerances;  // a run takes a minute
             for (const auto& pair : working) tolerances.push_back(pair.second);
             return tolerances;
           },
           [](const Scene& scene, double tolerance) {
             for (const auto& [bounce, lsodar] : working) {
               if (lsodar == tolerance) return siconos_event_driven(siconos_scene(scene), bounce, lsodar);
             }
             throw std::invalid_argument("no bounce tolerance is known to work with this");
           },
           "LSODAR with root-finding, impacts by LCP; Siconos", true}};
}
#endif

std::vector<Contender> peers() {
  std::vector<Contender> all;
  const auto add = [&](std::vector<Contender> more) {
    for (Contender& contender : more) all.push_back(std::move(contender));
  };
#ifdef HAVE_ODEINT
  add(odeint_peers());
#endif
#ifdef HAVE_SUNDIALS
  add(cvode_peers());
  add(arkode_peers());
#endif
#ifdef HAVE_SICONOS
  add(siconos_peers());
#endif
  add(central_differences_peers());
  return all;
}

std::vector<std::string> missing_peers() {
  std::vector<std::string> missing;
#ifndef HAVE_ODEINT
  missing.push_back("Boost.odeint (libboost-dev)");
#endif
#ifndef HAVE_SUNDIALS
  missing.push_back("SUNDIALS (libsundials-dev)");
#endif
#ifndef HAVE_SICONOS
  missing.push_back("Siconos (libsiconos-kernel-dev, libsiconos-numerics-dev)");
#endif
  return missing;
}

#ifndef HAVE_ODEINT
std::optional<std::vector<double>> independent_amplitudes(const Scene&, Walls) { return std::nullopt; }
#endif

}  // namespace impact_damper::bench
