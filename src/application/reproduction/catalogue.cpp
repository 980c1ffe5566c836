#include "application/reproduction/catalogue.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#include "application/reproduction/scene_runs.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/json_reader.hpp"
#include "impact_damper/responses/response_fields.hpp"

namespace impact_damper {
namespace {

using Changes = std::map<std::string, double, std::less<>>;
Scene changed(const Changes& changes, Scene scene) {
  const auto change = [&](std::string_view name, auto& number) {
    if (const auto found = changes.find(name); found != changes.end()) number = found->second;
  };
  for (const SceneField& field : scene_fields) change(field.name, field.number.in(scene));
  change("until_time", scene.until_time);
  change("until_amplitude", scene.until_amplitude);
  return scene;
}

constexpr TextRule a_number{1, 8, true};           // of a figure
constexpr NumberRange amplitudes{0, 1e12, false};  // lengths of time too

// The parts of a run that a record names, beside its history; those that tables draw come first.
struct RecordPart {
  std::string_view name;
  bool Record::*is_recorded;
};
constexpr std::array<RecordPart, 4> record_parts{{{"half_cycles", &Record::half_cycles},
                                                  {"impacts", &Record::impacts},
                                                  {"contacts", &Record::contacts},
                                                  {"energy", &Record::energy}}};

// What a table draws: how many curves, and of each run so many of the first parts, and its history.
struct Drawn {
  TableKind table;
  enum Curves { none, one, some } curves = none;
  std::size_t parts = 0;
  bool history = false;
};
constexpr std::array<Drawn, 11> all_drawn{{{TableKind::motion, Drawn::one, 3, true},
                                           {TableKind::decay, Drawn::some, 1},
                                           {TableKind::loss_factor, Drawn::some, 1},
                                           {TableKind::phase, Drawn::one, 3},
                                           {TableKind::response},
                                           {TableKind::largest_response, Drawn::one, 1},
                                           {TableKind::response_map},
                                           {TableKind::design_charts},
                                           {TableKind::damper_sets, Drawn::some, 1},
                                           {TableKind::components, Drawn::some, 1},
                                           {TableKind::drawing}}};
static_assert(all_drawn.size() == all_of<TableKind>.size());
const Drawn& drawn_by(TableKind table) { return *std::ranges::find(all_drawn, table, &Drawn::table); }
// Whether the curves of such a table are runs of the catalogue, with their ensembles, between two amplitudes.
bool draws_runs(TableKind table) { return table == TableKind::damper_sets || table == TableKind::components; }

Record read_record(ObjectReader& scene) {
  Record record;
  record.half_cycles = false;
  bool history = false;
  std::vector<std::string> words;
  scene.required("record", words, TextRule{}, std::size_t{5});
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto* const part = std::ranges::find(record_parts, words[i], &RecordPart::name);
    if (part != record_parts.end())
      record.*part->is_recorded = true;
    else if (words[i] == "history")
      history = true;
    else
      scene.reject("record", i,
                   "must be one of half_cycles, impacts, contacts, energy, history, got the string " +
                       in_quotes(words[i]));
  }
  double before = std::numeric_limits<double>::infinity();
  for (ObjectReader item : scene.optional_objects("history_below", 100)) {
    AmplitudeWindow window;
    const bool is_read = item.required("amplitude", window.amplitude, amplitudes);
    item.required("length", window.length, amplitudes);
    item.required("count", window.count, within(2, double(most_samples)));
    if (is_read && !(window.amplitude < before))
      item.reject("amplitude", "must be below that of the window before, " + number_text(before) + ", got " +
                                   number_text(window.amplitude));
    if (is_read) before = window.amplitude;
    record.history_below.push_back(window);
  }
  if (history == record.history_below.empty()) {
    scene.reject("history_below", "must be given if, and only if, history is recorded");
  }
  return record;
}

std::vector<FigureCurve> read_curves(ObjectReader& figure, TableKind table) {
  std::vector<FigureCurve> curves;
  for (ObjectReader item : figure.optional_objects("curves", 100)) {
    FigureCurve curve;
    if (draws_runs(table)) {
      item.required("run", curve.run, a_name);
      if (table == TableKind::damper_sets) item.required("alone", curve.alone, a_name);
    } else {
      item.required("scene", curve.scene, a_name);
    }
    if (table == TableKind::loss_factor || table == TableKind::largest_response) {
      std::int64_t half_cycles = curve.loss_factor.half_cycles;
      item.optional("half_cycles", half_cycles, within(10, 18));
      if (half_cycles % 2 != 0) {
        item.reject("half_cycles",
                    "must be even, so that one peak is the middle one, got " + std::to_string(half_cycles));
      }
      curve.loss_factor.half_cycles = static_cast<int>(half_cycles);
      item.optional("ensemble", curve.ensemble, within(0, double(most_members)));
    }
    curves.push_back(curve);
  }
  return curves;
}

// Returns the first part that `record` lacks of what a table of this kind draws; empty if it has all.
std::string missing_record(TableKind table, const Record& record) {
  const Drawn& drawn = drawn_by(table);
  if (drawn.history && record.history_below.empty()) return "history";
  for (std::size_t i = 0; i < drawn.parts; ++i)
    if (!(record.*record_parts[i].is_recorded)) return std::string(record_parts[i].name);
  return "";
}

// Returns a null pointer if a table of this kind draws such a response, else a name of what it draws.
const char* wrong_response(TableKind table, const Response& asked) {
  const auto* const sweep = std::get_if<SweepResponse>(&asked);
  const auto* const basin = std::get_if<BasinResponse>(&asked);
  const auto* const orbits = std::get_if<OrbitsResponse>(&asked);
  if (table == TableKind::response)
    return (sweep && sweep->axis.number.is(&Scene::force_frequency)) ||
                   (orbits && orbits->range.parameter == Parameter::force_frequency)
               ? nullptr
               : "a sweep or orbits over force_frequency";
  if (table == TableKind::largest_response)
    return sweep && sweep->axis.number.is(&Scene::force_amplitude) ? nullptr : "a sweep over force_amplitude";
  return basin && basin->first.number.is(&Scene::force_frequency) &&
                 basin->second.number.is(&Scene::force_amplitude)
             ? nullptr
             : "a basin over force_frequency and force_amplitude, in this order";
}

void read_amplitudes(ObjectReader& item, std::vector<double>& range) {
  if (item.require("range") && item.optional("range", range, amplitudes) &&
      !(range.size() == 2 && range[0] < range[1]))
    item.reject("range", "must be two amplitudes, the lower first, got " +
                             (range.size() == 2 ? number_text(range[0]) + " and " + number_text(range[1])
                                                : std::to_string(range.size())));
}

void check_curves(ObjectReader& item, const Figure& figure, const Catalogue& catalogue) {
  const std::size_t count = figure.curves.size();
  const Drawn::Curves curves = drawn_by(figure.table).curves;
  const bool single = curves == Drawn::one, none = curves == Drawn::none;
  if (single ? count != 1 : none ? count != 0 : count == 0)
    item.reject("curves", "must be " +
                              std::string(single ? "one curve"
                                          : none ? "empty"
                                                 : "at least one curve") +
                              " with \"table\": " + in_quotes(name_of(figure.table)) + ", got " +
                              std::to_string(count));
  const bool runs = draws_runs(figure.table);
  if (!runs && (count > 1) != item.has("varied")) {
    item.reject("varied", "must be given if, and only if, there are several curves, got " +
                              std::string(count > 1 ? "none" : "it") + " for " + std::to_string(count));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const FigureCurve& curve = figure.curves[i];
    for (const std::string& name : {runs ? curve.run : curve.scene, curve.alone}) {
      if (name.empty()) continue;
      const CatalogueScene* const scene = find_scene(catalogue, name);
      const CatalogueRun* const run = find_run(catalogue.runs, name);
      if (runs ? !run : !scene) {
        item.reject("curves", i,
                    "must draw " + std::string(runs ? "runs" : "a scene") +
                        " of this catalogue, got the string " + in_quotes(name));
        continue;
      }
      const Record& record = runs ? run->record : scene->record;
      if (const std::string missing = missing_record(figure.table, record); !missing.empty())
        item.reject("curves", i,
                    "needs \"" + missing +
                        (runs ? "\" in the record of run " + name
                              : "\" in the scene's record, which " + name + " lacks"));
      const auto opens_window = [&](const AmplitudeWindow& window) {
        return window.amplitude == figure.window;
      };
      if (figure.window && std::ranges::none_of(record.history_below, opens_window))
        item.reject("window", "must be the amplitude of a history window of scene " + name + ", got " +
                                  number_text(*figure.window));
    }
  }
}

// Reads the responses that a figure draws: each must be known and of a kind that its table draws.
void read_responses(ObjectReader& item, Figure& figure, const Catalogue& catalogue) {
  const bool is_map = figure.table == TableKind::response_map;
  if (!is_map && figure.table != TableKind::response && figure.table != TableKind::largest_response) return;
  if (!item.required("responses", figure.responses, a_name, std::size_t{100})) return;
  if (figure.responses.empty() || (is_map && figure.responses.size() != 1))
    item.reject("responses", "must be " + std::string(is_map ? "one response" : "at least one response") +
                                 ", got " + std::to_string(figure.responses.size()));
  std::vector<double> forces;  // of sweeps over the frequency
  for (std::size_t i = 0; i < figure.responses.size(); ++i) {
    const CatalogueResponse* const response = find_response(catalogue.responses, figure.responses[i]);
    if (!response) {
      item.reject("responses", i,
                  "must be a response of this catalogue, got the string " + in_quotes(figure.responses[i]));
      continue;
    }
    if (const char* const wanted = wrong_response(figure.table, response->asked))
      item.reject("responses", i, "must be " + std::string(wanted) + ", got " + in_quotes(response->name));
    const double force = changed(response->set, Scene{}).force_amplitude;
    const bool is_sweep = std::holds_alternative<SweepResponse>(response->asked);
    if (figure.table == TableKind::response && !is_sweep && std::ranges::find(forces, force) == forces.end())
      item.reject("responses", i, "must come after a sweep with its force, got " + in_quotes(response->name));
    if (is_sweep) forces.push_back(force);
  }
}

// Reads changed numbers, each in its range; the engine checks them together with the scene's others.
Changes read_changes(ObjectReader item, std::vector<std::string_view> names) {
  Changes changes;
  for (const SceneField& field : scene_fields) names.push_back(field.name);
  for (const std::string_view name : names) {
    double value = 0;
    if (item.has(name) && item.optional(name, value)) changes.emplace(name, value);
  }
  Scene scene;
  scene.until_time = 1;  // a scene needs a stop
  for (const Problem& problem : problems_of(changed(changes, scene)))
    item.reject(problem.field, problem.message);
  return changes;
}

// Reads the name, which must be new, and the scene of a run or a response.
void read_names(ObjectReader& item, const Catalogue& catalogue, std::string& name, std::string& scene) {
  if (item.required("name", name, a_name) &&
      (find_run(catalogue.runs, name) || find_response(catalogue.responses, name) ||
       find_scene(catalogue, name)))
    item.reject("name",
                "must be given once among scenes, runs and responses, got the string " + in_quotes(name));
  item.required("scene", scene, a_name);
}
void check_scene(ObjectReader& item, const Catalogue& catalogue, const std::string& scene) {
  if (!scene.empty() && !find_scene(catalogue, scene))
    item.reject("scene", "must be a scene of this catalogue, got the string " + in_quotes(scene));
}

CatalogueRun read_run_entry(ObjectReader& item, const Catalogue& catalogue) {
  CatalogueRun run;
  read_names(item, catalogue, run.name, run.scene);
  if (const std::optional<ObjectReader> changes = item.optional_object("set"))
    run.set = read_changes(*changes, {"until_time", "until_amplitude"});
  if (std::optional<ObjectReader> engine = item.optional_object("engine"))
    run.engine = read_engine(*engine);
  else
    check_scene(item, catalogue, run.scene);
  run.record = read_record(item);
  return run;
}

std::vector<Axis> read_axes(ObjectReader& item, std::size_t count) {
  std::vector<Axis> axes;
  const std::vector<ObjectReader> entries = item.required_objects("vary", 2);
  if (entries.size() != count && item.has("vary"))
    item.reject("vary", "must be " + std::string(count == 1 ? "one number" : "two numbers") + ", got " +
                            std::to_string(entries.size()));
  for (ObjectReader entry : entries) {
    Axis axis;
    if (describe(JsonFields(entry), axis, Scene{})) axes.push_back(axis);
  }
  axes.resize(count);
  return axes;
}

// Reads a request without its scene.
void read_asked(ObjectReader& item, ObjectReader* rule, const std::vector<SceneState>& starts,
                SweepResponse& asked) {
  double nudge = 0;
  if (rule && rule->optional("nudge", nudge, nudges) && nudge > 0 && starts.empty())
    rule->reject("nudge", "must come with further starts");
  asked.axis = read_axes(item, 1)[0];
  if (is_initial_value(asked.axis.number))
    item.reject("vary", "must not vary an initial condition: a sweep goes on from the motion before");
  std::vector<SceneState> all{{}};  // first the scene's release, which is not known here
  all.insert(all.end(), starts.begin(), starts.end());
  for (const SweepStart& start : nudged(all, nudge)) asked.sweeps.push_back({start, {}, {}});
}
void read_asked(ObjectReader& item, ObjectReader*, const std::vector<SceneState>& starts,
                BasinResponse& asked) {
  const std::vector<Axis> axes = read_axes(item, 2);
  asked.first = axes[0];
  asked.second = axes[1];
  if (asked.first.number == asked.second.number) item.reject("vary", "must be two different numbers");
  if (asked.first.count * asked.second.count > most_rows)
    item.reject("vary", "must give at most " + std::to_string(most_rows) + " points, got " +
                            std::to_string(asked.first.count * asked.second.count));
  if (!starts.empty()) item.reject("start", "must not be given for a basin");
}
void read_asked(ObjectReader& item, ObjectReader*, const std::vector<SceneState>& starts,
                OrbitsResponse& asked) {
  std::vector<ObjectReader> entries = item.required_objects("vary", 2);
  if (entries.size() != 1 && item.has("vary"))
    item.reject("vary", "must be one number, got " + std::to_string(entries.size()));
  for (ObjectReader& entry : entries) describe(JsonFields(entry), asked.range);
  for (const SceneState& start : starts) asked.starts.push_back({{}, 0, {}, start});
}

CatalogueResponse read_response_entry(ObjectReader& item, const Catalogue& catalogue) {
  CatalogueResponse response;
  read_names(item, catalogue, response.name, response.scene);
  check_scene(item, catalogue, response.scene);
  if (const std::optional<ObjectReader> changes = item.optional_object("set"))
    response.set = read_changes(*changes, {});
  const std::array<Response, 3> kinds{SweepResponse{}, BasinResponse{}, OrbitsResponse{}};
  std::vector<std::string_view> words(kinds.size());
  std::ranges::transform(kinds, words.begin(), kind_of);
  const auto kind = item.require("kind") ? item.word("kind", words) : std::nullopt;
  if (!kind) {
    item.keys();  // what else is allowed depends on the kind
    return response;
  }
  response.asked = kinds[*kind];
  std::optional<ObjectReader> rule = item.optional_object("rule"), engine = item.optional_object("engine");
  std::vector<SceneState> starts;
  for (ObjectReader& start : item.optional_objects("start", 100))
    describe(JsonFields(start), starts.emplace_back(), Scene{});
  std::visit(
      [&](auto& asked) {
        if constexpr (!std::is_same_v<decltype(asked), LyapunovResponse&>) {
          if (rule) describe(JsonFields(*rule, true), asked.rule);
          read_asked(item, rule ? &*rule : nullptr, starts, asked);
        }
        if (!engine) return;
        if (const std::optional<Engine> read = read_engine(*engine)) asked.engine = *read;
        if (std::holds_alternative<Cem>(asked.engine))
          engine->reject("name", "must be exact or restitution, got cem");
      },
      response.asked);
  return response;
}

Figure read_figure(ObjectReader& item, const Catalogue& catalogue) {
  Figure figure;
  if (item.required("figure", figure.number, a_number) && find_figure(catalogue, figure.number))
    item.reject("figure", "must be given once, got the string " + in_quotes(figure.number));
  item.required("title", figure.title, some_text);
  if (item.required("script", figure.script, a_name) &&
      std::ranges::find(catalogue.figures, file_stem(figure), file_stem) != catalogue.figures.end()) {
    item.reject("script",
                "must differ from the scripts before it but for its ending, as tables and pictures have its "
                "name, got the string " +
                    in_quotes(figure.script));
  }
  item.optional("claims", figure.claims, a_name, 100);
  if (!item.required("table", figure.table)) {
    item.keys();  // which others are known depends on the table
    return figure;
  }
  if (!draws_runs(figure.table) && item.has("varied")) {
    figure.varied = Varied::mass_ratio;
    item.required("varied", *figure.varied);
  }
  if (figure.table == TableKind::design_charts) item.required("plan", figure.plan, a_name);
  figure.curves = read_curves(item, figure.table);
  read_responses(item, figure, catalogue);
  if (figure.table == TableKind::loss_factor) {
    figure.ordinate = LossOrdinate::eta;
    item.required("ordinate", *figure.ordinate);
    if (item.has("second_ordinate"))
      item.required("second_ordinate", figure.second_ordinate.emplace(LossOrdinate::eta));
    if (item.has("range")) read_amplitudes(item, figure.range);
  }
  if (draws_runs(figure.table)) read_amplitudes(item, figure.range);
  if (figure.table == TableKind::motion) item.required("window", figure.window.emplace(), amplitudes);
  if (figure.table != TableKind::motion && !draws_runs(figure.table) &&
      drawn_by(figure.table).curves != Drawn::none)
    item.required("down_to", figure.down_to.emplace(), amplitudes);
  check_curves(item, figure, catalogue);
  return figure;
}

Catalogue read_whole(JsonDocument document) {
  ObjectReader root = document.root();
  root.word("schema", {"impact-damper/catalogue/1"});
  root.require("schema");

  Catalogue catalogue;
  root.optional("members", catalogue.members, within(1, double(most_members)));
  for (ObjectReader item : root.required_objects("scenes", 1000)) {
    CatalogueScene scene;
    if (item.required("scene", scene.name, a_name) && find_scene(catalogue, scene.name))
      item.reject("scene", "must be given once, got the string " + in_quotes(scene.name));
    scene.record = read_record(item);
    catalogue.scenes.push_back(scene);
  }
  for (ObjectReader item : root.optional_objects("runs", 1000))
    catalogue.runs.push_back(read_run_entry(item, catalogue));
  for (ObjectReader item : root.optional_objects("responses", 1000))
    catalogue.responses.push_back(read_response_entry(item, catalogue));
  for (ObjectReader item : root.required_objects("figures", 1000)) {
    catalogue.figures.push_back(read_figure(item, catalogue));
  }
  document.finish();
  return catalogue;
}

template <class Entry>
const Entry* find_in(const std::vector<Entry>& entries, std::string_view name, std::string Entry::*key) {
  const auto found = std::ranges::find(entries, name, key);
  return found == entries.end() ? nullptr : &*found;
}

void add_if_new(std::vector<std::string>& names, const std::string& name) {
  if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
}

}  // namespace

