#include "models/column/air_column.hpp"

#include <algorithm>
#include <cmath>

namespace barchan {

namespace {

constexpr double kappa = 0.4;     // von Karman
constexpr double critical = 7.0;  // Reynolds number of Duran, Andreotti & Claudin 2012, eq. (7)
constexpr double growth = 1.05;   // of the cells above the fine ones

/// (1 - exp(-x))/x.
double faded(double x) { return x < 1e-6 ? 1.0 - 0.5 * x : -std::expm1(-x) / x; }

}  // namespace

AirProfile AirColumn::grid(double bottom, double fine_top, double top, double resolution) {
  AirProfile p;
  p.face.push_back(bottom);
  double height = resolution;
  while (p.face.back() + 1.5 * height < top) {
    p.face.push_back(p.face.back() + height);
    if (p.face.back() > fine_top) height *= growth;
  }
  p.face.push_back(top);
  const std::size_t n = p.face.size() - 1;
  p.speed.assign(n, 0.0);
  p.given.assign(n, 0.0);
  p.stress.assign(n + 1, 0.0);
  p.length.assign(n + 1, 0.0);
  return p;
}

AirColumn::AirColumn(const Air& air, AirProfile& profile) : air_(air), profile_(profile) {
  const std::size_t n = profile.cells();
  bottom_ = profile.face.front();
  double lowest = profile.face[1] - profile.face[0];
  for (std::size_t k = 0; k < n; ++k) lowest = std::min(lowest, profile.face[k + 1] - profile.face[k]);
  const double bin = 0.999 * lowest;  // a bin holds one face at most
  inverse_bin_ = 1.0 / bin;
  std::size_t cell = 0;
  for (std::size_t b = 0; bottom_ + static_cast<double>(b) * bin < profile.face.back(); ++b) {
    while (cell + 1 < n && profile.face[cell + 1] <= bottom_ + static_cast<double>(b) * bin) ++cell;
    cell_of_bin_.push_back(static_cast<std::uint32_t>(cell));
  }
  for (auto* v : {&lower_, &diagonal_, &upper_, &change_}) v->assign(n, 0.0);
  conductance_.assign(n + 1, 0.0);
  below_.assign(n + 1, 0.0);
}

void AirColumn::integrate_speed() {
  for (std::size_t k = 0; k < profile_.cells(); ++k)
    below_[k + 1] = below_[k] + profile_.speed[k] * (profile_.face[k + 1] - profile_.face[k]);
}

double AirColumn::integral(double y) const {
  if (!(y > bottom_)) return 0.0;
  const std::size_t k = cell_at(y);
  return below_[k] + profile_.speed[k] * (y - profile_.face[k]);
}

void AirColumn::Spread::clear() {
  std::fill(part_.begin(), part_.end(), 0.0);
  std::fill(step_.begin(), step_.end(), 0.0);
}

void AirColumn::Spread::add(const AirColumn& column, double low, double high, double amount) {
  const std::vector<double>& face = column.profile_.face;
  const double bottom = std::clamp(low, face.front(), face.back()), top = std::clamp(high, face.front(), face.back());
  const std::size_t a = column.cell_at(bottom), b = column.cell_at(top);
  if (!(high > low) || !(top > bottom) || (a == b && low == bottom && high == top)) {
    part_[a] += amount;
    return;
  }
  const double density = amount / (high - low);
  if (low < bottom) part_[a] += density * (bottom - low);
  if (high > top) part_[b] += density * (high - top);
  low = bottom;
  high = top;
  if (a == b) {
    part_[a] += density * (high - low);
    return;
  }
  part_[a] += density * (face[a + 1] - low);
  part_[b] += density * (high - face[b]);
  step_[a + 1] += density;
  step_[b] -= density;
}

void AirColumn::Spread::gather(const AirColumn& column, std::vector<double>& sums) const {
  const std::vector<double>& face = column.profile_.face;
  double density = 0.0;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    density += step_[k];
    sums[k] = part_[k] + density * (face[k + 1] - face[k]);
  }
}

