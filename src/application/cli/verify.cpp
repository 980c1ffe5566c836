// `verify`: checks the claims, one by one, against the runs.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "application/reproduction/catalogue.hpp"
#include "application/reproduction/claims.hpp"
#include "application/reproduction/measures.hpp"
#include "application/reproduction/power.hpp"
#include "application/reproduction/scene_runs.hpp"
#include "commands.hpp"
#include "impact_damper/io/json_writer.hpp"

namespace impact_damper::cli {
namespace {

namespace fs = std::filesystem;
using Layout = JsonWriter::Layout;

struct Verified {
  const Claim* claim;
  Spread ours;
  NamedSpreads also{};  // the further numbers that the templates show
  std::string words{};  // our result in the statement's terms
  Verdict verdict = Verdict::not_reproduced;
  Verdict recorded = Verdict::reproduced;
  bool as_recorded() const { return verdict == recorded; }
  // Returns one of the claim's templates, filled with what was measured.
  std::string with_numbers(const std::string& text) const {
    NamedSpreads spreads = also;
    spreads[""] = ours;
    return in_words(text, spreads);
  }
};

std::string allowed_text(const Claim& claim) { return allowed_in_words(claim.words, claim.allowed); }

// The texts in the columns of an open statement.
constexpr const char *not_measured = "not measured", *open_word = "open";

std::string table_text(const std::vector<Verified>& all, const std::vector<OpenStatement>& open) {
  Rows rows{{"claim", "paper", "allowed", "ours (median, extremes of the ensemble)", "verdict"}};
  for (const Verified& each : all)
    rows.push_back({each.claim->id, each.claim->printed, allowed_text(*each.claim), each.words,
                    std::string(name_of(each.verdict)) +
                        (each.as_recorded() ? "" : " <-- recorded: " + std::string(name_of(each.recorded)))});
  for (const OpenStatement& each : open)
    rows.push_back({each.id, each.printed, not_measured, not_measured, open_word});
  return aligned(rows);
}

std::string open_text(const std::vector<OpenStatement>& open) {
  if (open.empty()) return "";
  return filled("; besides, {} {} open", open.size(),
                open.size() == 1 ? "statement of the paper is" : "statements of the paper are");
}

std::string summary_text(const std::vector<Verified>& all, const std::vector<OpenStatement>& open) {
  const auto of_source = [&](Source source, std::string_view what, std::initializer_list<Verdict> verdicts) {
    const auto count = [&](auto is_counted) {
      return std::to_string(std::ranges::count_if(all, is_counted));
    };
    const auto is_of_it = [&](const Verified& each) { return each.claim->source == source; };
    if (source != Source::paper && std::ranges::none_of(all, is_of_it)) return std::string();
    std::string text = count(is_of_it) + std::string(what);
    for (const Verdict verdict : verdicts)
      text += (verdict == *verdicts.begin() ? ": " : ", ") +
              count([&](const Verified& each) { return is_of_it(each) && each.verdict == verdict; }) + " " +
              std::string(verdict == Verdict::holds           ? "hold"
                          : verdict == Verdict::does_not_hold ? "do not hold"
                                                              : name_of(verdict));
    return text + "; ";
  };
  const auto changed = std::ranges::count(all, false, &Verified::as_recorded);
  return of_source(Source::paper, " claims of the paper",
                   {Verdict::reproduced, Verdict::not_reproduced, Verdict::corrected, Verdict::derived}) +
         of_source(Source::quoted, " of studies that it quotes",
                   {Verdict::reproduced, Verdict::not_reproduced}) +
         of_source(Source::ours, " of ours", {Verdict::holds, Verdict::does_not_hold}) +
         (changed == 0 ? "all as recorded" : filled("{} not as recorded", changed)) + open_text(open) + "\n";
}

std::string markdown_text(const std::vector<Verified>& all, const std::vector<OpenStatement>& open,
                          const std::string& engine) {
  Rows rows{{"id", "section", "claim", "paper", "ours", "allowed", "because", "verdict"}};
  for (const Verified& each : all) {
    const Claim& claim = *each.claim;
    rows.push_back({claim.id, claim.section, claim.statement, claim.printed, each.words, allowed_text(claim),
                    claim.allowed.reason, std::string(name_of(each.verdict))});
  }
  for (const OpenStatement& each : open)
    rows.push_back({each.id, each.section, each.statement, each.printed, not_measured, not_measured,
                    each.explanation, open_word});
  std::string text = markdown_table(rows) + "\n" + summary_text(all, open);
  for (const Verified& each : all) {
    const auto otherwise = each.claim->with_engine.find(engine);
    if (otherwise != each.claim->with_engine.end())
      text += filled("\n**{}** ({}, {}). {}\n", each.claim->id, engine, name_of(each.verdict),
                     each.with_numbers(otherwise->second.explanation));
    if (each.claim->explanation.empty()) continue;
    text +=
        filled("\n**{}** ({}). {}{}\n", each.claim->id, name_of(each.verdict),
               each.with_numbers(each.claim->explanation),
               each.claim->evidence.empty() ? "" : " Evidence: " + each.with_numbers(each.claim->evidence));
  }
  return text;
}

// Writes a number that is not finite as null.
void write(JsonWriter& out, const Spread& spread) {
  const auto number = [](double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; };
  out.fields("ours", number(spread.median), "low", number(spread.low), "high", number(spread.high));
}

std::string verdicts_text(const std::vector<Verified>& all, const std::vector<OpenStatement>& open) {
  JsonWriter out("table");
  out.open_object(Layout::one_line);
  out.field("schema", "impact-damper/verdicts/1");
  out.new_line();
  out.objects("verdicts", Layout::lines, all, [&](const Verified& each) {
    out.field("claim", each.claim->id);
    write(out, each.ours);
    if (!each.also.empty()) out.open_object("also", Layout::one_line);
    for (const auto& [name, spread] : each.also) {
      out.open_object(name, Layout::one_line);
      write(out, spread);
      out.close();
    }
    if (!each.also.empty()) out.close();
    out.fields("words", each.words, "verdict", name_of(each.verdict), "recorded", name_of(each.recorded));
  });
  if (!open.empty()) {
    out.new_line();
    out.field("open", texts_of(open, &OpenStatement::id));
  }
  out.close();
  return out.finish() + '\n';
}

// The names of what claims rest on: runs of scenes, further runs, whose scenes' runs are among them if they
// are the catalogue's, and responses.
struct RunNames {
  std::set<std::string> scenes, further, responses;
};
RunNames runs_of(const std::vector<Claim>& claims, const Catalogue& catalogue) {
  RunNames names;
  const auto add = [&](const MeasureCall& call) {
    for (const std::string& name : call.scenes) {
      const CatalogueRun* const run = find_run(catalogue.runs, name);
      if (run) names.further.insert(name);
      if (!run || find_scene(catalogue, run->scene)) names.scenes.insert(run ? run->scene : name);
    }
    names.responses.insert(call.responses.begin(), call.responses.end());
  };
  for (const Claim& claim : claims) {
    add(claim.measure);
    for (const auto& [name, call] : claim.also) add(call);
  }
  return names;
}

// Rejects figures that rest on a claim that does not exist.
void check_figures(const std::vector<Figure>& figures, const fs::path& file,
                   const std::vector<Claim>& claims) {
  std::set<std::string> ids;
  for (const Claim& claim : claims) ids.insert(claim.id);
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::vector<std::string>& rests_on = figures[i].claims;
    for (std::size_t j = 0; j < rests_on.size(); ++j) {
      if (ids.contains(rests_on[j])) continue;
      problems.push_back({filled("/figures/{}/claims/{}", i, j),
                          "must be the id of a claim, got the string " + in_quotes(rests_on[j])});
    }
  }
  if (!problems.empty()) throw InputError(file.string(), problems);
}

// Checks every run and response that a claim rests on, before anything is measured: consistent, of its scene,
// and the runs of scenes all of one engine. Returns the responses.
std::map<std::string, Response> checked(const SceneRuns& folders, const RunNames& names,
                                        const Catalogue& catalogue) {
  std::optional<Run> first;
  for (const std::string& scene : names.scenes) {
    Run run = folders.read(scene);
    if (first)
      require_same_engine(run, folders.file_of(scene), *first, folders.file_of(*names.scenes.begin()));
    if (!first) first = std::move(run);
  }
  for (const std::string& name : names.further) folders.read(*find_run(catalogue.runs, name));
  std::map<std::string, Response> responses;
  for (const std::string& name : names.responses) {
    const CatalogueResponse* const asked = find_response(catalogue.responses, name);
    if (!asked)
      throw InvalidArguments({{"--claims", "must name responses of the catalogue, got " + in_quotes(name)}});
    responses[name] = folders.read(*asked);
  }
  return responses;
}

// What --power finds.
struct PowerTable {
  std::string engine;
  std::int64_t members = 0;
  std::size_t claims = 0;
  std::int64_t ensembles = 0;          // other ensembles that verdicts were compared with
  std::vector<std::string> unsettled;  // claims whose verdicts differ there, which are left out
  std::vector<PowerRow> rows;
};

// Returns "7.1 %, to 0.0214"; for a number that is 0 "to 0.0214".
std::string found_text(const PowerNumber& number, const std::optional<Direction>& direction) {
  if (!direction) return "-";
  if (!direction->turn) return "none up to " + rounded_text(direction->searched_to.value, 4);
  const Trial& trial = direction->turn->trial;
  std::string to = "to " + rounded_text(trial.value, 4);
  if (number.value == 0) return to;
  return (trial.change >= 1 ? "a factor of " + rounded_text(1 + trial.change, 2)
                            : rounded_text(100 * trial.change, 2) + " %") +
         ", " + to;
}

// Returns the first of the claims that turn, at most `most`, and how many more there are.
std::string claims_text(const std::optional<Direction>& direction, std::size_t most) {
  if (!direction || !direction->turn) return "";
  std::vector<std::string> claims = direction->turn->claims;
  const std::size_t all = claims.size();
  claims.resize(std::min(all, most));
  return joined(claims, ", ") + (all > most ? filled(" and {} more", all - most) : "");
}

bool turns_some(const PowerRow& row) { return (row.up && row.up->turn) || (row.down && row.down->turn); }

std::string summary_text(const PowerTable& table) {
  const auto some = std::ranges::count_if(table.rows, turns_some);
  return filled("{} numbers, {} claims, {}ensembles of {}: {} numbers turn a verdict, {} turn none\n",
                table.rows.size(), table.claims, table.engine.empty() ? "" : "engine " + table.engine + ", ",
                table.members, some, table.rows.size() - static_cast<std::size_t>(some));
}

void write(JsonWriter& out, std::string_view name, const std::optional<Direction>& direction) {
  if (!direction) return;
  out.new_line();
  out.open_object(name, Layout::one_line);
  out.field("searched_to", direction->searched_to.value);
  if (const auto& turn = direction->turn)
    out.fields("change", turn->trial.change, "value", turn->trial.value, "claims", turn->claims);
  out.close();
}

// Returns the cells of a row, with at most so many claims in each.
std::vector<std::string> cells_of(const PowerRow& row, std::size_t most_claims) {
  return {row.number.of,
          row.number.name,
          rounded_text(row.number.value, 4),
          found_text(row.number, row.up),
          claims_text(row.up, most_claims),
          found_text(row.number, row.down),
          claims_text(row.down, most_claims)};
}

// Returns the rows of `of`; empty for those of all scenes, with a column that names the scene.
std::string markdown_rows(const PowerTable& table, std::string_view of) {
  Rows rows{{"scene", "number", "is", "smallest increase", "turns", "smallest decrease", "turns"}};
  for (const PowerRow& row : table.rows) {
    const bool of_scene = row.number.of != "analysis" && row.number.of != "columns";
    if (of.empty() ? of_scene : row.number.of == of) rows.push_back(cells_of(row, 3));
  }
  if (!of.empty())
    for (auto& row : rows) row.erase(row.begin());
  return markdown_table(rows);
}

// Returns the numbers that no claim notices, by the test that does.
std::string unnoticed_rows(const PowerTable& table) {
  std::map<std::string_view, std::string> numbers;
  for (const PowerRow& row : table.rows) {
    if (turns_some(row)) continue;
    std::string& text = numbers[row.number.noticed_by];
    text.append(text.empty() ? "" : ", ").append(row.number.of + " " + row.number.name);
  }
  Rows rows{{"test", "notices"}};
  for (const auto& [test, text] : numbers) rows.push_back({std::string(test), text});
  return markdown_table(rows);
}

std::string table_text(const PowerTable& table) {
  Rows rows{{"of", "number", "is", "increase", "turns", "decrease", "turns"}};
  for (const PowerRow& row : table.rows) rows.push_back(cells_of(row, 2));
  const std::string left_out =
      table.unsettled.empty()
          ? ""
          : filled("left out, as other ensembles turn them: {}\n", joined(table.unsettled, ", "));
  return aligned(rows) + "\n" + left_out + summary_text(table);
}

std::string json_text(const PowerTable& table) {
  JsonWriter out("table");
  out.open_object(Layout::one_line);
  out.field("schema", "impact-damper/power/1");
  out.new_line();
  out.fields("engine", table.engine, "members", table.members, "claims", std::int64_t(table.claims),
             "other_ensembles", table.ensembles);
  out.new_line();
  out.field("unsettled", table.unsettled);
  out.new_line();
  out.objects("numbers", Layout::lines, table.rows, [&](const PowerRow& row) {
    out.fields("of", row.number.of, "name", row.number.name, "value", row.number.value);
    write(out, "up", row.up);
    write(out, "down", row.down);
    out.new_line();
    out.field("noticed_by", row.number.noticed_by);
  });
  out.close();
  return out.finish() + '\n';
}

std::string markdown_text(const PowerTable& table) {
  std::string text = R"(# How little turns a verdict

Made by `impact-damper verify --power --markdown` from [data/claims.json](../data/claims.json), all digits in
[power.json](power.json). For each number of the scenes, of the analysis and of what runs record: the smallest
change, all other numbers as they are, that turns at least one verdict of [claims.md](claims.md), and the claims that it
turns.

- A number becomes larger by so many percent, or is divided by as much: 50 % is times 1.5 or divided by 1.5. One that
  is 0 becomes what is given.
- A scene's number is changed as if its file were wrong: the simulation and the analysis both get the changed one.
  What runs record is multiplied in every run that a measure looks at. Sweeps under a force are made from their first
  start only.
- Medians of chaotic decays do not depend on a number monotonically. Changes of 0.1, 0.2, 0.5, 1, 2, 5 ... percent are
  tried until a verdict turns, and bisection over changes of two digits narrows the interval before it. The change
  given turns a verdict, and the next smaller one of two digits turns none; that no smaller change does is not
  proved. Whole numbers are tried one by one; their change is a
  percentage of what they are.
- A small change means that the claims hold the number tightly, *none* that they do not know it. The paper's words
  decide that, not the program: two percent of a momentum are below any digit that it prints.
)";
  text +=
      filled("- Left out, because at least one of {} other ensembles turns them without any change: {}.\n\n",
             table.ensembles, table.unsettled.empty() ? "none" : joined(table.unsettled, ", "));
  text += summary_text(table);
  text += "\n## Scenes\n\n" + markdown_rows(table, "");
  text += "\n## Analysis\n\n" + markdown_rows(table, "analysis");
  text += "\n## What runs record\n\nTimes a factor of 1.\n\n" + markdown_rows(table, "columns");
  text +=
      "\n## What no claim notices\n\nSuch a number is not in the paper, or the paper says that it does not "
      "matter, or its effect is gone before anything that\nis judged. A test of the project notices a "
      "change of it:\n\n" +
      unnoticed_rows(table);
  return text;
}