Catalogue read_catalogue(const std::filesystem::path& file) {
  return read_whole(JsonDocument::read(file, catalogue_kind));
}
Catalogue parse_catalogue(const std::string& name, const std::string& text) {
  return read_whole(JsonDocument::parse(name, text));
}

const CatalogueScene* find_scene(const Catalogue& catalogue, std::string_view name) {
  return find_in(catalogue.scenes, name, &CatalogueScene::name);
}
const CatalogueRun* find_run(const std::vector<CatalogueRun>& runs, std::string_view name) {
  return find_in(runs, name, &CatalogueRun::name);
}
const CatalogueResponse* find_response(const std::vector<CatalogueResponse>& responses,
                                       std::string_view name) {
  return find_in(responses, name, &CatalogueResponse::name);
}
const Figure* find_figure(const Catalogue& catalogue, std::string_view number) {
  return find_in(catalogue.figures, number, &Figure::number);
}

Scene changed_scene(const CatalogueRun& run, Scene scene) { return changed(run.set, std::move(scene)); }

Response asked_for(const CatalogueResponse& response, const Scene& scene) {
  Response asked = response.asked;
  std::visit([&](auto& each) { each.scene = changed(response.set, scene); }, asked);
  if (auto* const sweeps = std::get_if<SweepResponse>(&asked))
    sweeps->sweeps.front().start = release_of(sweeps->scene);
  if (auto* const orbits = std::get_if<OrbitsResponse>(&asked))
    orbits->starts.insert(orbits->starts.begin(), {{}, 0, {}, release_of(orbits->scene)});
  return asked;
}

std::string file_stem(const Figure& figure) { return std::filesystem::path(figure.script).stem().string(); }

std::string sweep_stem(const Figure& figure) { return std::filesystem::path(figure.plan).stem().string(); }

std::vector<std::string> scenes_of(const Figure& figure) {
  std::vector<std::string> scenes;
  for (const FigureCurve& curve : figure.curves) add_if_new(scenes, curve.scene);
  return scenes;
}

std::vector<std::string> runs_of(const Figure& figure) {
  std::vector<std::string> runs;
  for (const FigureCurve& curve : figure.curves)
    for (const std::string& name : {curve.run, curve.alone}) add_if_new(runs, name);
  return runs;
}

}  // namespace impact_damper
