#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "stress.hpp"

namespace stress {
namespace {

std::string printed(const char* format, int digits, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, digits, value);
  return text;
}

std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

std::string rounded(double value, int digits) { return printed("%.*g", digits, value); }
std::string full(double value) { return printed("%.*g", 17, value); }

std::string markdown(const std::vector<Check>& checks) {
  std::string text = "| subject | what | cases | worst | allowed | misses |\n|---|---|---|---|---|---|\n";
  for (const Check& check : checks) {
    text += "| " + check.subject + " | " + cell(check.what) + " | " + std::to_string(check.cases) + " | " +
            cell(check.measured) + " | " + cell(check.allowed) + " | " +
            (check.missed == 0 ? "none" : "**" + std::to_string(check.missed) + "**") + " |\n";
  }
  for (const Check& check : checks) {
    if (check.missed == 0) continue;
    text += "\nMissed: " + check.subject + ", " + check.what + "\n\n";
    for (const std::string& miss : check.misses) text += "    " + miss + "\n";
    if (check.misses.size() < static_cast<std::size_t>(check.missed)) text += "    ...\n";
  }
  return text;
}

std::string json(const std::vector<Check>& checks) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const Check& check : checks)
    all.push_back({{"subject", check.subject},
                   {"what", check.what},
                   {"cases", check.cases},
                   {"measured", check.measured},
                   {"allowed", check.allowed},
                   {"missed", check.missed},
                   {"misses", check.misses}});
  return nlohmann::ordered_json{{"schema", "impact-damper/stress/1"}, {"checks", all}}.dump(1) + "\n";
}

double seconds() {
  static const auto start = std::chrono::steady_clock::now();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void Progress::tell(std::int64_t done, std::int64_t all, const std::string& more) {
  const double now = seconds();
  if (last_ < 0) last_ = now;
  if (now - last_ < 2) return;
  last_ = now;
  std::fprintf(stderr, "stress: %s: %lld of %lld%s%s\n", what_.c_str(), static_cast<long long>(done),
               static_cast<long long>(all), more.empty() ? "" : ", ", more.c_str());
}

}  // namespace stress
