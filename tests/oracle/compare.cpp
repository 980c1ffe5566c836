#include "compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>

#include "impact_damper/simulate.hpp"
#include "print.hpp"

namespace oracle {
namespace {

using namespace impact_damper;
using impact_damper::Energy;

// What an engine is off by in one operation, relative to the numbers in it; a size of noise at which growth
// is still to be linear; and up to which predicted error, relative to its size, a number is compared.
struct Accuracy {
  double rounding, noise, predictable, operations;
  bool by_steps = false;
};
constexpr Accuracy closed_forms{0x1p-53, 4 * 0x1p-53, 1e-7, operations};
// Central differences with a hundred steps for each contact or period: (2 pi / 200)^2 / 24 and more.
constexpr Accuracy central_differences{1e-5, 1e-5, 1e-2, 3, true};
// The first step is a hundredth of half a contact, as the engine's own default is; it is divided by these
// where that is not short enough, and each of them by 4 for the order.
constexpr std::array<double, 3> finer_steps{1, 4, 16};
double first_step(const Scene& scene) {
  const double contact = std::sqrt(scene.damper().mass_ratio /
                                   (scene.damper().wall_stiffness * (1 + scene.damper().mass_ratio)));
  const double shortest =
      std::min({contact, 1.0, scene.force_amplitude != 0 ? 1 / scene.force_frequency : 1.0});
  return std::numbers::pi / 100 * shortest;
}

constexpr int samples_of_a_run = 65;

// As the engines' recorder places them.
std::vector<double> sample_times(double end) {
  std::vector<double> times;
  for (int i = 0; i < samples_of_a_run; ++i)
    times.push_back(i + 1 < samples_of_a_run ? double(i) / (samples_of_a_run - 1) * end : end);
  return times;
}

// What has a growth of its own.
enum Kind { time_, peak_time_, x_, v_, y_, w_, loss_, kinds_ };

// The events of an answer or of a run, in one form.
struct Events {
  std::vector<oracle::Impact> impacts;
  std::vector<Contact> contacts;
  std::vector<HalfCycle> rows;
  std::vector<bool> merged;  // rows that were three
};

Events events_of(const Answer& answer) { return {answer.impacts, answer.contacts, answer.half_cycles, {}}; }
Events events_of(const Run& run) {
  Events events;
  for (std::size_t i = 0; i < run.impacts->time.size(); ++i)
    events.impacts.push_back({run.impacts->time[i],
                              run.impacts->wall[i],
                              run.impacts->relative_velocity[i],
                              run.energy->impact_loss[i],
                              run.impacts->displacement[i],
                              {}});
  for (std::size_t i = 0; i < run.contacts->begin.size(); ++i)
    events.contacts.push_back({run.contacts->begin[i], run.contacts->end[i], run.contacts->wall[i]});
  for (std::size_t i = 0; i < run.half_cycles->amplitude.size(); ++i)
    events.rows.push_back(
        {run.half_cycles->zero_crossing[i], run.half_cycles->peak_time[i], run.half_cycles->amplitude[i]});
  return events;
}

// Below these nothing can be said of an event: it is there or not by rounding.
struct Negligible {
  std::function<Quad(Quad)> duration, speed, length;
};

// Where events coincide, rounding decides whether a contact of no length is recorded, whether one is cut in
// two by a touch, and whether a touch of x = 0 is two crossings or none: all such are taken out.
void simplify(Events& events, const Negligible& below) {
  std::vector<Contact> contacts;
  for (const Contact& each : events.contacts) {
    if (!contacts.empty() && contacts.back().wall == each.wall &&
        each.begin - contacts.back().end <= below.duration(each.begin)) {
      contacts.back().end = each.end;
      continue;
    }
    contacts.push_back(each);
  }
  std::erase_if(contacts,
                [&](const Contact& each) { return each.end - each.begin <= below.duration(each.begin); });
  events.contacts = contacts;
  std::vector<HalfCycle> rows;
  std::vector<bool> merged;
  for (std::size_t i = 0; i < events.rows.size(); ++i) {
    const HalfCycle& each = events.rows[i];
    // Not the first row: how small it is is exactly known.
    const Quad length = i > 0 ? each.zero_crossing - events.rows[i - 1].zero_crossing : each.zero_crossing;
    const Quad least = below.length(each.zero_crossing);
    // As long as a parabola that high, at most.
    if (i > 0 && i + 1 < events.rows.size() && each.amplitude <= least && length * length <= 16 * least) {
      const HalfCycle& next = events.rows[++i];
      HalfCycle& last = rows.back();
      last.zero_crossing = next.zero_crossing, last.speed = next.speed;
      if (next.amplitude > last.amplitude) last.amplitude = next.amplitude, last.peak_time = next.peak_time;
      merged.back() = true;
      continue;
    }
    rows.push_back(each);
    merged.push_back(false);
  }
  events.rows = rows;
  events.merged = merged;
}

// The two lists side by side.
struct Walk {
  std::vector<std::array<std::size_t, 2>> impacts;  // of the first, of the second list
  std::vector<std::size_t> skipped;                 // of the first list: jumped over by the second
  std::int64_t jumps = 0;
  std::optional<Quad> mismatch;  // the first time at which they are not the same
  std::string what;
  void fail(Quad t, const std::string& why) {
    if (!mismatch || t < *mismatch) mismatch = t, what = why;
  }
};

std::string said(const oracle::Impact& impact) {
  return std::string(impact.wall == Wall::left ? "left " : "right ") + text(impact.time, 17) + " (" +
         text(impact.relative_velocity, 6) + ")";
}

Walk walk(const Events& a, const Events& b, const Negligible& below) {
  Walk both;
  std::size_t i = 0, j = 0;
  const auto slow = [&](const oracle::Impact& each) {
    return magnitude(each.relative_velocity) <= below.speed(each.time);
  };
  const auto window = [&](Quad t) { return std::max(Quad(1e-7L) * (1 + t), below.duration(t)); };
  while (i < a.impacts.size() || j < b.impacts.size()) {
    const bool have_a = i < a.impacts.size(), have_b = j < b.impacts.size();
    // The same impact: the nearest in time that is left. How near is judged by the numbers' comparison.
    if (have_a && have_b && a.impacts[i].wall == b.impacts[j].wall) {
      const auto &p = a.impacts[i], &q = b.impacts[j];
      const Quad apart = magnitude(p.time - q.time);
      // In a chattering impacts are near each other: theirs must be nearer than the next one.
      const bool next_is_nearer = i + 1 < a.impacts.size() &&
                                  magnitude(a.impacts[i + 1].time - q.time) < apart &&
                                  a.impacts[i + 1].wall == q.wall;
      const bool alike = magnitude(p.relative_velocity - q.relative_velocity) <=
                         magnitude(p.relative_velocity) / 2 + below.speed(p.time);
      if (apart <= window(p.time) && !next_is_nearer && alike) {
        both.impacts.push_back({i++, j++});
        continue;
      }
    }
    if (have_a && slow(a.impacts[i])) {
      ++i;
      continue;
    }
    if (have_b && slow(b.impacts[j])) {
      ++j;
      continue;
    }
    // The rest of a complete chattering, that the other list jumps over.
    if (have_a && a.impacts[i].accumulation) {
      const Quad end = *a.impacts[i].accumulation;
      if (!have_b || b.impacts[j].time > end - below.duration(end)) {
        while (i < a.impacts.size() && a.impacts[i].accumulation && *a.impacts[i].accumulation == end)
          both.skipped.push_back(i++);
        ++both.jumps;
        continue;
      }
    }
    if (have_b && b.impacts[j].accumulation) {
      const Quad end = *b.impacts[j].accumulation;
      if (!have_a || a.impacts[i].time > end - below.duration(end)) {
        while (j < b.impacts.size() && b.impacts[j].accumulation && *b.impacts[j].accumulation == end) ++j;
        continue;
      }
    }
    const Quad t =
        !have_b || (have_a && a.impacts[i].time < b.impacts[j].time) ? a.impacts[i].time : b.impacts[j].time;
    both.fail(t, "impact " + std::to_string(i) + ": " + (have_b ? said(b.impacts[j]) : "none") +
                     " where the oracle has " + (have_a ? said(a.impacts[i]) : "none"));
    break;
  }
  for (std::size_t n = 0; n < std::max(a.contacts.size(), b.contacts.size()); ++n) {
    const auto name = [&](const Events& e) {
      return n < e.contacts.size() ? std::string(e.contacts[n].wall == Wall::left ? "left " : "right ") +
                                         text(e.contacts[n].begin, 17) + " to " + text(e.contacts[n].end, 17)
                                   : "none";
    };
    const bool have = n < a.contacts.size() && n < b.contacts.size();
    const Quad t = n < a.contacts.size()
                       ? (n < b.contacts.size() ? std::min(a.contacts[n].begin, b.contacts[n].begin)
                                                : a.contacts[n].begin)
                       : b.contacts[n].begin;
    if (!have || a.contacts[n].wall != b.contacts[n].wall ||
        magnitude(a.contacts[n].begin - b.contacts[n].begin) > window(t)) {
      both.fail(t, "contact " + std::to_string(n) + ": " + name(b) + " where the oracle has " + name(a));
      break;
    }
    const Quad end = std::min(a.contacts[n].end, b.contacts[n].end);
    if (magnitude(a.contacts[n].end - b.contacts[n].end) > window(end)) {
      both.fail(end, "contact " + std::to_string(n) + ": " + name(b) + " where the oracle has " + name(a));
      break;
    }
  }
  for (std::size_t n = 0; n < std::max(a.rows.size(), b.rows.size()); ++n) {
    const auto name = [&](const Events& e) {
      return n < e.rows.size() ? text(e.rows[n].zero_crossing, 17) : "none";
    };
    const bool have = n < a.rows.size() && n < b.rows.size();
    const Quad t = n < a.rows.size()
                       ? (n < b.rows.size() ? std::min(a.rows[n].zero_crossing, b.rows[n].zero_crossing)
                                            : a.rows[n].zero_crossing)
                       : b.rows[n].zero_crossing;
    if (!have || magnitude(a.rows[n].zero_crossing - b.rows[n].zero_crossing) > window(t)) {
      both.fail(t, "crossing " + std::to_string(n) + ": " + name(b) + " where the oracle has " + name(a));
      break;
    }
  }
  return both;
}

// The largest error that rounding made so far, for each kind; for a rounding of 2^-53.
class Growth {
 public:
  void take(Kind kind, Quad time, Quad difference) {
    entries_[kind].push_back({time, magnitude(difference)});
  }
  void end_of_sustained_contact() {
    for (auto& each : entries_) {
      std::sort(each.begin(), each.end(), [](const Entry& a, const Entry& b) { return a.time < b.time; });
      Quad most = 0;
      for (Entry& entry : each) entry.difference = most = std::max(most, entry.difference);
    }
  }
  // Up to this time and a little later: an event itself lies between samples.
  Quad operator()(Kind kind, Quad time) const {
    const auto& each = entries_[kind];
    auto after = std::upper_bound(each.begin(), each.end(), time + slack,
                                  [](Quad t, const Entry& entry) { return t < entry.time; });
    return after == each.begin() ? Quad(0) : std::prev(after)->difference;
  }
  Quad slack = 0;
  const auto& entries(Kind kind) const { return entries_[kind]; }
  struct Entry {
    Quad time, difference;
  };

