#include "formats/sensor_log/beam_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "rayfield/core/median.h"

namespace rayfield::formats {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::size_t kSamples = 1024;           // returns of a sweep that are looked at: about this many
constexpr std::size_t kFirstSamples = 8192;      // while the rings are new
constexpr std::size_t kBins = 128;               // of a sweep's duration
constexpr int kLeastPerBin = 3;                  // returns that show where the head was
constexpr std::uint64_t kLeastPerRing = 20;      // returns that show a ring's elevation
constexpr double kConeSpread = 0.5 * kDegree;    // standard deviation of elevation in a ring that is a cone
constexpr double kHeadResidual = 0.3 * kDegree;  // median misfit of azimuths under which the head is understood
constexpr int kFirstPasses = 8;                  // between rings and head, while the rings are new
constexpr std::uint16_t kMostRings = 1024;

double wrapped(double angle) { return angle - 2 * std::numbers::pi * std::nearbyint(angle / (2 * std::numbers::pi)); }

}  // namespace

bool BeamGeometry::Ring::known() const {
  return count >= kLeastPerRing && squares < static_cast<double>(count) * kConeSpread * kConeSpread;
}

void BeamGeometry::learn_elevations(std::span<const Shot> returns) {
  // Steps of random length: equal ones would miss rings of a cloud that is stored column by column.
  const std::size_t stride = std::max<std::size_t>(1, returns.size() / (rings_.empty() ? kFirstSamples : kSamples));
  std::minstd_rand random;
  samples_.clear();
  for (std::size_t i = 0; i < returns.size(); i += 1 + random() % (2 * stride - 1)) {
    const Shot& shot = returns[i];
    if (shot.ring >= kMostRings) continue;
    if (shot.ring >= rings_.size()) rings_.resize(std::size_t{shot.ring} + 1);
    const Eigen::Vector3d d = shot.direction.cast<double>();
    Ring& ring = rings_[shot.ring];
    const double off = std::asin(std::clamp(d.z(), -1.0, 1.0)) - ring.elevation;
    ring.elevation += off / static_cast<double>(++ring.count);
    ring.squares += off * (std::asin(std::clamp(d.z(), -1.0, 1.0)) - ring.elevation);
    samples_.push_back({shot.ring, shot.time_s, std::atan2(d.y(), d.x())});
  }
}

// The mean rate of turn: median over neighbours in time within rings.
bool BeamGeometry::measure_rate() {
  std::vector<const Sample*> last(rings_.size(), nullptr);
  std::vector<double> rates;
  for (const Sample& s : samples_) {
    const Sample*& before = last[s.ring];
    if (before != nullptr && s.time_s > before->time_s)
      rates.push_back(wrapped(s.azimuth - before->azimuth) / static_cast<double>(s.time_s - before->time_s));
    before = &s;
  }
  if (rates.size() < kBins) return false;
  rate_rad_s_ = median_of(std::move(rates));
  first_s_ = last_s_ = samples_.front().time_s;
  for (const Sample& s : samples_) first_s_ = std::min(first_s_, s.time_s), last_s_ = std::max(last_s_, s.time_s);
  return last_s_ > first_s_ && rate_rad_s_ != 0;
}

double BeamGeometry::turned(double azimuth, float time_s) const {
  return azimuth - rate_rad_s_ * static_cast<double>(time_s - first_s_);
}

std::size_t BeamGeometry::bin_of(float time_s) const {
  const double share = static_cast<double>(time_s - first_s_) / static_cast<double>(last_s_ - first_s_);
  return static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * (static_cast<double>(kBins) - 1e-6));
}

// One pass: the head in every bin from the rings' azimuths, then the rings' azimuths from the head. Returns the median
// misfit before the pass.
double BeamGeometry::follow_head() {
  bins_.assign(kBins, {});
  for (const Sample& s : samples_) {
    const double head = turned(s.azimuth, s.time_s) - rings_[s.ring].azimuth;
    Bin& bin = bins_[bin_of(s.time_s)];
    bin.sum += Eigen::Vector2d(std::cos(head), std::sin(head));
    ++bin.count;
  }
  for (Bin& bin : bins_) bin.head = std::atan2(bin.sum.y(), bin.sum.x());
  std::vector<std::pair<double, int>> off(rings_.size(), {0.0, 0});
  std::vector<double> misfit;
  misfit.reserve(samples_.size());
  for (const Sample& s : samples_) {
    const double error = wrapped(turned(s.azimuth, s.time_s) - rings_[s.ring].azimuth - bins_[bin_of(s.time_s)].head);
    off[s.ring].first += error, ++off[s.ring].second;
    misfit.push_back(std::abs(error));
  }
  for (std::size_t r = 0; r < rings_.size(); ++r) {
    // All sweeps count alike: a ring's azimuth is the mean of what each of them says.
    const double weight =
        static_cast<double>(off[r].second) / static_cast<double>(std::max<std::uint64_t>(1, rings_[r].count));
    if (off[r].second > 0) rings_[r].azimuth = wrapped(rings_[r].azimuth + weight * off[r].first / off[r].second);
  }
  return median_of(std::move(misfit));
}

void BeamGeometry::learn(std::span<const Shot> returns) {
  understood_ = false;
  const bool fresh = rings_.empty();
  learn_elevations(returns);
  if (samples_.size() < kBins || !measure_rate()) return;
  double misfit = 0;
  for (int pass = 0; pass < (fresh ? kFirstPasses : 2); ++pass) misfit = follow_head();
  understood_ = misfit < kHeadResidual;
  for (Ring& ring : rings_) ring.cosine = std::cos(ring.elevation), ring.sine = std::sin(ring.elevation);
}

std::optional<Eigen::Vector3f> BeamGeometry::direction(std::uint16_t ring, float time_s) const {
  if (!understood_ || ring >= rings_.size() || !rings_[ring].known()) return std::nullopt;
  if (!(time_s >= first_s_) || !(time_s <= last_s_)) return std::nullopt;
  const Bin& bin = bins_[bin_of(time_s)];
  if (bin.count < kLeastPerBin) return std::nullopt;
  const Ring& r = rings_[ring];
  const double azimuth = bin.head + r.azimuth + rate_rad_s_ * static_cast<double>(time_s - first_s_);
  return Eigen::Vector3d(r.cosine * std::cos(azimuth), r.cosine * std::sin(azimuth), r.sine).cast<float>();
}

}  // namespace rayfield::formats