// Finds, instead of the verdicts, which changes of a number turn one.
int find_power(const SceneRuns& folders, std::vector<Claim> claims, const std::set<std::string>& scenes,
               const Catalogue& catalogue, std::map<std::string, Response> responses,
               const EnsembleOptions& ensemble, const std::optional<std::string>& json_file,
               const std::optional<std::string>& markdown_file) {
  PowerInput input{.claims = claims_on_scenes_of(catalogue, std::move(claims)),
                   .runs = {},
                   .further = catalogue.runs,
                   .asked = catalogue.responses,
                   .responses = std::move(responses),
                   .ensemble = ensemble,
                   .left_out = {}};
  for (const std::string& scene : scenes) input.runs[scene] = folders.read(scene);
  PowerTable table;
  if (!input.runs.empty()) table.engine = name_of(input.runs.begin()->second.engine);
  table.members = ensemble.members;
  table.claims = input.claims.size();
  table.ensembles = 20;
  table.unsettled = input.left_out = unsettled_claims(input, table.ensembles);
  const Power power(std::move(input));
  if_interrupted_say("no table is made" + (json_file ? "; " + left_as_it_was(*json_file) : ""));
  {
    ProgressOnStderr progress("verify");
    table.rows = power.table([&](std::size_t done, std::size_t searches) {
      progress(filled("{} of {} searches", done, searches));
    });
  }
  if (json_file) write_output(json_file, json_text(table));
  if (markdown_file) write_output(markdown_file, markdown_text(table));
  if (!is_standard_output(json_file) && !is_standard_output(markdown_file))
    write_standard_output(table_text(table));
  return 0;
}

