// Drag of a sphere in a fluid, by the name of its law. A law gives the drag in units of Stokes's,
//
//   excess(Re) = C_D Re / 24,   Re = |u - v| d / nu,   so that   dv/dt = (u - v) excess(Re) / tau_S,
//   tau_S = rho_p d^2 / (18 rho_f nu)   (the relaxation time of Stokes's law),
//
// which has no division by Re: a grain at rest in air at rest has a finite rate too.
#pragma once

#include <cmath>

#include "scene/scene.hpp"

namespace barchan {

/// C_D = 24/Re (Stokes 1851): Re < 0.5.
struct StokesDrag {
  static double excess(double) { return 1.0; }
};

/// Schiller & Naumann 1935: C_D = 24/Re (1 + 0.15 Re^0.687), 0.44 above Re = 1000. Smooth spheres.
struct SchillerNaumannDrag {
  static double excess(double re) { return re < 1000.0 ? 1.0 + 0.15 * std::pow(re, 0.687) : 0.44 / 24.0 * re; }
};

/// Cheng 1997: C_D = [(32/Re)^(2/3) + 1]^(3/2). Natural sand; COMSALT (Kok & Renno 2009) uses it.
struct ChengDrag {
  static double excess(double re) {
    constexpr double at_rest = 10.079368399158984;  // 32^(2/3)
    const double root = std::cbrt(re), sum = at_rest + root * root;
    return sum * std::sqrt(sum) / 24.0;
  }
};

/// Duran, Andreotti & Claudin 2012: C_D = (sqrt(0.5) + sqrt(24/Re))^2. Grains that saltate.
struct DuranDrag {
  static double excess(double re) {
    const double sum = std::sqrt(0.5 * re) + 4.898979485566356;  // sqrt(24)
    return sum * sum / 24.0;
  }
};

/// Di Felice 1994, as Robinson, Ramaioli & Luding 2014 write it: C_D = (0.63 + 4.8/sqrt(Re))^2 of the speed
/// e |u - v| that flows through the pores (e: the part of the volume that is fluid), times e^-xi,
/// xi = 3.7 - 0.65 exp(-(1.5 - log10 Re)^2 / 2). `excess` is that of a lone grain, e = 1.
struct DiFeliceDrag {
  static double excess(double re) {
    const double sum = 0.63 * std::sqrt(re) + 4.8;
    return sum * sum / 24.0;
  }
  /// Of a grain in a crowd: force e^(1 - xi) C_D(e Re)/8 pi d^2 rho |e (u - v)| (u - v), in units of Stokes's.
  static double excess_in_crowd(double re, double voidage) {
    const double through = voidage * re, away = 1.5 - std::log10(through > 1e-12 ? through : 1e-12);
    const double xi = 3.7 - 0.65 * std::exp(-0.5 * away * away);
    return std::pow(voidage, 1.0 - xi) * excess(through);
  }
};

/// Calls f with the law of this name. A fluid's own drag (DragLaw::none) is not one.
template <class F>
auto with_drag_law(DragLaw law, F&& f) {
  switch (law) {
    case DragLaw::stokes: return f(StokesDrag{});
    case DragLaw::schiller_naumann: return f(SchillerNaumannDrag{});
    case DragLaw::cheng: return f(ChengDrag{});
    case DragLaw::di_felice: return f(DiFeliceDrag{});
    case DragLaw::none:
    case DragLaw::duran: break;
  }
  return f(DuranDrag{});
}

}  // namespace barchan
