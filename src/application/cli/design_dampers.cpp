// `design --dampers`: finds several dampers for a range of amplitudes.
#include <algorithm>
#include <cmath>

#include "application/sweeps/damper_set_design.hpp"
#include "application/sweeps/lightest_design.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "scene_arguments.hpp"

namespace impact_damper::cli {
namespace {

struct Asked {
  SceneFile file;
  DamperSetQuestion question;
  double mass = 1;  // of the primary mass: kg, or 1
};

// Reads the only tolerances allowed, restitution=W and clearance=W%.
void read_tolerances(Arguments& arguments, DamperSetQuestion& question) {
  for (const std::string& text : arguments.texts("--tolerance")) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    std::string width = equals == std::string::npos ? "" : text.substr(equals + 1);
    const bool percent = width.ends_with('%');
    if (percent) width.pop_back();
    const auto value = parse_number(width);
    if (name == "restitution" && !percent && value && *value >= 0)
      question.restitution_off = *value;
    else if (name == "clearance" && percent && value && *value >= 0)
      question.clearance_off = *value / 100;
    else
      arguments.reject("--tolerance",
                       "must be restitution=W or clearance=W% with --dampers, got " + in_quotes(text));
  }
}

Asked asked_of(Arguments& arguments) {
  Asked asked;
  asked.file = scene_of(arguments, Stops::ignored);
  require_one_damper(asked.file.scene, scene_name_of(arguments));
  reject_options_beside_units(arguments, asked.file, "");
  for (const char* option : {"--within", "--share", "--clearance", "--neighbours", "--seed", "--write-plan"})
    if (arguments.given(option)) arguments.reject(option, "is not for several dampers, --dampers");
  for (const Option& option : engine_options())
    if (arguments.given(option.name))
      arguments.reject(option.name, "is not for --dampers, whose runs are those of the restitution engine");
  const Scene& scene = asked.file.scene;
  if (scene.force_amplitude != 0) arguments.reject("--dampers", "needs a free decay: the scene has a force");
  DamperSetQuestion& question = asked.question;
  const double length = scale_of(Dimension::length, asked.file.scales);
  asked.mass = scale_of(Dimension::mass, asked.file.scales);
  question.count = arguments.whole_number("--dampers", within(1, double(most_set_dampers))).value_or(1);
  question.release = arguments.number("--from", above(0)).value_or(std::abs(scene.x0) * length);
  if (question.release == 0 && !arguments.given("--from"))
    arguments.reject("--from", "must be given: the scene has no initial displacement");
  if (!arguments.given("--to")) arguments.reject("--to", "must be given");
  question.to = arguments.number("--to", above(0)).value_or(question.release / 10);
  question.upper = arguments.number("--upper", above(0)).value_or(0.9 * question.release);
  question.mass_ratio =
      arguments.number("--secondary-mass", above(0)).value_or(scene.damper().mass_ratio * asked.mass) /
      asked.mass;
  question.restitution = scene.damper().restitution;
  question.damping_ratio = scene.damping_ratio;
  read_tolerances(arguments, question);
  return asked;
}

// Returns the scene with these dampers as the text of its file, in units if the question was.
std::string scene_file_text(const Asked& asked, const DamperSet& set) {
  const DamperSetQuestion& question = asked.question;
  JsonWriter out("scene");
  out.open_object(JsonWriter::Layout::lines);
  out.field("description", filled("{} dampers for amplitudes from {} to {}", set.dampers.size(),
                                  readable(question.release), readable(question.to)));
  if (asked.file.in_units) {
    SceneInUnits scene = *asked.file.in_units;
    scene.dampers.clear();
    scene.initial_displacement = question.release;
    scene.initial_velocity.reset();
    scene.until_seconds.reset();
    scene.until_millimetres = question.to;
    for (const SceneDamper& damper : set.dampers) {
      DamperInUnits& each = scene.dampers.emplace_back();
      each.secondary_mass = in_three_digits(damper.mass_ratio * asked.mass);
      each.clearance = damper.clearance;
      each.restitution = damper.restitution;
    }
    write_unit_fields(out, scene);
  } else {
    Scene scene;
    scene.damping_ratio = question.damping_ratio;
    scene.x0 = question.release;
    scene.until_amplitude = question.to;
    scene.dampers = set.dampers;
    for (SceneDamper& damper : scene.dampers) damper.mass_ratio = in_three_digits(damper.mass_ratio);
    write_scene_fields(out, scene);
  }
  out.close();
  return out.finish() + '\n';
}

std::string text_of(const Asked& asked, const DamperSet& set) {
  const DamperSetQuestion& question = asked.question;
  const bool in_units = asked.file.in_units.has_value();
  const std::string length = in_units ? " mm" : "", mass = in_units ? " kg" : "";
  const auto least = [](const std::vector<double>& values) { return *std::ranges::min_element(values); };
  std::string text = filled("released from {}{}, {}{} together, restitution {} +-{}, clearances +-{} %\n\n",
                            readable(question.release), length, readable(question.mass_ratio * asked.mass),
                            mass, readable(question.restitution), readable(question.restitution_off),
                            readable(100 * question.clearance_off));
  Rows rows{{"damper", "clearance", "mass"}, {"", in_units ? "mm" : "", in_units ? "kg" : ""}};
  for (std::size_t j = 0; j < set.dampers.size(); ++j)
    rows.push_back({std::to_string(j + 1), number_text(set.dampers[j].clearance),
                    readable(set.dampers[j].mass_ratio * asked.mass)});
  text += aligned(rows) + "\n";
  rows = {{"amplitude", "loss factor", "", "dampers that are off", "", ""},
          {in_units ? "mm" : "", "if they add", "run", "each at its worst, if they add", "mean",
           filled("least of {}", set_draws)}};
  for (std::size_t i = 0; i + 1 < set.edges.size(); ++i)
    rows.push_back({readable(std::sqrt(set.edges[i] * set.edges[i + 1])), readable(set.expected[i]),
                    readable(set.run.mean[i]), readable(set.worst[i]), readable(set.varied.mean[i]),
                    readable(set.varied.low[i])});
  text += aligned(rows) + "\n";
  text += filled(
      "From {} to {}{} the loss factor is {} or more, by the mean of {} releases; of {} sets whose "
      "dampers are off by their mean {} or more, in the worst of them {}.\n",
      readable(set.edges.front()), readable(set.edges.back()), length, readable(least(set.run.mean)),
      set_releases, set_draws, readable(least(set.varied.mean)), readable(least(set.varied.low)));
  if (set.one)
    text += filled(
        "One damper of that mass, designed in the same way, has a clearance of {}{} and a loss "
        "factor of {} or more.\n",
        readable(set.one->clearance), length, readable(set.one->least));
  const auto without_mass = question.count - std::int64_t(set.dampers.size());
  if (without_mass > 0) text += filled("Of {} clearances {} got no mass.\n", question.count, without_mass);
  return text;
}

}  // namespace

int design_dampers(Arguments& arguments) {
  const Asked asked = asked_of(arguments);
  const Threads threads = threads_of(arguments);
  const auto output = output_of(arguments, "--output", {Format::json}, {scene_name_of(arguments)});
  arguments.finish();
  if (const auto problems = problems_of(asked.question); !problems.empty())
    reject_as_options(problems, {{"release", "--from"},
                                 {"upper", "--upper"},
                                 {"to", "--to"},
                                 {"mass_ratio", "--secondary-mass"},
                                 {"count", "--dampers"},
                                 {"clearance_off", "--tolerance"},
                                 {"restitution_off", "--tolerance"}});
  prepare_output(output);
  DamperSet set;
  {
    ProgressOnStderr progress("design");
    set = best_damper_set(asked.question, threads, std::ref(progress));
  }
  if (output) write_output(output, scene_file_text(asked, set));
  if (!is_standard_output(output)) write_standard_output(text_of(asked, set));
  return 0;
}

}  // namespace impact_damper::cli