int verify(Arguments& arguments) {
  EnsembleOptions ensemble;
  arguments.read("--members", ensemble.members, within(1, double(most_members)));
  ensemble.threads = threads_of(arguments);
  const fs::path claims_file = arguments.file("--claims").value_or(project_file("data/claims.json")),
                 runs_folder = arguments.file("--runs").value_or(project_file("build/runs/exact"));
  const SceneRuns folders{runs_folder, scenes_folder(arguments)};
  const std::string catalogue_file =
      arguments.file("--catalogue").value_or(project_file("figures/catalogue.json"));
  const auto verdicts_file = arguments.file("--output"), markdown_file = arguments.file("--markdown");
  const bool power = arguments.flag("--power");
  reject_same_output(arguments, "--markdown", markdown_file, "--output", verdicts_file);
  arguments.finish();

  const ClaimsFile read = read_claims(claims_file);
  const std::vector<Claim>& claims = read.claims;
  // Without a catalogue there are no further runs.
  const bool has_catalogue = arguments.given("--catalogue") || fs::exists(catalogue_file);
  const Catalogue catalogue = has_catalogue ? read_catalogue(catalogue_file) : Catalogue{};
  if (arguments.given("--catalogue")) check_figures(catalogue.figures, catalogue_file, claims);
  const RunNames names = runs_of(claims, catalogue);
  std::vector<fs::path> inputs{claims_file};
  if (has_catalogue) inputs.emplace_back(catalogue_file);
  for (const std::set<std::string>* list : {&names.scenes, &names.further})
    for (const std::string& name : *list) add_ensemble(inputs, folders.file_of(name));
  for (const std::string& name : names.responses) inputs.push_back(folders.file_of(name));
  reject_other_endings(arguments, "--output", verdicts_file, {Format::json});
  reject_other_endings(arguments, "--markdown", markdown_file, {Format::markdown});
  arguments.reject_overwriting("--output", verdicts_file, inputs);
  arguments.reject_overwriting("--markdown", markdown_file, inputs);
  arguments.finish();
  for (const auto& file : {markdown_file, verdicts_file}) prepare_output(file);

  std::map<std::string, Response> responses = checked(folders, names, catalogue);
  if (power)
    return find_power(folders, claims, names.scenes, catalogue, std::move(responses), ensemble, verdicts_file,
                      markdown_file);
  Runs runs(runs_folder, ensemble, catalogue.runs);
  for (auto& [name, response] : responses) runs.put(name, std::move(response));
  std::vector<Verified> all;
  ProgressOnStderr progress("verify");
  for (const Claim& claim : claims) {
    if_interrupted_say(filled("{} of {} claims are left{}", claims.size() - all.size(), claims.size(),
                              verdicts_file ? "; " + left_as_it_was(*verdicts_file) : ""));
    progress(filled("{} of {} claims, now {}", all.size(), claims.size(), claim.id));
    try {
      Verified& verified = all.emplace_back(Verified{.claim = &claim, .ours = measure(runs, claim.measure)});
      for (const auto& [name, call] : claim.also) verified.also[name] = measure(runs, call);
      verified.words = verified.with_numbers(claim.words);
      verified.verdict = judge(claim, verified.ours.median);
    } catch (const InvalidArguments& error) {
      std::vector<Problem> problems = error.problems();
      for (Problem& problem : problems) problem.field = filled("claim {}: {}", claim.id, problem.field);
      throw InvalidArguments(problems);
    } catch (const std::invalid_argument& problem) {
      throw InvalidArguments({{"claim " + claim.id, problem.what()}});
    }
  }
  const std::string engine = runs.engine();
  for (Verified& each : all) each.recorded = recorded_for(*each.claim, engine);
  if (verdicts_file) write_output(verdicts_file, verdicts_text(all, read.open));
  if (markdown_file) write_output(markdown_file, markdown_text(all, read.open, engine));
  if (!is_standard_output(verdicts_file) && !is_standard_output(markdown_file))
    write_standard_output(table_text(all, read.open) + "\n" +
                          (engine.empty() ? "" : "engine " + engine + ", ") + summary_text(all, read.open));
  return std::ranges::all_of(all, &Verified::as_recorded) ? 0 : 1;
}

}  // namespace

