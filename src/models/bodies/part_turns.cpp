#include "models/bodies/part_turns.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace barchan {

namespace {

/// R is tried beyond this displacement, of the diameter of the longest part; a turn of 0.02 to 0.03 rad.
constexpr double large = 0.02;
/// Where R does not halve the displacements, it is tried again when they have grown by this factor.
constexpr double grown = 1.25;

/// Particles of a piece that R is fitted to, or up to twice as many: any R about the mean turn will do.
constexpr std::size_t samples = 64;

constexpr PartTurns::Rotation identity{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

/// Sums of r = x - x_a, s = X - X_a and r (x) s.
struct Moments {
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero();
  Eigen::Vector3d r = Eigen::Vector3d::Zero(), s = Eigen::Vector3d::Zero();
  double count = 0.0;

  void add(const Moments& other) {
    product += other.product;
    r += other.r;
    s += other.s;
    count += other.count;
  }
};

Moments moments_of(const PartTurns::Places& places, const ReferenceBody<float>::Piece& piece) {
  const auto dim = static_cast<std::size_t>(places.reference.dimensions);
  std::array<const double*, 3> x{};
  for (std::size_t d = 0; d < dim; ++d) x[d] = places.body.column(Field::position, static_cast<int>(d));
  const auto displacement = [&](std::size_t d, std::size_t k) {
    return places.displaced[d].empty() ? x[d][places.at[k]] - places.reference.place[d][k] : places.displaced[d][k];
  };
  Moments m;
  Eigen::Vector3d r = Eigen::Vector3d::Zero(), s = Eigen::Vector3d::Zero();
  const std::size_t stride = std::max<std::size_t>(1, (piece.end - piece.begin) / samples);
  for (std::size_t k = piece.begin; k < piece.end; k += stride) {
    for (std::size_t d = 0; d < dim; ++d) {
      const auto row = static_cast<Eigen::Index>(d);
      s[row] = places.reference.place[d][k] - places.reference.place[d][piece.anchor];
      r[row] = s[row] + (displacement(d, k) - displacement(d, piece.anchor));
    }
    m.product += r * s.transpose();
    m.r += r;
    m.s += s;
    m.count += 1.0;
  }
  return m;
}

/// The rotation of the least squares of r - R s about the middles (Kabsch 1976); `dimensions` 2: about z.
PartTurns::Rotation best_fit(const Moments& m, int dimensions) {
  Eigen::Matrix3d a = m.product - m.r * m.s.transpose() / m.count;
  if (dimensions == 2) a(2, 2) = a.norm();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const bool mirrored = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0;
  const Eigen::Vector3d signs(1.0, 1.0, mirrored ? -1.0 : 1.0);
  const Eigen::Matrix3d r = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  PartTurns::Rotation rows;
  for (std::size_t d = 0; d < 3; ++d)
    for (std::size_t e = 0; e < 3; ++e) rows[d][e] = r(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(e));
  return rows;
}

}  // namespace

void PartTurns::begin(const ReferenceBody<float>& reference) {
  const auto& pieces = reference.pieces;
  std::vector<std::uint32_t> first(reference.size, 0);  // piece by anchor, which is the first particle of its part
  part_.resize(pieces.size());
  for (std::size_t piece = 0; piece < pieces.size(); ++piece) {
    if (pieces[piece].begin == pieces[piece].anchor) first[pieces[piece].anchor] = static_cast<std::uint32_t>(piece);
    part_[piece] = first[pieces[piece].anchor];
  }
  if (bound_.empty()) bound_.assign(pieces.size(), large * reference.diameter);
}

std::vector<double> PartTurns::by_part(const std::vector<double>& largest) const {
  std::vector<double> most(largest.size(), 0.0);
  for (std::size_t piece = 0; piece < largest.size(); ++piece)
    most[part_[piece]] = std::max(most[part_[piece]], largest[piece]);
  return most;
}

/// R of the parts that are wanted.
template <class Wanted>
void PartTurns::fit(const Places& places, Wanted&& wanted) {
  const auto& pieces = places.reference.pieces;
  std::vector<Moments> moments(pieces.size());
  const auto count = static_cast<std::int64_t>(pieces.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t number = 0; number < count; ++number) {
    const auto piece = static_cast<std::size_t>(number);
    if (wanted(part_[piece])) moments[piece] = moments_of(places, pieces[piece]);
  }
  for (std::size_t piece = 0; piece < pieces.size(); ++piece)
    if (part_[piece] != piece) moments[part_[piece]].add(moments[piece]);
  for (std::size_t piece = 0; piece < pieces.size(); ++piece)
    if (wanted(part_[piece]))
      rotation_[piece] =
          part_[piece] == piece ? best_fit(moments[piece], places.reference.dimensions) : rotation_[part_[piece]];
}

void PartTurns::follow(const Places& places) {
  if (part_.empty()) begin(places.reference);
  if (any()) fit(places, [&](std::size_t part) { return turned_[part] != 0; });
}

bool PartTurns::choose(const Places& places, const std::vector<double>& largest) {
  trials_.clear();
  bool none = true;
  for (std::size_t piece = 0; piece < part_.size(); ++piece)
    none = none && (turned(piece) || !(largest[piece] > bound_[part_[piece]]));
  if (none) return false;

  const std::vector<double> most = by_part(largest);
  if (!any()) {
    rotation_.assign(part_.size(), identity);
    turned_.assign(part_.size(), 0);
  }
  const auto tried = [&](std::size_t part) {
    return !turned_[part] && most[part] > bound_[part] && most[part] < 1e300;
  };
  fit(places, tried);
  for (std::uint32_t part = 0; part < part_.size(); ++part)
    if (part_[part] == part && tried(part)) trials_.push_back({part, most[part]});
  for (const Trial& trial : trials_) turned_[trial.part] = 1;
  for (std::size_t piece = 0; piece < part_.size(); ++piece) turned_[piece] = turned_[part_[piece]];
  return !trials_.empty();
}

bool PartTurns::keep(const ReferenceBody<float>& reference, const std::vector<double>& largest) {
  const std::vector<double> now = by_part(largest);
  bool again = false;
  for (const Trial& trial : trials_) {
    if (now[trial.part] < 0.5 * trial.largest) continue;
    bound_[trial.part] = std::max(large * reference.diameter, grown * trial.largest);
    turned_[trial.part] = 0;
    again = true;
  }
  for (std::size_t piece = 0; piece < part_.size(); ++piece) turned_[piece] = turned_[part_[piece]];
  if (std::none_of(turned_.begin(), turned_.end(), [](unsigned char t) { return t != 0; })) rotation_.clear();
  return again;
}

void PartTurns::archive(Archive& a) {
  a.array("parts that have turned", turned_);
  a.array("displacements beyond which parts may have turned", bound_);
  if (!a.loads()) return;
  const bool some = std::any_of(turned_.begin(), turned_.end(), [](unsigned char t) { return t != 0; });
  rotation_.assign(some ? turned_.size() : 0, identity);
}

}  // namespace barchan