 private:
  std::array<std::vector<Entry>, kinds_> entries_;
};

struct Noise {
  double size;
  std::uint64_t seed;
};
// What the scene's own numbers are as large as, up to then.
struct Sizes {
  std::vector<Quad> times;
  std::array<std::vector<Quad>, kinds_> most;
};

struct Prediction {
  Answer answer;  // without noise
  Growth growth;
  Sizes sizes;
  std::optional<Quad> ends;  // when nothing can be predicted beyond
  std::string why;
  std::vector<std::array<Quad, 4>> samples;  // growth at each sample
  std::array<Quad, 10> totals{};             // growth of the energy balance's numbers at the end
};

std::array<Quad, 10> totals_of(const Answer& answer) {
  Quad losses = 0;
  for (const oracle::Impact& each : answer.impacts) losses += each.loss;
  return {
      answer.final.kinetic, answer.final.spring, answer.final.wall,   answer.final.paper,  losses,
      answer.contact_loss,  answer.chatter_loss, answer.viscous_work, answer.forcing_work, answer.end_time};
}

Prediction predict(Question question, const Accuracy& accuracy) {
  const double rounding = accuracy.rounding, probe = accuracy.noise, predictable = accuracy.predictable;

  // The second is the first with the opposite sign: where rounding alone decides, as of a wall that is just
  // touched, one of both decides otherwise.
  const std::array<Noise, 4> noises{{{1e-24, 1}, {-1e-24, 1}, {1e-24, 2}, {probe, 3}}};
  Prediction result;
  const double end = *question.scene.until_time;
  question.samples = sample_times(end);
  result.answer = answer_to(question);
  const Answer& plain = result.answer;
  result.growth.slack = end / samples_of_a_run;
  const auto end_at = [&](Quad t, const std::string& why) {
    if (!result.ends || t < *result.ends) result.ends = t, result.why = why;
  };
  if (plain.stop == Stop::effort) {
    end_at(plain.end_time, "the oracle's effort");
    return result;
  }
  // The mass may be on a wall and off it again within the finest step.
  if (accuracy.by_steps) {
    for (const oracle::Contact& each : plain.contacts)
      if (each.end - each.begin < first_step(question.scene) / finer_steps.back() / 4 && each.end < end)
        end_at(each.begin, "a contact shorter than a step");
  }
  result.samples.resize(question.samples.size());

  // Sizes so far, of each kind.
  Quad x = magnitude(question.scene.x0), v = magnitude(question.scene.v0),
       y = magnitude(question.scene.damper().y0), w = magnitude(question.scene.damper().w0);
  for (std::size_t i = 0; i < plain.samples.size(); ++i) {
    const Sample& each = plain.samples[i];
    x = std::max(x, magnitude(each.x)), v = std::max(v, magnitude(each.v));
    y = std::max(y, magnitude(each.y)), w = std::max(w, magnitude(each.w));
    const Quad t = question.samples[i];
    result.sizes.times.push_back(t);
    const std::array<Quad, kinds_> now{t, t, x, v, y, w, v * v + x * x};
    for (int k = 0; k < kinds_; ++k) result.sizes.most[k].push_back(now[k]);
  }

  for (const Noise& noise : noises) {
    question.noise = noise.size;
    question.seed = noise.seed;
    const Answer other = answer_to(question);
    const Quad size = magnitude(noise.size), per_rounding = Quad(rounding) / size;
    const std::size_t samples = std::min(plain.samples.size(), other.samples.size());
    if (other.stop == Stop::effort) end_at(other.end_time, "the oracle's effort");
    for (std::size_t i = 0; i < samples; ++i) {
      const Quad t = question.samples[i];
      const Sample &a = plain.samples[i], &b = other.samples[i];
      const std::array<Quad, 4> off{magnitude(a.x - b.x) * per_rounding, magnitude(a.v - b.v) * per_rounding,
                                    magnitude(a.y - b.y) * per_rounding, magnitude(a.w - b.w) * per_rounding};
      for (int k = 0; k < 4; ++k) result.samples[i][k] = std::max(result.samples[i][k], off[k]);
      // A contact's velocities change fast: off by as much as the time of its begin, they are so only there.
      if (a.in_contact || b.in_contact) continue;
      result.growth.take(x_, t, off[0]);
      result.growth.take(v_, t, off[1]);
      result.growth.take(y_, t, off[2]);
      result.growth.take(w_, t, off[3]);
    }
    // Events: what is negligible is so by this noise alone.
    const auto grown = [&](Kind kind) {
      return [&, kind](Quad t) {
        Quad most = 0;
        for (std::size_t i = 0; i < samples; ++i) {
          const Sample &a = plain.samples[i], &b = other.samples[i];
          most = std::max(most, kind == w_ ? magnitude(a.w - b.w) + magnitude(a.v - b.v)
                                           : magnitude(a.x - b.x) + magnitude(a.y - b.y));
          if (Quad(question.samples[i]) > t) break;
        }
        return 1000 * (most + size * (t + 1));
      };
    };
    const Negligible below{grown(x_), grown(w_), grown(x_)};
    Events a = events_of(plain), b = events_of(other);
    simplify(a, below), simplify(b, below);
    const Walk both = walk(a, b, below);
    if (both.mismatch) end_at(*both.mismatch, "rounding decides: " + both.what);
    for (const auto& [i, j] : both.impacts) {
      const auto &p = a.impacts[i], &q = b.impacts[j];
      if (both.mismatch && p.time >= *both.mismatch) break;
      result.growth.take(time_, p.time, (p.time - q.time) * per_rounding);
      result.growth.take(w_, p.time, (p.relative_velocity - q.relative_velocity) * per_rounding);
      result.growth.take(x_, p.time, (p.displacement - q.displacement) * per_rounding);
      result.growth.take(loss_, p.time, (p.loss - q.loss) * per_rounding);
    }
    for (std::size_t i = 0; i < std::min(a.contacts.size(), b.contacts.size()); ++i) {
      const auto &p = a.contacts[i], &q = b.contacts[i];
      if (both.mismatch && p.end >= *both.mismatch) break;
      result.growth.take(time_, p.begin, (p.begin - q.begin) * per_rounding);
      result.growth.take(time_, p.end, (p.end - q.end) * per_rounding);
    }
    for (std::size_t i = 0; i < std::min(a.rows.size(), b.rows.size()); ++i) {
      const auto &p = a.rows[i], &q = b.rows[i];
      if (both.mismatch && p.zero_crossing >= *both.mismatch) break;
      result.growth.take(time_, p.zero_crossing, (p.zero_crossing - q.zero_crossing) * per_rounding);
      result.growth.take(x_, p.zero_crossing, (p.amplitude - q.amplitude) * per_rounding);
      // Two peaks of one height may change places.
      if (magnitude(p.peak_time - q.peak_time) < Quad(1e-4L) * (1 + p.peak_time))
        result.growth.take(peak_time_, p.peak_time, (p.peak_time - q.peak_time) * per_rounding);
    }
    const auto mine = totals_of(plain), others = totals_of(other);
    for (std::size_t i = 0; i < mine.size(); ++i)
      result.totals[i] = std::max(result.totals[i], magnitude(mine[i] - others[i]) * per_rounding);
  }
  result.growth.end_of_sustained_contact();
  // Until when is an error small?
  for (const Kind kind : {x_, v_, y_, w_})
    for (const auto& entry : result.growth.entries(kind)) {
      const auto at = std::lower_bound(result.sizes.times.begin(), result.sizes.times.end(), entry.time);
      if (result.sizes.times.empty()) break;
      const std::size_t i =
          std::min<std::size_t>(at - result.sizes.times.begin(), result.sizes.times.size() - 1);
      if (entry.difference <= predictable * result.sizes.most[kind][i]) continue;
      end_at(entry.time, "rounding has grown");
      break;
    }
  for (const auto& entry : result.growth.entries(time_))
    if (entry.difference > predictable * (1 + entry.time)) {
      end_at(entry.time, "rounding has grown");
      break;
    }
  return result;
}

Question question_of(const Scene& scene, const Engine& engine) {
  Question question;
  question.scene = scene;
  question.walls = std::holds_alternative<Restitution>(engine) ? Walls::rigid : Walls::compliant;
  if (const Exact* const exact = std::get_if<Exact>(&engine)) question.calibration = exact->calibration;
  return question;
}

// Is told of each number that is compared, and of what is there and should not be, or the other way about.
struct Judge {
  std::function<void(const std::string& what, double value, Quad truth, Quad predicted)> number;
  std::function<void(const std::string& what)> differ;
};

// The times at which the oracle is asked: the run's samples and, for rows that have two peaks of one height,
// those of its peaks.
std::vector<double> times_of(const Run& run, double end) {
  std::vector<double> times = run.history->time;
  for (const double t : run.half_cycles->peak_time)
    if (t >= 0 && t <= end) times.push_back(t);
  std::sort(times.begin(), times.end());
  return times;
}

// Judges everything in `run`; returns how many impacts were compared.
std::int64_t judge_run(const Run& run, Question question, const Prediction& prediction,
                       const Accuracy& accuracy, const Judge& judge) {
  const double rounding = accuracy.rounding;
  const Scene& scene = run.scene;
  const double end = *scene.until_time;
  const std::vector<double> times = times_of(run, end);
  question.samples = times;
  const Answer answer = answer_to(question);
  const auto at = [&](double t) -> const Sample& {
    return answer.samples.at(std::lower_bound(times.begin(), times.end(), t) - times.begin());
  };
  std::int64_t impacts = 0;

  const Growth& growth = prediction.growth;
  // Whatever an engine adds up it may round, and x, v and the force so far are what the primary mass's motion
  // is added up of; the secondary mass's place is so near a wall of the cavity at 0 or 1 as 1 can be rounded.
  const auto size = [&](Kind kind, Quad t) {
    const auto& times_so_far = prediction.sizes.times;
    const auto place = std::lower_bound(times_so_far.begin(), times_so_far.end(), t) - times_so_far.begin();
    const auto& most = prediction.sizes.most[kind];
    return most[std::min<std::size_t>(place, most.size() - 1)];
  };
  const auto rounded_motion = [&](Quad t) {
    const Quad omega_f = scene.force_frequency;
    const Quad force =
        std::abs(scene.force_amplitude) * std::min(Quad(1), omega_f * t) / std::max(Quad(1), omega_f);
    const Quad given =
        scene.damper().mass_ratio / (1 + scene.damper().mass_ratio) * size(w_, t);  // by the secondary mass
    return Quad(rounding) * (force + given + size(x_, t) + size(v_, t));
  };
  // Central differences take a step for an instant, at the release too.
  const Cem* const cem = std::get_if<Cem>(&run.engine);
  const double instant = cem ? cem->time_step.value_or(0) : 0;
  const auto predicted = [&](Kind kind, Quad t) {
    Quad unit = growth(kind, t);
    if (kind == time_ || kind == peak_time_) return unit + Quad(rounding) * t + instant;
    unit += rounded_motion(t);
    if (kind == y_) unit += Quad(rounding);
    if (kind == w_) unit += Quad(rounding) * size(w_, t);
    return unit;
  };
  // A place that is off by a rounding is met at this speed.
  const auto met = [&](Quad t, Quad place, Quad speed) {
    return predicted(time_, t) + (speed != 0 ? place / magnitude(speed) : Quad(0));
  };
  // What an acceleration gives in a step that was zero at its begin.
  const auto within_step = [&](Quad t) {
    const Quad grows = std::abs(scene.force_amplitude) * scene.force_frequency + size(x_, t) + size(v_, t);
    return Quad(instant) * instant * grows;
  };
  const auto negligible = [&](Kind kind) {
    return [&, kind](Quad t) {
      Quad unit = predicted(kind, t);
      if (kind == x_) unit += predicted(time_, t) * size(v_, t);
      if (kind == w_) unit += within_step(t);
      return accuracy.operations * unit;
    };
  };
  const Negligible below{negligible(time_), negligible(w_), negligible(x_)};

  Events mine = events_of(answer), its = events_of(run);
  const auto row_index = [](std::size_t i) { return "[" + std::to_string(i) + "]"; };
  simplify(mine, below), simplify(its, below);
  const Walk both = walk(mine, its, below);
  if (both.mismatch) judge.differ(both.what);
  const Quad until = both.mismatch ? *both.mismatch : Quad(end);

  std::vector<Quad> crossings;
  for (const HalfCycle& each : mine.rows) crossings.push_back(each.zero_crossing);
  for (const auto& [i, j] : both.impacts) {
    const oracle::Impact& p = mine.impacts[i];
    if (p.time > until) break;
    ++impacts;
    judge.number("impact time" + row_index(j), run.impacts->time[j], p.time,
                 met(p.time, rounding, p.relative_velocity));
    judge.number("relative velocity" + row_index(j), run.impacts->relative_velocity[j], p.relative_velocity,
                 predicted(w_, p.time));
    // It goes on while the time errs.
    judge.number("displacement" + row_index(j), run.impacts->displacement[j], p.displacement,
                 predicted(x_, p.time) + size(v_, p.time) * met(p.time, rounding, p.relative_velocity));
    if (!both.mismatch) {
      const Quad speed = magnitude(p.relative_velocity);
      const Quad relative_to_loss = speed > 0 ? p.loss / speed : Quad(0);
      judge.number("impact loss" + row_index(j), run.energy->impact_loss[j], p.loss,
                   growth(loss_, p.time) + 2 * relative_to_loss * predicted(w_, p.time));
    }
    // The half cycle, unless the impact coincides with a crossing.
    const Quad near = below.duration(p.time);
    const std::size_t row = std::lower_bound(crossings.begin(), crossings.end(), p.time) - crossings.begin();
    const bool coincides = (row < crossings.size() && crossings[row] - p.time <= near) ||
                           (row > 0 && p.time - crossings[row - 1] <= near);
    // Of a row that was three phases and amplitudes are those of one of them.
    const auto was_three = [row](const Events& events) {
      return row < events.merged.size() && events.merged[row];
    };
    if (coincides || both.mismatch || was_three(mine) || was_three(its)) continue;
    if (row == crossings.size()) {
      if (run.impacts->phase_deg[j] || run.impacts->amplitude[j])
        judge.differ("impact" + row_index(j) + " has a phase or an amplitude in an unfinished half cycle");
      continue;
    }
    if (run.impacts->amplitude[j])
      judge.number("impact's amplitude" + row_index(j), *run.impacts->amplitude[j], mine.rows[row].amplitude,
                   predicted(x_, crossings[row]));
    else
      judge.differ("impact" + row_index(j) + " has no amplitude");
    if (bool(run.impacts->phase_deg[j]) != (row > 0)) {
      judge.differ("impact" + row_index(j) + ": phase there or not");
    } else if (row > 0) {
      const Quad length = crossings[row] - crossings[row - 1];
      judge.number(
          "phase" + row_index(j), *run.impacts->phase_deg[j], 180 * (p.time - crossings[row - 1]) / length,
          360 / length *
              (met(p.time, rounding, p.relative_velocity) +
               met(crossings[row], rounded_motion(crossings[row]), mine.rows[row].speed) +
               met(crossings[row - 1], rounded_motion(crossings[row - 1]), mine.rows[row - 1].speed)));
    }
  }
  const auto speed_at = [&](Quad begin) {
    for (const oracle::Impact& each : mine.impacts)
      if (each.time == begin) return each.relative_velocity;
    return Quad(0);
  };
  // The place, or at rigid walls the acceleration, that has to vanish at a contact's end.
  const auto release = [&](Quad t) {
    return question.walls == Walls::rigid ? rounded_motion(t) * (1 + 2 * scene.damping_ratio)
                                          : Quad(rounding);
  };
  // Where the engine jumps to the end of a chattering it is off by up to its tolerance of what it jumps over.
  const auto jump = [&](Quad begin) {
    const Restitution* const rigid = std::get_if<Restitution>(&run.engine);
    Quad rest = 0;
    for (const std::size_t i : both.skipped)
      if (magnitude(*mine.impacts[i].accumulation - begin) <= below.duration(begin))
        rest = std::max(rest, begin - mine.impacts[i].time);
    return rigid ? rest * Quad(rigid->accumulation_tolerance) : Quad(0);
  };
  for (std::size_t i = 0; i < std::min(mine.contacts.size(), its.contacts.size()); ++i) {
    if (mine.contacts[i].begin > until) break;
    judge.number("contact begin" + row_index(i), double(its.contacts[i].begin), mine.contacts[i].begin,
                 met(mine.contacts[i].begin, rounding, speed_at(mine.contacts[i].begin)) +
                     jump(mine.contacts[i].begin));
    if (mine.contacts[i].end > until) break;
    judge.number("contact end" + row_index(i), double(its.contacts[i].end), mine.contacts[i].end,
                 met(mine.contacts[i].end, release(mine.contacts[i].end), mine.contacts[i].end_speed));
  }
  Quad last_crossing = 0;
  for (std::size_t i = 0; i < std::min(mine.rows.size(), its.rows.size()); ++i) {
    const HalfCycle &p = mine.rows[i], &q = its.rows[i];
    if (p.zero_crossing > until) break;
    judge.number("zero crossing" + row_index(i), double(q.zero_crossing), p.zero_crossing,
                 met(p.zero_crossing, rounded_motion(p.zero_crossing), p.speed));
    judge.number("amplitude" + row_index(i), double(q.amplitude), p.amplitude,
                 predicted(x_, p.zero_crossing));
    // Where two peaks of a row have one height, or the release and the turn right after it, either will do.
    const bool at_release = i == 0 && q.peak_time == 0;
    const bool another = at_release || magnitude(p.peak_time - q.peak_time) > Quad(1e-4L) * (1 + p.peak_time);
    if (another && q.peak_time >= last_crossing - below.duration(last_crossing) &&
        q.peak_time <= p.zero_crossing)
      judge.number("|x| at peak time" + row_index(i), double(p.amplitude),
                   magnitude(at(double(q.peak_time)).x), predicted(x_, p.zero_crossing));
    else
      judge.number("peak time" + row_index(i), double(q.peak_time), p.peak_time,
                   predicted(peak_time_, p.zero_crossing) + predicted(time_, p.zero_crossing));
    last_crossing = p.zero_crossing;
  }
  // The counts of the rows as they are recorded: impacts before the crossing, but for those that coincide
  // with it.
  for (std::size_t i = 0; i < run.half_cycles->impacts.size() && !both.mismatch; ++i) {
    const double crossing = run.half_cycles->zero_crossing[i];
    const double near = double(below.duration(crossing));
    std::int64_t sure = 0, possible = 0;
    std::int64_t before = 0;
    for (std::size_t n = 0; n <= i; ++n) before += run.half_cycles->impacts[n];
    for (const double t : run.impacts->time) {
      sure += t < crossing - near;
      possible += t <= crossing + near;
    }
    if (before < sure || before > possible)
      judge.differ("impacts up to row " + std::to_string(i) + ": " + std::to_string(before) + ", true " +
                   std::to_string(sure));
  }

  for (std::size_t i = 0; i < run.history->time.size(); ++i) {
    const double t = run.history->time[i];
    const Sample& truth = at(t);
    const std::string where = " at " + text(t, 17);
    const auto grown = [&](int k) {
      return i < prediction.samples.size() ? prediction.samples[i][k] : Quad(0);
    };
    // An impact within rounding of a sample: before or after it?
    bool coincides = false;
    for (const auto& each : mine.impacts)
      coincides = coincides || magnitude(each.time - t) <= below.duration(t);
    judge.number("x" + where, run.history->x[i], truth.x, grown(0) + predicted(x_, t));
    judge.number("y" + where, run.history->dampers[0].y[i], truth.y, grown(2) + predicted(y_, t));
    if (coincides) continue;
    judge.number("v" + where, run.history->v[i], truth.v, grown(1) + predicted(v_, t));
    judge.number("w" + where, run.history->dampers[0].w[i], truth.w, grown(3) + predicted(w_, t));
  }
  if (run.history->time != sample_times(end)) judge.differ("other samples than were asked for");

  // The energy balance. Each term may be off by roundings of the largest.
  const EnergyBalance& balance = *run.energy;
  Quad listed = 0, recorded = 0;
  for (const oracle::Impact& each : answer.impacts) listed += each.loss;
  for (const double each : balance.impact_loss) recorded += each;
  const auto& totals = prediction.totals;
  const Quad all = answer.initial.total() + answer.forcing_turnover + answer.viscous_work;
  const Quad floor = Quad(rounding) * all;
  const auto energies = [&](const std::string& which, const impact_damper::Energy& e,
                            const oracle::Energy& truth, bool last) {
    const auto grown = [&](int i) { return last ? totals[i] + floor : Quad(0); };
    judge.number(which + " kinetic energy", e.kinetic, truth.kinetic, grown(0));
    judge.number(which + " spring energy", e.spring, truth.spring, grown(1));
    judge.number(which + " wall energy", e.wall, truth.wall, grown(2));
    judge.number(which + " paper's energy", e.paper, truth.paper, grown(3));
  };
  energies("initial", balance.initial, answer.initial, false);
  energies("final", balance.final, answer.final, true);
  if (cem) {
    // A contact that begins without speed may begin with an impact here: only the sum is known.
    judge.number("all losses", double(recorded + Quad(balance.contact_loss)), listed + answer.contact_loss,
                 totals[4] + totals[5] + floor);
  } else {
    judge.number("loss of all impacts", double(recorded + Quad(balance.bounce_down_loss)),
                 listed + answer.chatter_loss, totals[4] + totals[6] + floor);
    judge.number("contact loss", balance.contact_loss, answer.contact_loss, totals[5] + floor);
  }
  judge.number("viscous work", balance.viscous_work, answer.viscous_work, totals[7] + floor);
  // omega_f t is rounded, too, which no noise of the state stands for: the force is off by as many roundings
  // as it has radians.
  const Quad radians = question.scene.force_frequency * end;
  judge.number("forcing work", balance.forcing_work, answer.forcing_work,
               totals[8] + floor + Quad(rounding) * answer.forcing_turnover * radians);
  judge.number("residual", balance.residual, 0, Quad(rounding) * 10);
  if (question.walls == Walls::rigid && !both.mismatch) {
    Quad jumped = answer.chatter_loss;
    for (const std::size_t i : both.skipped) jumped += mine.impacts[i].loss;
    // Each complete chattering is one jump, but for those in which all is negligible; a plastic impact is
    // none.
    std::int64_t complete = 0;
    for (std::size_t i = 0; i < mine.impacts.size(); ++i)
      complete +=
          mine.impacts[i].accumulation &&
          (i + 1 == mine.impacts.size() || mine.impacts[i + 1].accumulation != mine.impacts[i].accumulation);
    if (balance.bounce_downs < both.jumps || balance.bounce_downs > complete)
      judge.differ("bounce-downs: " + std::to_string(balance.bounce_downs) + ", true " +
                   std::to_string(both.jumps));
    judge.number("bounce-down loss", balance.bounce_down_loss, jumped, totals[4] + totals[6] + floor);
  }
  judge.number("end time", run.end_time, end, 0);
  if (run.stop_reason != StopReason::time)
    judge.differ("stopped by " + std::string(name_of(run.stop_reason)));
  return impacts;
}

// The longest part of the scene that can be predicted; shortens it to that.
Prediction predict_what_can_be(Scene& scene, Question& question, const Accuracy& accuracy,
                               Comparison& result) {
  result.asked = *scene.until_time;
  Prediction prediction = predict(question, accuracy);
  for (int i = 0; i < 4 && prediction.ends; ++i) {
    result.ended_by = prediction.why;
    // Half a sample earlier: what ends it, and its noise, stay outside.
    const double end = double(*prediction.ends) - *scene.until_time / samples_of_a_run / 2;
    if (!(end > 0)) return prediction;
    scene.until_time = question.scene.until_time = end;
    prediction = predict(question, accuracy);
  }
  if (!prediction.ends) result.until = *scene.until_time;
  return prediction;
}

Record everything(double end) {
  Record record;
  record.impacts = record.contacts = record.energy = true;
  record.history = {{0, end, samples_of_a_run}};
  return record;
}

// With a quarter of the step every error is to be a sixteenth, once steps are short enough for the scene:
// they are shortened twice where that is not so. A column's largest error stands for it.
void compare_by_order(const Scene& scene, const Question& question, const Prediction& prediction, Cem engine,
                      Comparison& result) {
  for (const double finer : finer_steps) {
    // By what the step is divided by, and by column: the error itself, and in units of the predicted one.
    std::map<int, std::map<std::string, std::array<double, 2>>> errors;
    result.differences.clear();
    result.numbers = result.impacts = 0;
    result.worst = 0;
    for (const int by : {1, 4}) {
      engine.time_step = first_step(scene) / finer / by;
      const Run run = simulate(scene, engine, everything(*scene.until_time));
      Judge judge;
      judge.number = [&](const std::string& what, double value, Quad truth, Quad predicted) {
        ++result.numbers;
        auto& [most, by_unit] = errors[by][what.substr(0, std::min(what.find('['), what.find(" at ")))];
        const Quad error = magnitude(value - truth);
        const Quad unit = predicted + Quad(central_differences.rounding) * magnitude(truth) + Quad(1e-300L);
        most = std::max(most, double(error));
        by_unit = std::max(by_unit, double(error / unit));
      };
      judge.differ = [&](const std::string& what) { result.differences.push_back(what); };
      result.impacts += judge_run(run, question, prediction, central_differences, judge);
    }
    for (const auto& [column, at_full] : errors[1]) {
      const auto& at_quarter = errors[4][column];
      if (at_full[1] > result.worst) result.worst = at_full[1], result.worst_what = column;
      // Half at least: where in a step a sample lies changes its error, and of two kinks near a sample one
      // may be before it now and behind it then. What is far below the method's error has leading terms that
      // cancel, and need not shrink.
      if (at_quarter[0] <= at_full[0] / 2 || at_quarter[1] <= 1e-2) continue;
      // In flight cem counts y from the left wall: at the right one a step moves it by no less than rounding
      // of 1, so that velocities are multiples of about epsilon / h.
      const double step = first_step(scene) / finer / 4;
      if (at_quarter[0] <= 4 * std::numeric_limits<double>::epsilon() / step) continue;
      result.differences.push_back(column + " is off by " + text(at_full[0], 3) +
                                   ", with a quarter of the step by " + text(at_quarter[0], 3) + ": " +
                                   text(at_quarter[1], 3) + " of what is predicted");
    }
    if (result.differences.empty()) return;
  }
}

// That the run ends where it is told to: by an amplitude, a number of half cycles, a number of impacts. Asked
// in the middle, where nothing coincides.
void compare_stops(Scene scene, Engine engine, const Prediction& prediction, const Judge& judge) {
  const Answer& answer = prediction.answer;
  const auto time = [&](const std::string& what, const Run& run, StopReason reason, Quad truth) {
    if (run.stop_reason != reason)
      judge.differ("stop at " + what + ": by " + std::string(name_of(run.stop_reason)) + " at " +
                   text(run.end_time, 17) + ", true " + text(truth, 20));
    else
      judge.number("stop at " + what, run.end_time, truth,
                   prediction.growth(time_, truth) + Quad(0x1p-53) * 100 * (1 + truth));
  };
  const auto& rows = answer.half_cycles;
  const std::size_t row = rows.size() / 2;
  // Where x only touches zero rounding decides whether there is a row.
  const bool tall = std::all_of(rows.begin(), rows.end(),
                                [](const HalfCycle& each) { return each.amplitude > Quad(1e-6L); });
  const auto spread = [&](Quad amplitude) {
    return std::all_of(rows.begin(), rows.end(), [&](const HalfCycle& each) {
      return magnitude(each.amplitude - amplitude) > Quad(1e-6L) * amplitude;
    });
  };
  if (tall && row + 1 < rows.size()) {
    const double amplitude = double(rows[row].amplitude) * 1.001;
    const auto first = std::find_if(rows.begin(), rows.end(),
                                    [&](const HalfCycle& each) { return each.amplitude < Quad(amplitude); });
    if (spread(amplitude)) {
      Scene stopped = scene;
      stopped.until_amplitude = amplitude;
      time("amplitude " + text(amplitude, 17), simulate(stopped, engine, {}), StopReason::amplitude,
           first->zero_crossing);
    }
  }
  const auto budget = [&]() -> Budget& {
    return std::visit([](auto& each) -> Budget& { return each.budget; }, engine);
  };
  const Budget before = budget();
  if (tall && row + 1 < rows.size()) {
    budget().max_half_cycles = std::int64_t(row) + 1;
    time("half cycle " + std::to_string(row), simulate(scene, engine, {}), StopReason::half_cycle_budget,
         rows[row].zero_crossing);
    budget() = before;
  }
  // The run ends with the impact that would be one too many.
  const auto& impacts = answer.impacts;
  const std::size_t most = impacts.size() / 2;
  const auto plain = [](const oracle::Impact& each) {
    return !each.accumulation && magnitude(each.relative_velocity) > Quad(1e-6L);
  };
  if (most < impacts.size() &&
      std::all_of(impacts.begin(), impacts.begin() + std::ptrdiff_t(most) + 1, plain)) {
    budget().max_impacts = std::int64_t(most);
    time("impact " + std::to_string(most), simulate(scene, engine, {}), StopReason::impact_budget,
         impacts[most].time);
  }
}

}  // namespace

Comparison compare(const Scene& asked, const Engine& engine) {
  Comparison result;
  Scene scene = asked;
  Question question = question_of(scene, engine);
  const Accuracy& accuracy = std::holds_alternative<Cem>(engine) ? central_differences : closed_forms;
  const Prediction prediction = predict_what_can_be(scene, question, accuracy, result);
  if (result.until == 0) return result;
  Judge judge;
  judge.differ = [&](const std::string& what) { result.differences.push_back(what); };
  // `predicted`: by growth. A value that was rounded once is off by that, too.
  judge.number = [&](const std::string& what, double value, Quad truth, Quad predicted) {
    ++result.numbers;
    const Quad error = magnitude(Quad(value) - truth);
    const Quad unit = predicted + Quad(accuracy.rounding) * magnitude(truth) + Quad(1e-300L);
    const double ratio = double(error / unit);
    if (!(ratio <= result.worst)) result.worst = ratio, result.worst_what = what;
    if (!(ratio <= accuracy.operations))
      judge.differ(what + " is " + text(value, 17) + ", true " + text(truth, 20) + ", off by " +
                   text(error, 3) + ", predicted " + text(unit, 3));
  };
  try {
    if (const Cem* const cem = std::get_if<Cem>(&engine)) {
      compare_by_order(scene, question, prediction, *cem, result);
    } else {
      result.impacts =
          judge_run(simulate(scene, engine, everything(result.until)), question, prediction, accuracy, judge);
      compare_stops(scene, engine, prediction, judge);
    }
  } catch (const std::exception& error) {
    judge.differ(std::string("throws: ") + error.what());
  }
  return result;
}

}  // namespace oracle