/// sqrt(l) is integrated: l = 0 all the way up solves the equation for l too, and is not meant.
void AirColumn::update_mixing_length() {
  if (air_.mixing_length == MixingLength::none) return;
  double root = 0.0;
  for (std::size_t k = 0; k < profile_.cells(); ++k) {
    const double height = profile_.face[k + 1] - profile_.face[k];
    const double along = std::sqrt(std::abs(profile_.speed[k]) / (critical * air_.viscosity));
    const double slope = 0.5 * kappa * along;
    const double middle = root + 0.5 * height * slope * faded(root * along);
    root += height * slope * faded(middle * along);
    profile_.length[k + 1] = root * root;
  }
}

/// Newton's step for the stress, which grows with the square of the slope: a step of any length stays stable, and what
/// one cell loses the next one gets.
void AirColumn::advance(double dt, const Top& top, const Load& load) {
  const std::size_t n = profile_.cells();
  const auto height = [&](std::size_t k) { return profile_.face[k + 1] - profile_.face[k]; };
  const double rho = air_.density;
  const auto face = [&](std::size_t k, double apart, double difference) {
    const double slope = difference / apart, eddy = profile_.length[k] * profile_.length[k] * std::abs(slope);
    profile_.stress[k] = rho * (air_.viscosity + eddy) * slope;
    conductance_[k] = rho * (air_.viscosity + 2.0 * eddy) / apart;
  };
  for (std::size_t k = 1; k < n; ++k)
    face(k, 0.5 * (height(k) + height(k - 1)), profile_.speed[k] - profile_.speed[k - 1]);
  profile_.stress[0] = conductance_[0] = conductance_[n] = 0.0;
  profile_.stress[n] = top.stress;
  if (air_.slip != Slip::free_slip) face(0, 0.5 * height(0), profile_.speed[0]);
  if (top.speed) face(n, 0.5 * height(n - 1), *top.speed - profile_.speed[n - 1]);
  for (std::size_t k = 0; k < n; ++k) {
    lower_[k] = k > 0 ? -conductance_[k] : 0.0;
    upper_[k] = k + 1 < n ? -conductance_[k + 1] : 0.0;
    diagonal_[k] = rho * height(k) / dt + conductance_[k] + conductance_[k + 1] + load.rate[k];
    change_[k] = profile_.stress[k + 1] - profile_.stress[k] - load.pull[k] - load.owed[k] / dt;
  }
  solve();
  for (std::size_t k = 0; k < n; ++k) {
    profile_.stress[k] += conductance_[k] * (change_[k] - (k > 0 ? change_[k - 1] : 0.0));
    profile_.given[k] = (load.pull[k] + load.rate[k] * change_[k]) * dt;
    profile_.speed[k] += change_[k];
  }
  profile_.stress[n] -= conductance_[n] * change_[n - 1];
  profile_.boundary += (profile_.stress[n] - profile_.stress[0]) * dt;
  update_mixing_length();
  integrate_speed();
}

/// The tridiagonal system, right-hand side and solution in change_ (Thomas's algorithm).
void AirColumn::solve() {
  const std::size_t n = change_.size();
  for (std::size_t k = 1; k < n; ++k) {
    const double share = lower_[k] / diagonal_[k - 1];
    diagonal_[k] -= share * upper_[k - 1];
    change_[k] -= share * change_[k - 1];
  }
  change_[n - 1] /= diagonal_[n - 1];
  for (std::size_t k = n - 1; k-- > 0;) change_[k] = (change_[k] - upper_[k] * change_[k + 1]) / diagonal_[k];
}

double AirColumn::momentum() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < profile_.cells(); ++k)
    sum += air_.density * profile_.speed[k] * (profile_.face[k + 1] - profile_.face[k]);
  return sum;
}

}  // namespace barchan
