// The nearest word: what a person who mistyped a key probably meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace barchan {

/// Number of insertions, deletions, changes and swaps of neighbouring letters that turn a into b (Damerau 1964, optimal
/// string alignment). Capitals and small letters are the same, and so are '_' and '-'.
int edit_distance(std::string_view a, std::string_view b);

/// The candidate that begins as the word does (or the other way round), or else the one with the least edit distance;
/// empty when none is close (more than a third of the letters differ).
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// "a", "b" or "c", for messages.
std::string one_of(const std::vector<std::string>& words);

/// `; did you mean "word" (remark)?`, or nothing for an empty word.
std::string did_you_mean(const std::string& word, std::string_view remark = "");

}  // namespace barchan
