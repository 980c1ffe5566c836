// The other integrator that references are held against.
#ifdef HAVE_FLOAT128
#include <boost/multiprecision/float128.hpp>
#endif

#include "contender.hpp"
#include "peers/odeint.hpp"

#ifdef HAVE_FLOAT128
// What odeint's norms are made of; it knows by itself only of built-in numbers and of containers.
template <>
struct boost::numeric::odeint::detail::extract_value_type<boost::multiprecision::float128> {
  using type = boost::multiprecision::float128;
};
#endif

namespace impact_damper::bench {

std::optional<std::vector<double>> independent_amplitudes(const Scene& scene, Walls walls) {
  if (!has_one_damper(scene)) return std::nullopt;
#ifdef HAVE_FLOAT128
  using Real = boost::multiprecision::float128;
#else
  using Real = long double;
#endif
  const Real tolerance = std::max(Real(1e-20), 8 * std::numeric_limits<Real>::epsilon());
  return OdeintRun<HybridSystem<Real>, Fehlberg>(scene, walls, tolerance).run().amplitude;
}

}  // namespace impact_damper::bench
