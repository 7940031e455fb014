// Remarks on a run that reached its end: what a user should know before the results are used. They stand in run.json
// and are printed when the run ends.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace barchan {

class Warnings {
 public:
  /// Adds a warning. One with the same key replaces the earlier one, so that a part of the program may renew its own.
  void add(const std::string& key, const std::string& text) {
    const auto found = std::find_if(list_.begin(), list_.end(), [&](const auto& w) { return w.first == key; });
    if (found != list_.end()) found->second = text;
    else list_.emplace_back(key, text);
  }
  /// The texts, in the order in which their keys came.
  std::vector<std::string> texts() const {
    std::vector<std::string> out;
    for (const auto& w : list_) out.push_back(w.second);
    return out;
  }

 private:
  std::vector<std::pair<std::string, std::string>> list_;
};

}  // namespace barchan
