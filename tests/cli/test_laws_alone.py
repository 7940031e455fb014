#!/usr/bin/env python3
"""Every header of src/laws compiles alone, and every law with T = double, in two and three dimensions: plain C++20 without
OpenMP and without the vectors of a certain machine, by clang where it is installed. So a law can stand in a loop for
another device. (Whether nvcc takes them is not tested: it is not there.)"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

root = pathlib.Path(sys.argv[2])
laws = root / "src/laws"

PAIRS = """
template <class Law, int Dim>
void one_pair() {
  typename Law::template Own<Dim, double> a{};
  barchan::Particle<Dim, double, typename Law::Reads> b{};
  barchan::Pair<Dim, double> ab{};
  typename Law::template Sums<Dim, double> s{};
  const Law law{};
  law.add(a, b, ab, s);
  if constexpr (Law::closes_each_entry) Law::close_entry(s);
}
#define PAIRS(...) template void one_pair<barchan::__VA_ARGS__, 2>(); template void one_pair<barchan::__VA_ARGS__, 3>();
"""
FLUID = """
template <class Law, int Dim>
void one_pair() {
  typename Law::template Own<double> a{};
  typename Law::template Sums<double> s{}, all{};
  const std::array<double, Dim> r{}, v{};
  Law::add(a, r, 1.0, 1.0, v.data(), 1.0, 1.0, s);
  all.take(s, 1.0, 1.0, 1.0, {});
}
#define FLUID(law) template void one_pair<barchan::law<2>, 2>(); template void one_pair<barchan::law<3>, 3>();
"""

# What of a header is compiled with T = double. A header that one of these includes needs no row.
ROWS = {
    "body_contact": """
template <int Dim> void touching() {
  using Law = barchan::BodyContactLaw;
  const Law::Constants<double> c(Law{1, 1, 1, 1, 1, 1}, 1.0);
  std::array<double, Dim> r{}, force{};
  Law::add<true>(c, r, 1.0, r, force);
  Law::add<false>(c, r, 1.0, r, force);
}
template void touching<2>(); template void touching<3>();""",
    "smooth_contact": """
template <int Dim> void touching_surfaces() {
  using Law = barchan::SmoothContactLaw;
  const Law::Constants<double> c(Law::of({1, 1, 1, 1, 1, 1}, Dim), 1.0);
  std::array<double, Dim> r{}, force{};
  Law::add<true>(c, r, 1.0, r, r, r.data(), 1.0, force);
  Law::add<false>(c, r, 1.0, r, r, r.data(), 1.0, force);
}
template void touching_surfaces<2>();
template void touching_surfaces<3>();
""",
    "consistent_fluid": FLUID + "FLUID(ConsistentFluid)",
    "drag_coefficients": """
double excess(double re) {
  return barchan::StokesDrag::excess(re) + barchan::SchillerNaumannDrag::excess(re) + barchan::ChengDrag::excess(re) +
         barchan::DuranDrag::excess(re) + barchan::DiFeliceDrag::excess_in_crowd(re, 0.5);
}""",
    "eddies": """
template double barchan::pair_viscosity(double, double);
template double barchan::eddy_viscosity(double, double, double);""",
    "eddy_fluid": """
template <int Dim> void one_pair() {
  using Law = barchan::EddyFluid<Dim>;
  typename Law::template Own<double> a{};
  typename Law::template Sums<double> s{}, all{};
  const std::array<double, Dim> r{}, v{};
  Law::add(a, r, 1.0, 1.0, v.data(), 1.0, 1.0, 1.0, s);
  all.take(s, 1.0, {});
  const auto normal = Law::template normal_of<double>(s, 1.0);
  s = Law::template with_stress<double>(s, normal, normal);
  s = Law::template with_viscosity<double>(s, 1.0);
}
template void one_pair<2>(); template void one_pair<3>();""",
    "k_omega": PAIRS + "PAIRS(KOmegaPairs) PAIRS(KOmegaBorder)",
    "eddy_friction": PAIRS + "PAIRS(EddyFriction)",
    "elastic": """
template <int Dim> void one_pair() {
  typename barchan::ElasticForce<Dim>::template Own<double> a{};
  const std::array<double, Dim> r{};
  const std::array<double, 6> stress{};
  std::array<double, Dim> acceleration{};
  double power = 0;
  barchan::ElasticForce<Dim>::template add<true, true>(a, r, 1.0, 1.0, r.data(), stress.data(), 1.0, acceleration, power);
  barchan::ElasticForce<Dim>::template add<false, false>(a, r, 1.0, 1.0, r.data(), stress.data(), 1.0, acceleration, power);
  typename barchan::ElasticStrain<Dim>::template Sums<double> s{};
  barchan::ElasticStrain<Dim>::add(r, 1.0, r, 1.0, r.data(), 1.0, s);
}
template void one_pair<2>(); template void one_pair<3>();
template double barchan::nearness(double);""",
    "extension": PAIRS + "PAIRS(Extension<false>) PAIRS(Extension<true>) PAIRS(Extension<false, true>)\n"
                 "template struct barchan::ExtendedState<2>; template struct barchan::ExtendedState<3>;",
    "grain_drag": PAIRS + "PAIRS(DragAndBarrier)",
    "hyperelastic": """
