// One evaluation of one pair loop on a small perturbed set, for callgrind to count: pair_loops CASE
//   plain2d consistent2d plain3d consistent3d, each with -double or -mixed; strain2d; forces2d; lists2d; lists3d
// Prints the pairs within the kernel radius, each counted from both sides.
#include <cstdio>
#include <cstring>
#include <string>

#include "models/bodies/updated_lagrangian.hpp"
#include "models/fluid/fluid_rates.hpp"
#include "unit/particle_sets.hpp"

namespace {

using namespace barchan;
using namespace barchan::sets;

constexpr double fluid_radius_2d = 2.9, fluid_radius_3d = 2.8, body_radius = 2.6;

Cast particles(int dimensions, double radius, std::size_t padding, Uniform& random) {
  const Bounds b =
      dimensions == 2 ? box(2, {48, 48, 0}, {true, true, false}) : box(3, {14, 14, 14}, {true, true, true});
  std::vector<PhaseParticles> one;
  one.push_back(phase(dimensions, lattice(b, 1.0, 0.2, random), 1.0,
                      {Field::velocity, Field::density, Field::pressure, Field::acceleration, Field::density_rate,
                       Field::shift_velocity, Field::anisotropy, Field::stress}));
  randomise(one[0], Field::velocity, -1, 1, random);
  randomise(one[0], Field::density, 0.98, 1.02, random);
  randomise(one[0], Field::pressure, -1, 1, random);
  randomise(one[0], Field::stress, -1, 1, random);
  return Cast(b, std::move(one), {{0, 0, radius}}, 0.1, padding);
}

void print_pairs(const Cast& cast, double radius) {
  std::size_t pairs = 0;
  const auto& p = cast.phases[0];
  const auto dimensions = static_cast<std::size_t>(p.dimensions());
  for (std::size_t k = 0; k < p.size(); ++k) {
    const auto row = cast.list(0).row(k);
    for (const auto* q = row.begin; q != row.end; ++q) {
      const double *a = cast.motion[0][k], *b = cast.motion[0].data() + *q;
      double r2 = 0.0;
      for (std::size_t d = 0; d < dimensions; ++d) r2 += (a[d] - b[d]) * (a[d] - b[d]);
      pairs += r2 < radius * radius;
    }
  }
  std::printf("%zu\n", pairs);
}

void fluid(int dimensions, FluidScheme scheme, bool mixed) {
  Uniform random(21);
  const double radius = dimensions == 2 ? fluid_radius_2d : fluid_radius_3d;
  Cast cast = particles(dimensions, radius, mixed ? simd::width_in_use<float>() : simd::width_in_use<double>(), random);
  CompactRecords compact(cast.bounds);
  const std::size_t n = cast.phases[0].size(), images = cast.neighbours.grid(0).images();
  compact.resize(n, images);
  dimensions == 2 ? compact.copy<2>(cast.motion[0], n + images) : compact.copy<3>(cast.motion[0], n + images);
  const std::vector<FluidNeighbour> neighbours{
      {&cast.list(0), &cast.motion[0], KernelKind::wendland_c2, radius, 0.7, true, &compact}};
  FluidParameters q{};
  q.reference_density = 1.0;
  q.sound_speed = 10.0;
  q.diffusivity = q.source_diffusivity = 0.5;
  q.shift_speed = 1.0;
  q.shift_limit = 0.2;
  q.smoothing_length = 0.5 * radius;
  if (mixed) fluid_rates(cast.phases[0], compact, neighbours, q, scheme);
  else fluid_rates(cast.phases[0], cast.motion[0], neighbours, q, scheme);
  print_pairs(cast, radius);
}

void body(bool strain) {
  Uniform random(22);
  Cast cast = particles(2, body_radius, simd::width_in_use<double>(), random);
  RecordArray records(StressRecord<2>::size);
  records.resize(cast.phases[0].size(), cast.neighbours.grid(0).images());
  pack_stress(cast.phases[0], records);
  records.fill_images(cast.neighbours.grid(0), 2);
  const std::vector<ElasticNeighbour> neighbours{{&cast.list(0), &records, KernelKind::cubic_spline, body_radius, 1.0}};
  const ElasticParameters q{1.0, 100.0, 200.0, 0.1, 0.0, 14.0, {0, 0, 0}};
  if (strain) elastic_strain(cast.phases[0], records, neighbours, q, 1e-4);
  else elastic_forces(cast.phases[0], records, neighbours, q);
  print_pairs(cast, body_radius);
}

void lists(int dimensions) {
  Uniform random(23);
  const double radius = dimensions == 2 ? fluid_radius_2d : fluid_radius_3d;
  const Cast cast = particles(dimensions, radius, simd::width_in_use<double>(), random);
  print_pairs(cast, radius);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string name = argc == 2 ? argv[1] : "";
  if (name == "strain2d") body(true);
  else if (name == "forces2d") body(false);
  else if (name == "lists2d") lists(2);
  else if (name == "lists3d") lists(3);
  else {
    const bool mixed = name.ends_with("-mixed"), flat = name.find("2d") != std::string::npos;
    const bool plain = name.starts_with("plain");
    if (!plain && !name.starts_with("consistent")) {
      std::fprintf(stderr, "pair_loops: no case '%s'\n", name.c_str());
      return 2;
    }
    fluid(flat ? 2 : 3, plain ? FluidScheme::plain : FluidScheme::consistent, mixed);
  }
  return 0;
}
