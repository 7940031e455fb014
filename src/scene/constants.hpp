// [constants] of a scene: names for numbers, so that lengths may be multiples of a diameter. Internal to src/scene.
#pragma once

#include "scene/document.hpp"
#include "scene/toml.hpp"

namespace barchan {

/// Puts numbers in the place of constants and takes [constants] out of the document. A value that takes a number, alone
/// or in an array, may then be a formula of constants, as size = ["300*d", 0.1]; in a formula in x, y, z, t a constant
/// stands for its number. A value is rounded to 15 digits, so that "300*d" with d = 2.42e-4 is the number 0.0726
/// itself. Throws SceneError: names that are taken, formulas that have no number, constants that nothing uses.
void replace_constants(toml::table& document, Problems& problems);

}  // namespace barchan
