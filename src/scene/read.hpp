// Document -> Scene, by the rows of the table of keys. Internal to src/scene.
#pragma once

#include "scene/document.hpp"
#include "scene/scene.hpp"

namespace barchan {

/// Takes what is there and leaves the rest at its default; never fails, because `validate` has already told what is
/// wrong.
Scene read_document(const toml::table& document, const std::string& file);

/// Kernel and radius (spacings) of a pair that does not give them; a radius of 0 must be given.
Interaction recommended(const std::vector<Phase>& phases, const std::string& a, const std::string& b);

/// The defaults that depend on other keys and not on the row alone, where the document leaves the key out.
void complete(Scene& scene);

}  // namespace barchan
