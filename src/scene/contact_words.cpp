#include "scene/contact_words.hpp"

#include "scene/couplings.hpp"

namespace barchan {

bool touches_as_spheres(const Scene& scene, const Phase& phase) {
  return std::any_of(sphere_laws.begin(), sphere_laws.end(),
                     [&](const SphereLawKeys& row) { return touches_by(scene, phase, row.law); });
}

std::string sphere_laws_that_read(std::string_view key) {
  std::vector<std::string> words;
  for (const SphereLawKeys& row : sphere_laws)
    for (const Word& w : words_of<ContactLaw>)
      if (w.meaning == static_cast<int>(row.law) && (key.empty() || row.reads(key)))
        words.push_back('"' + std::string(w.word) + '"');
  std::string text = "law = ";
  for (std::size_t k = 0; k < words.size(); ++k)
    text += (k == 0 ? "" : k + 1 == words.size() ? " or " : ", ") + words[k];
  return text;
}

std::string sphere_stiffness_keys(const std::string& between) {
  std::vector<std::string_view> keys;
  for (const SphereLawKeys& row : sphere_laws)
    if (std::find(keys.begin(), keys.end(), row.stiffness) == keys.end()) keys.push_back(row.stiffness);
  std::string text;
  for (const std::string_view key : keys) text += (text.empty() ? "" : between) + std::string(key);
  return text;
}

}  // namespace barchan