template <class Law, int Dim> void stressed() {
  namespace h = barchan::hyperelastic;
  h::Matrix<Dim, double> m{};
  const double jacobian = 1.0 + h::dilation<Dim, double>(m);
  Law::template stiffening<Dim, double>(h::green_strain<Dim, double>(m), jacobian, 1.0, 1.0);
  Law::template stress<Dim, double>(m, jacobian, 1.0, 1.0);
  h::damping_stress<Dim, double>(m, m, 1.0, 1.0);
}
template void stressed<barchan::NeoHookean, 2>(); template void stressed<barchan::NeoHookean, 3>();
template void stressed<barchan::SaintVenantKirchhoff, 2>(); template void stressed<barchan::SaintVenantKirchhoff, 3>();""",
    "interface_plane": """
template <int Dim> void one_pair() {
  using Law = barchan::InterfacePlane;
  typename Law::template Sums<Dim, double> s{};
  const barchan::Particle<Dim, double, Law::Reads> a{}, b{};
  const barchan::Pair<Dim, double> ab{};
  Law{}.add(a, b, ab, s);
}
template void one_pair<2>(); template void one_pair<3>();""",
    "interface_side": PAIRS + "PAIRS(InterfaceSide)",
    "joined_fluids": """
template <int Dim> void one_pair() {
  using Law = barchan::JoinedFluids<Dim>;
  typename Law::template Own<double> a{};
  typename Law::template Sums<double> s{}, all{};
  const std::array<double, Dim> r{}, v{};
  Law::add(a, r, 1.0, 1.0, v.data(), 1.0, 1.0, 1.0, s);
  all.take(s, 1.0, 1.0, 1.0, {});
  all.take(Law::template without_kink<double>(s), 1.0, 1.0, 1.0, {});
}
template void one_pair<2>(); template void one_pair<3>();""",
    "turning_sphere": """
template <std::size_t Dim> void turned() {
  std::array<double, barchan::spins(Dim)> spin{};
  const std::array<double, Dim> through{};
  barchan::TurningSphere{1.0, 1.0, 1.0, 1.0}.turn<Dim>(spin, through, 1.0);
}
template void turned<2>(); template void turned<3>();""",
    "kept_drag": """
template <std::size_t Dim> void kept() {
  const std::array<double, Dim> v{};
  barchan::kept_drag<Dim>(v, v, v, 1.0, 1.0, [](double) { return 1.0; }, 1.0);
}
template void kept<2>(); template void kept<3>();""",
    "kernel_contact": PAIRS + "PAIRS(KernelContacts)",
    "plain_energy": PAIRS + "PAIRS(PlainEnergy) PAIRS(SolidEnergy)",
    "plain_fluid": FLUID + "FLUID(PlainFluid) FLUID(PlainSurface)",
    "sphere_catalogue": """
#include <variant>
template <class Law, std::size_t Dim> void touching() {
  const typename Law::template Constants<double> c(Law{}, 1.0);
  const barchan::TouchingSpheres<double, Dim> s{};
  std::array<double, Law::template numbers<Dim>> memory{};
  Law::touch(c, s, memory);
}
template <class Law> void parts() {
  touching<Law, 2>(); touching<Law, 3>();
  touching<typename Law::WithoutRolling, 2>(); touching<typename Law::WithoutRolling, 3>();
  touching<typename Law::Smooth, 2>(); touching<typename Law::Smooth, 3>();
  touching<typename Law::Lossless, 2>(); touching<typename Law::Lossless, 3>();
}
void all() { barchan::each_sphere_law([](auto row) { parts<typename decltype(row)::Law>(); }); }""",
    "stray_length": "template struct barchan::StrayLength<2, double>; template struct barchan::StrayLength<3, double>;",
    "surface_contact": """
double pushed() { const barchan::SurfaceContactLaw law{1, 1, 1}; return law.push(1, 1, 1, 1) + law.grip(1, 1, 1, 1); }""",
    "turning_friction": PAIRS + "PAIRS(TurningFriction)",
}


def reached(name, seen):
    """The headers of src/laws that a header includes, itself too."""
    if name not in seen and (laws / f"{name}.hpp").exists():
        seen.add(name)
        for other in re.findall(r'#include "laws/(\w+)\.hpp"', (laws / f"{name}.hpp").read_text()):
            reached(other, seen)
    return seen


def compile_alone(name, compiler, folder):
    source = pathlib.Path(folder) / f"{name}.cpp"
    source.write_text(f'#include "laws/{name}.hpp"\n' + ROWS.get(name, ""))
    command = [compiler, "-std=c++20", "-fsyntax-only", "-U__SSE2__", "-Wall", "-Wextra", "-Werror", "-I", str(root / "src"), str(source)]
    if "clang" not in compiler:
        command.append("-Wno-psabi")
    done = subprocess.run(command, capture_output=True, text=True)
    return f"laws/{name}.hpp alone, with T = double:\n{done.stderr[:3000]}" if done.returncode else ""


def main():
    names = sorted(header.stem for header in laws.glob("*.hpp"))
    problems = [f"there is no laws/{name}.hpp: its row in {pathlib.Path(__file__).name} is old" for name in ROWS if name not in names]
    covered = set()
    for name in ROWS:
        reached(name, covered)
    problems += [f"laws/{name}.hpp: nothing compiles it with T = double; expected a row in {pathlib.Path(__file__).name}"
                 for name in names if name not in covered]
    compiler = next((c for c in ("clang++", "clang++-14", "c++") if shutil.which(c)), None)
    if compiler is None:
        sys.exit("no C++ compiler")
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        problems += [text for text in pool.map(lambda name: compile_alone(name, compiler, folder), names) if text]
    if problems:
        sys.exit("\n".join(problems))
    print(f"{len(names)} headers of laws alone, {len(ROWS)} with T = double, by {compiler}")


main()
