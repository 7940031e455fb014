// The words of a document: each enumeration of a scene with the words that stand for its values.
//
// To add a word: the enumerator, and its word in the row below it.
#pragma once

#include <array>
#include <string_view>

#include "kernels/kernel_kind.hpp"

namespace barchan {

/// A word of a document and the number of what it stands for: an enumerator, an axis, true or false.
struct Word {
  std::string_view word;
  int meaning;
};
template <class Enum>
constexpr Word word(std::string_view word, Enum meaning) {
  return {word, static_cast<int>(meaning)};
}

/// The words of an enumeration.
template <class Enum>
inline constexpr std::array<Word, 0> words_of{};

template <>
inline constexpr std::array words_of<KernelKind>{word("cubic-spline", KernelKind::cubic_spline),
                                                 word("wendland-c2", KernelKind::wendland_c2)};

enum class EquationOfState { linear, tait };
template <>
inline constexpr std::array words_of<EquationOfState>{word("linear", EquationOfState::linear),
                                                      word("tait", EquationOfState::tait)};

enum class FluidScheme { plain, consistent };  // docs/method.md
template <>
inline constexpr std::array words_of<FluidScheme>{word("plain", FluidScheme::plain),
                                                  word("consistent", FluidScheme::consistent)};

enum class Formulation { total_lagrangian, updated_lagrangian };  // of elastic bodies; docs/method.md
template <>
inline constexpr std::array words_of<Formulation>{word("total-lagrangian", Formulation::total_lagrangian),
                                                  word("updated-lagrangian", Formulation::updated_lagrangian)};

enum class Elasticity { neo_hookean, saint_venant_kirchhoff };  // laws/hyperelastic.hpp
template <>
inline constexpr std::array words_of<Elasticity>{word("neo-hookean", Elasticity::neo_hookean),
                                                 word("saint-venant-kirchhoff", Elasticity::saint_venant_kirchhoff)};

enum class Turbulence { none, mixing_length, smagorinsky, k_omega };
template <>
inline constexpr std::array words_of<Turbulence>{
    word("none", Turbulence::none), word("mixing-length", Turbulence::mixing_length),
    word("smagorinsky", Turbulence::smagorinsky), word("k-omega", Turbulence::k_omega)};

enum class MixingLength { none, duran };  // of a column of air; Duran, Andreotti & Claudin 2012
template <>
inline constexpr std::array words_of<MixingLength>{word("none", MixingLength::none),
                                                   word("duran", MixingLength::duran)};

/// Drag of a grain by name (laws/drag_coefficients.hpp); none has no word: the entry gives a number.
enum class DragLaw { none, stokes, schiller_naumann, cheng, duran, di_felice };
template <>
inline constexpr std::array words_of<DragLaw>{
    word("stokes", DragLaw::stokes), word("schiller-naumann", DragLaw::schiller_naumann), word("cheng", DragLaw::cheng),
    word("duran", DragLaw::duran), word("di-felice", DragLaw::di_felice)};

enum class WallLaw { adami, repulsive };  // Adami et al. 2012; Halik et al. 2015 section 6 (one row of ghosts)
template <>
inline constexpr std::array words_of<WallLaw>{word("adami", WallLaw::adami), word("repulsive", WallLaw::repulsive)};

enum class Slip { no_slip, free_slip };
template <>
inline constexpr std::array words_of<Slip>{word("no-slip", Slip::no_slip), word("free-slip", Slip::free_slip)};

/// Rows, staggered rows, without overlap, along the ground, fallen and at rest, along the border.
enum class Packing { square, hexagonal, random, fitted, settled, relaxed };
template <>
inline constexpr std::array words_of<Packing>{word("rows", Packing::square),     word("staggered", Packing::hexagonal),
                                              word("random", Packing::random),   word("fitted", Packing::fitted),
                                              word("settled", Packing::settled), word("relaxed", Packing::relaxed)};

/// What a shape leaves free besides its outside.
enum class LeaveOut { nothing, earlier_fills };
template <>
inline constexpr std::array words_of<LeaveOut>{word("nothing", LeaveOut::nothing),
                                               word("earlier-fills", LeaveOut::earlier_fills)};

enum class DuneForm { cosine, gaussian, asymmetric, rushil, formula };
template <>
inline constexpr std::array words_of<DuneForm>{word("cosine", DuneForm::cosine), word("gaussian", DuneForm::gaussian),
                                               word("asymmetric", DuneForm::asymmetric),
                                               word("rushil", DuneForm::rushil), word("formula", DuneForm::formula)};

enum class FrameFormat { vtp, vtu };
template <>
inline constexpr std::array words_of<FrameFormat>{word("vtp", FrameFormat::vtp), word("vtu", FrameFormat::vtu)};

enum class Precision { double_precision, mixed };
template <>
inline constexpr std::array words_of<Precision>{word("double", Precision::double_precision),
                                                word("mixed", Precision::mixed)};

/// A side of the domain beside the ground.
enum class Flank { left, right, front, back };
template <>
inline constexpr std::array words_of<Flank>{word("left", Flank::left), word("right", Flank::right),
                                            word("front", Flank::front), word("back", Flank::back)};

/// A side of the domain: scene/side_names.hpp says where it is.
enum class Side { bottom, top, left, right, front, back };
template <>
inline constexpr std::array words_of<Side>{word("bottom", Side::bottom), word("top", Side::top),
                                           word("left", Side::left),     word("right", Side::right),
                                           word("front", Side::front),   word("back", Side::back)};

}  // namespace barchan