Command verify_command() {
  return {
      .name = "verify",
      .description = "Hold the runs against everything the paper reports, claim by claim.",
      .options = {input_option("--claims", "FILE", "what the paper reports; default data/claims.json"),
                  input_option(
                      "--runs", "FOLDER",
                      "folder of run files, NAME.json of each scene, further run and\nresponse, with the "
                      "other members of its ensemble (run --members);\ndefault build/runs/exact"),
                  scenes_option(),
                  flag_option("--power",
                              "instead of the verdicts, the smallest change of each\nnumber that turns one "
                              "of them (minutes)"),
                  input_option("--catalogue", "FILE",
                               "lists the further runs; default figures/catalogue.json. If given, "
                               "the\nclaims that its figures rest on must exist"),
                  {"--members", "N",
                   "use the first N of each ensemble, the run file itself among them;\n1 to 100, default 16; "
                   "--power simulates them"},
                  {"-o,--output", "FILE", "write the verdicts, or with --power the changes, as JSON"},
                  {"--markdown", "FILE", "write the table, with every explanation, as Markdown"},
                  threads_option()},
      .footer =
          R"(Prints one line for each claim: what the paper prints, what is allowed, what comes out here (median
and extremes over an ensemble of perturbed initial conditions), and the verdict on the median:
reproduced, not reproduced, corrected, or derived where it cannot fail. Claims that are ours and not
the paper's hold or do not hold, and are counted apart. Exit code 1 if a verdict differs from the
recorded one, either way. A run that was altered, contradicts itself or is of another scene or engine
than the others is rejected.

With --power: one line for each number of the scenes, of the analysis and of what runs record, with the
smallest change of it that turns a verdict, and the claims that it turns.

Examples:
  impact-damper verify
  impact-damper verify --power --markdown power.md
  impact-damper verify --runs build/runs/cem --members 1 --markdown verdicts.md)",
      .act = verify};
}

}  // namespace impact_damper::cli
