// The Python module: a scene in, a run of numpy arrays out, through the interface for C.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/c_interface.h"
#include "impact_damper/scene.hpp"
#include "impact_damper/units.hpp"

namespace py = pybind11;

namespace {

// What a Run holds besides its attributes. The capsule owns the run; each array keeps it alive.
struct Run {
  std::optional<py::capsule> run;  // absent in an unpickled Run
  std::string text;                // of an unpickled Run only
};

std::string text_of(const Run& run) {
  if (!run.run) return run.text;
  struct Free {
    void operator()(char* text) const { std::free(text); }
  };
  const std::unique_ptr<char, Free> text(impact_damper_run_text(run.run->get_pointer<impact_damper_run>()));
  if (!text) throw std::bad_alloc();
  return text.get();
}

// The JSON text of keyword arguments or options. A value that JSON cannot hold becomes a string; the reader
// then rejects it by its name, together with everything else that is not valid.
std::string json_of(const py::dict& object) {
  py::dict plain;
  for (const auto& [name, given] : object) {
    const bool is_of_numpy = py::hasattr(given, "tolist");
    const py::object value = is_of_numpy ? given.attr("tolist")() : py::reinterpret_borrow<py::object>(given);
    const bool is_finite = !PyFloat_Check(value.ptr()) || std::isfinite(PyFloat_AsDouble(value.ptr()));
    plain[name] = is_finite ? value : py::str(value);
  }
  const py::object to_text = py::module_::import("builtins").attr("str");
  return py::module_::import("json").attr("dumps")(plain, py::arg("default") = to_text).cast<std::string>();
}

std::optional<impact_damper_window> window_of(const py::object& history) {
  if (history.is_none()) return {};
  try {
    const auto [begin, end, count] = history.cast<std::tuple<double, double, std::size_t>>();
    return impact_damper_window{begin, end, count};
  } catch (const py::cast_error&) {
    throw py::value_error("history: must be (begin, end, count), got " +
                          py::repr(history).cast<std::string>());
  }
}

// Problems of a scene by the names of the arguments: "x0: must be ..." for "scene: /x0: must be ...".
std::string by_argument(std::string problems) {
  const std::string_view pointer = "scene: /";
  for (std::size_t line = 0; line != std::string::npos;) {
    if (problems.compare(line, pointer.size(), pointer) == 0) problems.erase(line, pointer.size());
    const std::size_t end = problems.find('\n', line);
    line = end == std::string::npos ? end : end + 1;
  }
  return problems;
}

// All columns and numbers of the run: "energy/initial/total" is attributes["energy"]["initial"]["total"].
py::dict attributes_of(const py::capsule& owner) {
  const auto* const run = owner.get_pointer<impact_damper_run>();
  py::dict attributes;
  attributes["stop_reason"] = impact_damper_stop_reason(run);
  int stands_alone = 0;
  std::size_t index = 0;
  while (const char* const name = impact_damper_column_name(run, index++, &stands_alone)) {
    py::dict place = attributes;
    std::string_view rest = name;
    for (std::size_t slash = 0; (slash = rest.find('/')) != std::string_view::npos;
         rest.remove_prefix(slash + 1))
      place = place.attr("setdefault")(py::str(rest.substr(0, slash)), py::dict());
    std::size_t rows = 0;
    const double* const values = impact_damper_column(run, name, &rows);
    if (stands_alone == 1) {
      place[py::str(rest)] = *values;
    } else {
      const py::array_t<double> column(static_cast<py::ssize_t>(rows), values, owner);
      column.attr("flags").attr("writeable") = false;
      place[py::str(rest)] = column;
    }
  }
  return attributes;
}

py::object run(const py::object& engine, const py::object& history, const py::kwargs& scene) {
  const std::string engine_text =
      py::isinstance<py::dict>(engine) ? json_of(engine) : py::str(engine).cast<std::string>();
  const std::string scene_text = json_of(scene);
  const std::optional<impact_damper_window> window = window_of(history);
  std::string error(1 << 14, '\0');
  impact_damper_run* run = nullptr;
  impact_damper_status status{};
  {
    const py::gil_scoped_release others_may_run;
    status = impact_damper_simulate(scene_text.c_str(), engine_text.c_str(), window ? &*window : nullptr,
                                    &run, error.data(), error.size());
  }
  error.resize(error.find('\0'));
  switch (status) {
    case IMPACT_DAMPER_DONE:
      break;
    case IMPACT_DAMPER_INVALID:
      throw py::value_error(by_argument(error));
    case IMPACT_DAMPER_NUMERICAL_FAILURE:
      PyErr_SetString(PyExc_ArithmeticError, error.c_str());
      throw py::error_already_set();
    case IMPACT_DAMPER_OUT_OF_MEMORY:
      throw std::bad_alloc();
  }
  const py::capsule owner(
      run, [](void* pointer) { impact_damper_free(static_cast<impact_damper_run*>(pointer)); });
  py::object result = py::cast(Run{owner, {}});
  result.attr("__dict__").attr("update")(attributes_of(owner));
  return result;
}

constexpr const char* doc_of_run_class =
    R"(What became of a scene, under the names of a run file. Each column is a one-dimensional, read-only
numpy array of float64, a view into the run; an absent number is nan. All is dimensionless: lengths are divided by
the clearance epsilon, times by 1/Omega_n = sqrt(M/K), velocities by epsilon Omega_n, energies by K epsilon^2.

stop_reason   time, amplitude, or the budget that ended the run early
end_time      when it ended
half_cycles   one row from each zero crossing of x to the next, the first from the release: zero_crossing (its end),
              peak_time, amplitude, impacts (their number)
impacts       time, wall (0 left, 1 right), relative_velocity (just before), phase_deg (in the half cycle, degrees;
              nan before the first zero crossing and after the last), amplitude (of the half cycle), displacement (x)
contacts      begin, end, wall: each contact with a wall, short or stuck
energy        initial and final energy, impact_loss (of each impact), its sum impact_loss_total, contact_loss,
              bounce_downs and bounce_down_loss, viscous_work, forcing_work, residual (of the balance); with
              friction, weight or drag also friction_loss and drag_loss
history       time, x, v, y, w, only if it was asked for: displacement and velocity of the primary mass; distance of
              the secondary mass from the left wall, and its velocity in the cavity
units         only of a scene in units: what one unit of length, time, velocity, mass, force and energy is in SI)";

