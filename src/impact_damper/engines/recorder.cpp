#include "impact_damper/engines/recorder.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace impact_damper {

Recorder::Recorder(Record record, std::size_t dampers, MotionChain* chain)
    : wants_(std::move(record)),
      chain_(chain),
      wants_half_cycles_(wants_.half_cycles || wants_.impacts || !wants_.history_below.empty()),
      wants_history_(!wants_.history.empty() || !wants_.history_below.empty()),
      impacts_in_row_(dampers),
      windows_(std::move(wants_.history)) {
  half_cycles_.dampers.resize(impacts_in_row_.size());
  history_.dampers.resize(impacts_in_row_.size());
  std::int64_t samples = 0;
  for (const HistoryWindow& window : windows_) samples += window.count;
  const auto make_room = [samples](auto&... columns) {
    (columns.reserve(static_cast<std::size_t>(samples)), ...);
  };
  make_room(history_.time, history_.x, history_.v);
  for (History::Damper& each : history_.dampers) make_room(each.y, each.w);
  advance_window();
}

void Recorder::half_cycle(double begin, double zero_crossing, double peak_time, double amplitude) {
  if (wants_.half_cycles) {
    half_cycles_.zero_crossing.push_back(zero_crossing);
    half_cycles_.peak_time.push_back(peak_time);
    half_cycles_.amplitude.push_back(amplitude);
    half_cycles_.impacts.push_back(
        std::accumulate(impacts_in_row_.begin(), impacts_in_row_.end(), std::int64_t{0}));
    for (std::size_t i = 0; i < impacts_in_row_.size(); ++i)
      half_cycles_.dampers[i].impacts.push_back(std::exchange(impacts_in_row_[i], 0));
  }
  for (std::size_t i = first_impact_in_row_; i < impacts_.time.size(); ++i) {
    if (row_ > 0) impacts_.phase_deg[i] = 180 * ((impacts_.time[i] - begin) / (zero_crossing - begin));
    impacts_.amplitude[i] = amplitude;
  }
  first_impact_in_row_ = impacts_.time.size();
  ++row_;

  while (next_below_ < wants_.history_below.size() &&
         amplitude < wants_.history_below[next_below_].amplitude) {
    const AmplitudeWindow& window = wants_.history_below[next_below_++];
    // Where the decay falls through two amplitudes within one window, the second window follows the first.
    const double from = windows_.empty() ? zero_crossing : std::max(zero_crossing, windows_.back().end);
    windows_.push_back({from, from + window.length, window.count});
    advance_window();
  }
}

void Recorder::impact(double time, Wall wall, double relative_velocity, double displacement,
                      std::int32_t damper) {
  if (chain_) chain_->impacts.push_back({chain_->motions.size(), time, wall, relative_velocity, damper});
  ++impacts_in_row_[static_cast<std::size_t>(damper)];
  if (!wants_.impacts) return;
  impacts_.time.push_back(time);
  impacts_.wall.push_back(wall);
  impacts_.relative_velocity.push_back(relative_velocity);
  impacts_.phase_deg.emplace_back();
  impacts_.amplitude.emplace_back();
  impacts_.displacement.push_back(displacement);
  impacts_.damper.push_back(damper);
}

void Recorder::contact(double begin, double end, Wall wall, std::int32_t damper) {
  if (chain_) chain_->contacts.push_back({chain_->motions.size(), begin, end, wall, damper});
  if (!wants_.contacts) return;
  contacts_.begin.push_back(begin);
  contacts_.end.push_back(end);
  contacts_.wall.push_back(wall);
  contacts_.damper.push_back(damper);
}

void Recorder::sample(double time, double x, double v, double y, double w) {
  const PlaceInCavity place{y, w};
  sample(time, x, v, {&place, 1});
}

void Recorder::sample(double time, double x, double v, std::span<const PlaceInCavity> places) {
  history_.time.push_back(time);
  history_.x.push_back(x);
  history_.v.push_back(v);
  for (std::size_t i = 0; i < places.size(); ++i) {
    history_.dampers[i].y.push_back(places[i].y);
    history_.dampers[i].w.push_back(places[i].w);
  }
  ++sample_in_window_;
  advance_window();
}

void Recorder::advance_window() {
  while (window_ < windows_.size() && sample_in_window_ >= windows_[window_].count) {
    ++window_;
    sample_in_window_ = 0;
  }
  if (window_ == windows_.size()) {
    next_sample_ = std::numeric_limits<double>::infinity();
    return;
  }
  const HistoryWindow& now = windows_[window_];
  const double fraction = now.count > 1 ? double(sample_in_window_) / double(now.count - 1) : 0.0;
  next_sample_ = sample_in_window_ == now.count - 1 && now.count > 1
                     ? now.end
                     : now.begin + fraction * (now.end - now.begin);
}

void Recorder::finish(Run& run) {
  if (wants_.half_cycles) run.half_cycles = std::move(half_cycles_);
  if (wants_.impacts) run.impacts = std::move(impacts_);
  if (wants_.contacts) run.contacts = std::move(contacts_);
  if (wants_.energy) run.energy = std::move(energy_balance_);
  if (wants_history_) run.history = std::move(history_);
}

}  // namespace impact_damper
