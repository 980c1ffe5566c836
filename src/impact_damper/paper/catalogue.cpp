#include "impact_damper/paper/catalogue.hpp"

#include <algorithm>
#include <cstdint>

#include "impact_damper/files/json_reader.hpp"

namespace impact_damper {
namespace {

Record read_record(ObjectReader& scene) {
  Record record;
  record.half_cycles = false;
  bool history = false;
  std::vector<std::string> words;
  scene.required("record", words);
  for (const std::string& word : words) {
    if (word == "half_cycles") {
      record.half_cycles = true;
    } else if (word == "impacts") {
      record.impacts = true;
    } else if (word == "contacts") {
      record.contacts = true;
    } else if (word == "energy") {
      record.energy = true;
    } else if (word == "history") {
      history = true;
    } else {
      scene.refuse("record",
                   "must list half_cycles, impacts, contacts, energy or history, got \"" + word + "\"");
    }
  }
  for (ObjectReader item : scene.optional_objects("history_below")) {
    AmplitudeWindow window;
    item.required("amplitude", window.amplitude, above(0));
    item.required("length", window.length, above(0));
    item.required("count", window.count, within(2, 1e6));
    if (!record.history_below.empty() && !(window.amplitude < record.history_below.back().amplitude)) {
      item.refuse("amplitude", "must be below that of the window before");
    }
    record.history_below.push_back(window);
  }
  if (history == record.history_below.empty()) {
    scene.refuse("history_below", "must be given if, and only if, history is recorded");
  }
  return record;
}

std::vector<FigureCurve> read_curves(ObjectReader& figure, TableKind table) {
  std::vector<FigureCurve> curves;
  for (ObjectReader item : figure.optional_objects("curves")) {
    FigureCurve curve;
    item.required("scene", curve.scene);
    if (table == TableKind::loss_factor) {
      std::int64_t half_cycles = curve.loss_factor.half_cycles;
      item.optional("half_cycles", half_cycles, within(10, 18));
      if (half_cycles % 2 != 0)
        item.refuse("half_cycles", "must be even, so that one peak is the middle one");
      curve.loss_factor.half_cycles = static_cast<int>(half_cycles);
      item.optional("ensemble", curve.ensemble, within(0, 1000));
    }
    curves.push_back(curve);
  }
  return curves;
}

// A null pointer if `record` holds what a table of this kind draws, else the first part that is missing.
const char* missing_record(TableKind table, const Record& record) {
  switch (table) {
    case TableKind::motion:
      if (record.history_below.empty()) return "history";
      return record.half_cycles ? (record.impacts ? (record.contacts ? nullptr : "contacts") : "impacts")
                                : "half_cycles";
    case TableKind::decay:
    case TableKind::loss_factor:
      return record.half_cycles ? nullptr : "half_cycles";
    case TableKind::phase:
      return record.half_cycles ? (record.impacts ? (record.contacts ? nullptr : "contacts") : "impacts")
                                : "half_cycles";
    case TableKind::drawing:
      return nullptr;
  }
  return nullptr;
}

void check_curves(ObjectReader& item, const Figure& figure, const Catalogue& catalogue) {
  const std::size_t count = figure.curves.size();
  const bool single = figure.table == TableKind::motion || figure.table == TableKind::phase;
  if (single && count != 1) item.refuse("curves", "must be one curve for this kind of table");
  if (figure.table == TableKind::drawing && count != 0) item.refuse("curves", "must be empty for a drawing");
  if (figure.table != TableKind::drawing && count == 0) item.refuse("curves", "must be at least one curve");
  if ((count > 1) != figure.varied.has_value()) {
    item.refuse("varied", "must be given if, and only if, there are several curves");
  }
  for (const FigureCurve& curve : figure.curves) {
    const CatalogueScene* scene = find_scene(catalogue, curve.scene);
    if (!scene) {
      item.refuse("curves", "must draw scenes of this catalogue, got \"" + curve.scene + "\"");
      continue;
    }
    if (const char* missing = missing_record(figure.table, scene->record)) {
      item.refuse("curves", "needs \"" + std::string(missing) + "\" recorded of scene " + curve.scene);
    }
    const auto opens_window = [&](const AmplitudeWindow& window) {
      return window.amplitude == figure.window;
    };
    if (figure.window && std::ranges::none_of(scene->record.history_below, opens_window)) {
      item.refuse("window", "must be the amplitude of a history window of scene " + curve.scene);
    }
  }
}

Figure read_figure(ObjectReader& item, const Catalogue& catalogue) {
  Figure figure;
  item.required("figure", figure.number);
  item.required("title", figure.title);
  item.required(
      "table", figure.table,
      {TableKind::motion, TableKind::decay, TableKind::loss_factor, TableKind::phase, TableKind::drawing});
  if (item.has("varied")) {
    figure.varied = Varied::mass_ratio;
    item.required("varied", *figure.varied, {Varied::mass_ratio, Varied::damping_ratio, Varied::restitution});
  }
  figure.curves = read_curves(item, figure.table);
  if (figure.table == TableKind::loss_factor) {
    figure.ordinate = LossOrdinate::eta;
    item.required("ordinate", *figure.ordinate,
                  {LossOrdinate::eta, LossOrdinate::specific, LossOrdinate::specific_secondary,
                   LossOrdinate::amplitude_times, LossOrdinate::by_restitution});
    item.optional("range", figure.range, above(0));
    if (!figure.range.empty() && !(figure.range.size() == 2 && figure.range[0] < figure.range[1])) {
      item.refuse("range", "must be two amplitudes, the lower first");
    }
  }
  if (figure.table == TableKind::motion) item.required("window", figure.window, above(0));
  if (figure.table != TableKind::motion && figure.table != TableKind::drawing) {
    item.required("down_to", figure.down_to, above(0));
  }
  item.required("script", figure.script);
  item.optional("claims", figure.claims);
  if (find_figure(catalogue, figure.number)) item.refuse("figure", "must be given once");
  check_curves(item, figure, catalogue);
  return figure;
}

}  // namespace

std::string_view name_of(TableKind kind) {
  switch (kind) {
    case TableKind::motion:
      return "motion";
    case TableKind::decay:
      return "decay";
    case TableKind::loss_factor:
      return "loss_factor";
    case TableKind::phase:
      return "phase";
    case TableKind::drawing:
      return "drawing";
  }
  return "";
}

std::string_view name_of(LossOrdinate ordinate) {
  switch (ordinate) {
    case LossOrdinate::eta:
      return "eta";
    case LossOrdinate::specific:
      return "specific";
    case LossOrdinate::specific_secondary:
      return "specific_secondary";
    case LossOrdinate::amplitude_times:
      return "amplitude_times";
    case LossOrdinate::by_restitution:
      return "by_restitution";
  }
  return "";
}

std::string_view name_of(Varied varied) {
  switch (varied) {
    case Varied::mass_ratio:
      return "mass_ratio";
    case Varied::damping_ratio:
      return "damping_ratio";
    case Varied::restitution:
      return "restitution";
  }
  return "";
}

Catalogue read_catalogue(const std::filesystem::path& file) {
  JsonDocument document = JsonDocument::read(file);
  ObjectReader root = document.root();
  root.word("schema", {"impact-damper/catalogue/1"});
  root.require("schema");

  Catalogue catalogue;
  for (ObjectReader item : root.required_objects("scenes")) {
    CatalogueScene scene;
    item.required("scene", scene.name);
    if (find_scene(catalogue, scene.name)) item.refuse("scene", "must be given once");
    scene.record = read_record(item);
    catalogue.scenes.push_back(scene);
  }
  for (ObjectReader item : root.required_objects("figures")) {
    catalogue.figures.push_back(read_figure(item, catalogue));
  }
  for (const CatalogueScene& scene : catalogue.scenes) {
    const auto draws = [&](const Figure& figure) {
      return std::ranges::count(figure.curves, scene.name, &FigureCurve::scene) > 0;
    };
    if (std::ranges::none_of(catalogue.figures, draws)) {
      root.refuse("scenes", "must all be drawn by some figure, but " + scene.name + " is not");
    }
  }
  document.finish();
  return catalogue;
}

const CatalogueScene* find_scene(const Catalogue& catalogue, std::string_view name) {
  const auto found = std::ranges::find(catalogue.scenes, name, &CatalogueScene::name);
  return found == catalogue.scenes.end() ? nullptr : &*found;
}

const Figure* find_figure(const Catalogue& catalogue, std::string_view number) {
  const auto found = std::ranges::find(catalogue.figures, number, &Figure::number);
  return found == catalogue.figures.end() ? nullptr : &*found;
}

std::string file_stem(const Figure& figure) {
  const bool one_digit = figure.number.size() == 1 && figure.number[0] >= '0' && figure.number[0] <= '9';
  return (one_digit ? "fig0" : "fig") + figure.number;
}

std::vector<std::string> scenes_of(const Figure& figure) {
  std::vector<std::string> scenes;
  for (const FigureCurve& curve : figure.curves) {
    if (std::ranges::find(scenes, curve.scene) == scenes.end()) scenes.push_back(curve.scene);
  }
  return scenes;
}

}  // namespace impact_damper