// The names of the scene's numbers, out of their own tables.
std::string doc_of_run() {
  using impact_damper::number_text;
  std::string text = R"(Simulates a scene and returns its Run.

engine        exact, restitution or cem with its default options, or a dict with options as in a run file's
              "engine", such as {"name": "cem", "time_step": 1e-4, "locate": True}
history       (begin, end, count): records the motion at count >= 2 equally spaced times, both ends included,
              0 <= begin < end, divided by 1/Omega_n also for a scene in units
all others    the scene, by the keys of a scene file: **json.load(open("scene.json")) is a scene, too

Raises ValueError with a line for each argument that is not valid, and ArithmeticError where the engine fails or
this process's arithmetic has been changed. Other threads run meanwhile; Ctrl-C takes effect when the run has ended,
with default options after a second or two at most.

Dimensionless: lengths divided by the clearance epsilon, times by 1/Omega_n = sqrt(M/K), velocities by
epsilon Omega_n, forces by K epsilon.
)";
  const auto add = [&](std::string_view name, const std::string& meaning) {
    text += "\n" + std::string(name) + std::string(name.size() < 23 ? 23 - name.size() : 1, ' ') + meaning;
  };
  const impact_damper::Scene defaults;
  for (const impact_damper::SceneField& field : impact_damper::scene_fields)
    add(field.name, std::string(field.meaning) + "; default " + number_text(field.number.in(defaults)));
  add("until_time", "stop at this time");
  add("until_amplitude",
      "stop at the end of the first half cycle below it; one of the two must be given, or both");
  add("dampers", "several: a list of dicts of the numbers of one, and clearance; what a\n" +
                     std::string(24, ' ') +
                     R"(run has of each is history["dampers"]["1"]["y"] and so on, from 1)");
  add("wall", "the law of both walls, for the engine cem, a dict of what follows; default linear");
  add("spring", "that of the primary spring; the same");
  add("law", "power or table of a wall, cubic or table of a spring");
  add("exponent", "of a power of the overlap; of a wall");
  add("cubic", "c of the force x + c x^3; of a scene in units in N/mm^3");
  add("pairs", "a table: [[overlap or displacement, force], ...], increasing");
  add("file", "a CSV file with such a table");
  add("speed", "at which a wall with a law has the restitution");
  text +=
      "\n\nIn units. mass, stiffness or natural_frequency, secondary_mass and clearance must be given; what else\nis "
      "left out is 0 or as above, "
      "exciting_frequency that of\n"
      "the primary system by itself. The Run is dimensionless, history as well:\n";
  for (const impact_damper::UnitField& field : impact_damper::unit_fields) {
    const std::string unit(unit_of(field.dimension, true));
    add(field.name, std::string(field.meaning) + (unit.empty() ? "" : "; in " + unit));
  }
  return text;
}

}  // namespace

PYBIND11_MODULE(impact_damper, module) {
  module.doc() = "The impact damped harmonic oscillator: impact_damper.run(mass_ratio=0.05, until_time=100)";
  module.attr("__version__") = VERSION;
  py::class_<Run>(module, "Run", py::dynamic_attr(), doc_of_run_class)
      .def("text", &text_of, "The whole run file, as the program writes it: JSON, with its provenance.")
      .def("__repr__",
           [](const py::object& self) {
             return py::str("impact_damper.Run(stop_reason={!r}, end_time={!r})")
                 .format(self.attr("stop_reason"), self.attr("end_time"));
           })
      .def(py::pickle(
          [](const py::object& self) {
            return py::make_tuple(self.attr("__dict__"), text_of(self.cast<const Run&>()));
          },
          [](const py::tuple& state) {
            return std::make_pair(Run{{}, state[1].cast<std::string>()}, state[0].cast<py::dict>());
          }));
  module.def("run", &run, doc_of_run().c_str(), py::kw_only(), py::arg("engine") = "exact",
             py::arg("history") = py::none());
}
