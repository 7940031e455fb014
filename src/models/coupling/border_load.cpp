#include "models/coupling/border_load.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "models/fluid/fluid_phase.hpp"

namespace barchan {

namespace {

constexpr double fit_radius = 3.0;    // spacings
constexpr double least_share = 1e-5;  // of the largest pivot of a fit, that the least one must have

template <std::size_t N, std::size_t Values>
class Fit {
 public:
  void add(const Eigen::Matrix<double, N, 1>& basis, double weight, const Eigen::Matrix<double, 1, Values>& value) {
    moment_.noalias() += weight * basis * basis.transpose();
    sums_.noalias() += weight * basis * value;
    ++count_;
  }
  /// False: too few particles, or all in one line.
  bool solve(Eigen::Matrix<double, N, Values>& result) const {
    if (count_ < N) return false;
    const Eigen::LDLT<Eigen::Matrix<double, N, N>> ldlt(moment_);
    const auto pivots = ldlt.vectorD();
    if (!(pivots.minCoeff() > least_share * pivots.maxCoeff())) return false;
    result = ldlt.solve(sums_);
    return true;
  }

 private:
  Eigen::Matrix<double, N, N> moment_ = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, Values> sums_ = Eigen::Matrix<double, N, Values>::Zero();
  std::size_t count_ = 0;
};

}  // namespace

BorderLoad::BorderLoad(const Scene& scene, const Layout& layout, const PlanEntry& entry)
    : scene_(scene),
      layout_(layout),
      fluid_(entry.fluid),
      solid_(entry.other),
      spacing_(layout.phases[fluid_].spacing),
      radius_(fit_radius * spacing_),
      viscosity_(pair_viscosity(scene, layout, solid_, fluid_)) {
  for (const PlanEntry& e : layout.entries) slack_ = std::max(slack_, e.searched ? layout.skin * e.radius : 0.0);
}

void BorderLoad::begin(State& state, const std::vector<ParticleBlock>& blocks) {
  const std::vector<Vec3>& x = blocks[solid_].position;
  const double width = (layout_.dimensions == 2 ? 0.5 : 0.7) * spacing_;
  const auto first = std::find_if(state.bodies.begin(), state.bodies.end(),
                                  [&](const RigidBody& body) { return body.phase == solid_; });
  first_body_ = static_cast<std::size_t>(first - state.bodies.begin());
  std::size_t most = 0;
  for (const RigidBody& body : layout_.phases[solid_].rigid_bodies) {
    const Shape& shape = scene_.fills[body.fill].shape;
    Border border{{}, surfaces_of(shape, scene_, layout_.phases[solid_].spacing)};
    for (ContactSurface& surface : border.surfaces) surface.prepare(radius_ + spacing_, spacing_);
    const OwnAxes axes(body);
    for (const BorderPoint& p :
         border_points(shape, layout_.dimensions, layout_.phases[solid_].spacing, width)) {
      std::size_t nearest = body.first;
      for (std::size_t k = body.first; k < body.first + body.count; ++k)
        if (norm(x[k] - p.at) < norm(x[nearest] - p.at)) nearest = k;
      border.pieces.push_back({axes.to_own(p.at - body.first_place), axes.to_own(p.normal),
                               axes.to_own(p.at - x[nearest]), p.content, nearest});
    }
    most = std::max(most, border.pieces.size());
    borders_.push_back(std::move(border));
  }
  stress_.resize(most);
}

void BorderLoad::attach(Workspace& w) { w_ = &w; }

void BorderLoad::schedule(Schedule& s) {
  using enum Field;
  s.add({stage::reaction,
         layout_.phases[solid_].name + ", border",
         {{layout_.phases[solid_].name, {position}, {}}, {layout_.phases[fluid_].name, {position, velocity, pressure}, {}}},
         [this] { load(); }});
}

void BorderLoad::load() {
  for (std::size_t b = 0; b < borders_.size(); ++b) {
    RigidBody& body = w_->state.bodies[first_body_ + b];
    if (layout_.dimensions == 2) find_stress<2>(body, borders_[b]);
    else find_stress<3>(body, borders_[b]);
    sum(body, borders_[b]);
  }
}

template <int Dim>
void BorderLoad::find_stress(const RigidBody& body, const Border& border) {
  constexpr std::size_t dim = Dim;
  const PhaseParticles &fluid = w_->particles(fluid_), &solid = w_->particles(solid_);
  const CellGrid &grid = w_->neighbours.grid(fluid_), &anchors = w_->neighbours.grid(solid_);
  const std::uint32_t* const place_of = solid.places();
  std::array<const double*, dim> x{}, v{}, own{};
  for (std::size_t d = 0; d < dim; ++d) {
    x[d] = fluid.column(Field::position, static_cast<int>(d));
    v[d] = fluid.column(Field::velocity, static_cast<int>(d));
    own[d] = solid.column(Field::position, static_cast<int>(d));
  }
  const double* p = fluid.column(Field::pressure);
  const OwnAxes axes(body), at_start([&] { RigidBody b = body; b.now.angle = 0; b.now.turn = layout_.phases[solid_].rigid_bodies[static_cast<std::size_t>(&border - borders_.data())].now.turn; return b; }());
  const Vec3 rate = axes.to_space(own_angular_velocity(body));
  const double rho = scene_.phases[fluid_].density;
  const std::size_t n = fluid.size();
  const auto count = static_cast<std::int64_t>(border.pieces.size());
#pragma omp parallel for schedule(static)
  for (std::int64_t q = 0; q < count; ++q) {
    const Piece& piece = border.pieces[static_cast<std::size_t>(q)];
    const std::size_t anchor = place_of[piece.anchor];
    const Vec3 arm = axes.to_space(piece.arm), normal = axes.to_space(piece.normal),
               beside = axes.to_space(piece.from_anchor);
    std::array<double, dim> at{};
    std::array<float, 3> centre{};
    for (std::size_t d = 0; d < dim; ++d) {
      at[d] = own[d][anchor] + beside[d];
      centre[d] = anchors.search_position(static_cast<int>(d))[anchor] + static_cast<float>(beside[d]);
    }
    std::array<Vec3, 2> along{};  // unit vectors in the border
    if (Dim == 2) {
      along[0] = {-normal[1], normal[0], 0.0};
    } else {
      const Vec3 help = std::abs(normal[0]) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
      along[0] = cross(normal, help);
      along[0] = 1.0 / norm(along[0]) * along[0];
      along[1] = cross(normal, along[0]);
    }
    Fit<dim + 1, 1> linear;
    Fit<dim + 1, dim> shear;
    double weights = 0.0, lifted = 0.0, slope = 0.0;
    Vec3 sloped{};
    const auto look = [&](std::size_t b, const std::array<double, 3>& shift) {
      Vec3 r{};
      for (std::size_t d = 0; d < dim; ++d) r[d] = x[d][b] + shift[d] - at[d];
      const double r2 = dot(r, r);
      if (!(r2 < radius_ * radius_)) return;
      double out = dot(normal, r);
      const double share = 1.0 - r2 / (radius_ * radius_), w = share * share;
      if (!border.surfaces.empty()) {
        double nearest = 1e300;
        const Vec3 there = body.first_place + at_start.to_space(axes.to_own(arm + r));
        for (const ContactSurface& surface : border.surfaces)
          if (const auto gap = surface.gap(there)) nearest = std::min(nearest, gap->distance);
        if (!(nearest < 1e300)) return;
        if (out > 0.0) out = nearest;
      }
      const double xi = out / spacing_, eta = dot(along[0], r) / spacing_, zeta = dot(along[1], r) / spacing_;
      const double lift = p[b] - rho * dot(scene_.domain.gravity, r);
      Eigen::Matrix<double, dim + 1, 1> basis;
      basis[0] = 1.0;
      for (std::size_t d = 0; d < dim; ++d) basis[static_cast<Eigen::Index>(d + 1)] = r[d] / spacing_;
      const Eigen::Matrix<double, 1, 1> value(lift);
      linear.add(basis, w, value);
      weights += w;
      lifted += w * lift;
      if (!(out > 0.0)) return;
      const Vec3 carried = body.now.velocity + cross(rate, arm + r);
      Eigen::Matrix<double, 1, dim> u;
      for (std::size_t d = 0; d < dim; ++d) u[static_cast<Eigen::Index>(d)] = v[d][b] - carried[d];
      Eigen::Matrix<double, dim + 1, 1> rising;
      rising[0] = xi;
      rising[1] = 0.5 * xi * xi;
      rising[2] = xi * eta;
      if (Dim == 3) rising[Dim] = xi * zeta;
      shear.add(rising, w, u);
      slope += w * xi * xi;
      for (std::size_t d = 0; d < dim; ++d) sloped[d] += w * xi * u[static_cast<Eigen::Index>(d)];
    };
    const auto search = [&](const std::array<float, 3>& about, const std::array<double, 3>& shift) {
      grid.candidates(about, about, static_cast<float>(radius_ + slack_), [&](std::uint32_t begin, std::uint32_t end) {
        for (std::size_t b = begin; b < std::min<std::size_t>(end, n); ++b) look(b, shift);
      });
    };
    std::array<int, 3> ways{};
    for (std::size_t d = 0; d < dim; ++d) ways[d] = layout_.bounds.periodic[d] ? 1 : 0;
    for (int i = -ways[0]; i <= ways[0]; ++i)
      for (int j = -ways[1]; j <= ways[1]; ++j)
        for (int k = -ways[2]; k <= ways[2]; ++k) {
          const std::array<int, 3> turns{i, j, k};
          std::array<float, 3> about = centre;
          std::array<double, 3> shift{};
          bool near = true;
          for (std::size_t d = 0; d < dim; ++d) {
            const double period = layout_.bounds.high[d] - layout_.bounds.low[d];
            shift[d] = -turns[d] * period;
            about[d] += static_cast<float>(turns[d] * period);
            if (layout_.bounds.periodic[d])
              near = near && about[d] > -(radius_ + slack_) && about[d] < period + radius_ + slack_;
          }
          if (near) search(about, shift);
        }
    Stress& s = stress_[static_cast<std::size_t>(q)];
    s = {weights > 0.0, 0.0, {}};
    if (!s.wet) continue;
    Eigen::Matrix<double, dim + 1, 1> c1;
    if (linear.solve(c1)) s.pressure = c1[0];
    else s.pressure = lifted / weights;
    Vec3 gain{};
    Eigen::Matrix<double, dim + 1, dim> g;
    if (shear.solve(g))
      for (std::size_t d = 0; d < dim; ++d) gain[d] = g(0, static_cast<Eigen::Index>(d));
    else if (slope > 0.0) gain = 1.0 / slope * sloped;
    s.friction = viscosity_ / spacing_ * (gain - dot(gain, normal) * normal);
  }
}

void BorderLoad::sum(RigidBody& body, const Border& border) const {
  double wet = 0.0, mean = 0.0;
  for (std::size_t q = 0; q < border.pieces.size(); ++q) {
    if (!stress_[q].wet) continue;
    wet += border.pieces[q].content;
    mean += border.pieces[q].content * stress_[q].pressure;
  }
  if (!(wet > 0.0)) return;
  mean = layout_.phases[fluid_].free_surface ? 0.0 : mean / wet;
  const OwnAxes axes(body);
  Vec3 force{}, torque{};
  for (std::size_t q = 0; q < border.pieces.size(); ++q) {
    if (!stress_[q].wet) continue;
    const Piece& piece = border.pieces[q];
    const Vec3 push = piece.content * (stress_[q].friction - (stress_[q].pressure - mean) * axes.to_space(piece.normal));
    force = force + push;
    torque = torque + cross(axes.to_space(piece.arm), push);
  }
  body.now.touch_force = body.now.touch_force + force;
  body.now.touch_torque = body.now.touch_torque + torque;
}

}  // namespace barchan
