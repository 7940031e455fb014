// The commands of the program as its own tables have them, for the completion of shells and the manual page.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace barchan {

struct CommandWord {
  std::vector<std::string> names;  // of an option "-o", "--output"; empty: a word by its place
  std::string option{};            // what CLI11 calls it
  std::string takes;  // what stands for its value: DIR, FILE, SCENE, KEY=VALUE, "bash|zsh|fish"; empty: none
  std::string meaning;
  bool required = false;

  bool by_place() const { return names.empty(); }
  bool takes_a(const std::string& what) const {
    return ("|" + takes + "|").find("|" + what + "|") != std::string::npos;
  }
  bool takes_a_key() const { return takes.starts_with("KEY="); }
  std::vector<std::string> choices() const;  // the small words of "FILE|latest"
};

struct CommandTable {
  std::string name, meaning;
  std::vector<CommandWord> words;
};

/// The words of one command.
CommandTable command_table(const CLI::App& command);

/// The options of the program itself (name ""), then its commands in their order.
std::vector<CommandTable> command_tables(const CLI::App& app);

/// `text` with every `from` as `to`.
std::string with_each(std::string text, const std::string& from, const std::string& to);

}  // namespace barchan
