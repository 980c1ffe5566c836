// Simulates again what run and response files hold, by the library alone: the engines of another build are
// compared without compiling the whole program.
//
//   again < JOBS     each line: FILE TO SCENE WINDOW..., with tabs between
//
// Writes to TO what the scene, the engine and the sections of FILE give. SCENE is the scene file whose units
// TO has, or
// "-". The windows are those of --history, T0:T1:N, or of --history-below, below:A:LENGTH:N: FILE does not
// hold them.
#include <exception>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/responses/response_file.hpp"
#include "impact_damper/simulate.hpp"

namespace {

using namespace impact_damper;

void add_window(Record& record, const std::string& text) {
  std::istringstream words(text);
  const auto next = [&words] {
    std::string word;
    std::getline(words, word, ':');
    return word;
  };
  const bool below = text.starts_with("below:");
  if (below) next();
  const double first = parse_number(next()).value(), second = parse_number(next()).value();
  const std::int64_t count = parse_integer(next()).value();
  if (below)
    record.history_below.push_back({first, second, count});
  else
    record.history.push_back({first, second, count});
}

std::string again(const std::string& name, const std::string& text, const std::string& scene,
                  std::istream& windows) {
  if (text.find('"' + std::string(response_schema) + '"') != std::string::npos)
    return response_text(found_for(parse_response(name, text), Threads{}));
  const Run run = parse_run(name, text);
  Record record{.half_cycles = run.half_cycles.has_value(),
                .impacts = run.impacts.has_value(),
                .contacts = run.contacts.has_value(),
                .energy = run.energy.has_value(),
                .history = {},
                .history_below = {}};
  for (std::string window; std::getline(windows, window, '\t');) add_window(record, window);
  return run_text(simulate(run.scene, run.engine, record),
                  scene == "-" ? std::nullopt : read_scene_file(scene).scales);
}

}  // namespace

int main() {
  for (std::string line; std::getline(std::cin, line);) {
    try {
      std::istringstream words(line);
      std::string from, to, scene;
      std::getline(words, from, '\t');
      std::getline(words, to, '\t');
      std::getline(words, scene, '\t');
      std::ostringstream text;
      text << std::ifstream(from).rdbuf();
      write_file(to, again(from, text.str(), scene, words));
    } catch (const std::exception& error) {
      std::cerr << "again: " << line << ": " << error.what() << '\n';
      return 1;
    }
  }
}
