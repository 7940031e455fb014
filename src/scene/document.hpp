// A TOML document with its overrides, and the list of what is wrong with it. Internal to src/scene.
#pragma once

#include <string>
#include <vector>

#include "scene/toml.hpp"

namespace barchan {

/// Every problem found in a scene, each with its place. Thrown as one SceneError, sorted by place.
class Problems {
 public:
  explicit Problems(std::string file) : file_(std::move(file)) {}

  /// `what` is "what is wrong; expected ...; did you mean ..."; `source` a node's or a key's place.
  void add(const toml::source_region& source, const std::string& dotted, const std::string& what);

  /// True when a problem was found with this key or with something inside it: later checks then keep silent.
  bool touch(const std::string& dotted) const;

  /// The document has been read: what is found from here on are contradictions between values that were understood.
  void end_of_reading() { read_ = list_.size(); }
  /// As touch(), of the problems of reading alone: values of this section may be missing.
  bool misread(const std::string& dotted) const;

  bool empty() const { return list_.empty(); }
  void throw_if_any() const;  ///< throws SceneError
  [[noreturn]] void fail(const toml::source_region& source, const std::string& dotted, const std::string& what);

 private:
  struct Problem {
    std::string place;  // FILE:LINE:COLUMN or --set KEY=VALUE
    bool from_override;
    unsigned line, column;
    std::string dotted, what;
  };
  static bool touches(const Problem& problem, const std::string& dotted);

  std::string file_;
  std::vector<Problem> list_;
  std::size_t read_ = 0;  // of these
};

/// Parses the text and carries out the overrides. Throws SceneError for malformed TOML; problems with overrides are
/// added.
toml::table parse_document(const std::string& text, const std::string& file, const std::vector<std::string>& overrides,
                           Problems& problems);

}  // namespace barchan
